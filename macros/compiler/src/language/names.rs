//! Names that have a value in every expression.

/// A name with a value in every expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Builtin {
    /// Direction of an axis of the current frame, by its index.
    Axis(usize),
    /// The number π.
    Pi,
    /// Time.
    Time,
}

/// The names of the axes.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// The name of the number π.
pub const PI: &str = "pi";

/// The name of time.
pub const TIME: &str = "t";

impl Builtin {
    /// Returns the meaning of a name.
    pub fn of_name(name: &str) -> Option<Builtin> {
        match name {
            PI => Some(Builtin::Pi),
            TIME => Some(Builtin::Time),
            _ => axis_of_name(name).map(Builtin::Axis),
        }
    }
}

/// Returns the index of the axis of this name.
pub fn axis_of_name(name: &str) -> Option<usize> {
    AXES.iter().position(|axis| *axis == name)
}
