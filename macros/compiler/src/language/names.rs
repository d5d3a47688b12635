//! Names that have a value in every expression.

/// Built-in name of the language, with a value in every expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Builtin {
    /// Direction of an axis of the current frame, by its index.
    Axis(usize),
    /// Built-in name of the number π.
    Pi,
    /// Built-in name of the time, s.
    Time,
}

/// Names of the axes of a frame.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// Name of the number π in the language.
pub const PI: &str = "pi";

/// Name of time in the language.
pub const TIME: &str = "t";

impl Builtin {
    /// Returns the built-in quantity with this name.
    pub fn find_by_name(name: &str) -> Option<Builtin> {
        match name {
            PI => Some(Builtin::Pi),
            TIME => Some(Builtin::Time),
            _ => axis_index_of_name(name).map(Builtin::Axis),
        }
    }
}

/// Returns the index of the axis of this name.
pub fn axis_index_of_name(name: &str) -> Option<usize> {
    AXES.iter().position(|axis| *axis == name)
}
