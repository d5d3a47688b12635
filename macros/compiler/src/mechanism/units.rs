//! Units of what generated functions take and give.

/// Units as they are written in the documentation; `any` where nothing determines one.
#[derive(Clone, Debug, Default)]
pub struct Units {
    /// Of every parameter.
    pub parameters: Vec<String>,
    /// Of every table: its variables, then its value.
    pub tables: Vec<Vec<String>>,
    /// Of every entry of `q`.
    pub configuration: Vec<String>,
    /// Of every entry of `v`.
    pub velocities: Vec<String>,
    /// Of every entry of `u`.
    pub inputs: Vec<String>,
    /// Of every output.
    pub outputs: Vec<String>,
    /// Of every scalar constraint: its residual, or its rate where it restricts velocities alone, and its multiplier,
    /// which is a power per rate.
    pub constraints: Vec<[String; 2]>,
}
