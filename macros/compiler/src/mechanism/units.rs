//! Units of the arguments and results of generated functions.

/// Units as text for the documentation; `any` for a unit that nothing determines.
#[derive(Clone, Debug, Default)]
pub struct Units {
    /// Unit of every parameter.
    pub parameters: Vec<String>,
    /// Units of every table: those of its variables, then that of its value.
    pub tables: Vec<Vec<String>>,
    /// Unit of every entry of `q`.
    pub configuration: Vec<String>,
    /// Unit of every entry of `v`.
    pub velocities: Vec<String>,
    /// Unit of every entry of `u`.
    pub inputs: Vec<String>,
    /// Unit of every output.
    pub outputs: Vec<String>,
    /// Units of every scalar constraint: that of its residual, or of its rate if it restricts only
    /// velocities, and that of its multiplier, which is a power per rate.
    pub constraints: Vec<[String; 2]>,
}
