//! Units of the arguments and results of generated functions, as text.

/// Units as text for the documentation; `any` for a unit that nothing determines.
#[derive(Clone, Debug, Default)]
pub struct Units {
    /// Unit of every parameter, as text.
    pub parameters: Vec<String>,
    /// Units of every table: those of its variables, then that of its value.
    pub tables: Vec<Vec<String>>,
    /// Unit of every entry of `q`, as text.
    pub configuration: Vec<String>,
    /// Unit of every entry of `v`, as text.
    pub velocities: Vec<String>,
    /// Unit of every entry of `u`, as text.
    pub inputs: Vec<String>,
    /// Unit of every output, as text.
    pub outputs: Vec<String>,
    /// Units of every scalar constraint: that of its residual, or of its rate if it restricts only
    /// velocities, and that of its multiplier, which is a power per rate.
    pub constraints: Vec<[String; 2]>,
}
