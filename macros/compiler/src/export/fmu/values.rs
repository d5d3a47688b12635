//! Start values of the variables of an FMU.

/// Values of an interpolation table on its grid.
#[derive(Clone, Debug, Default)]
pub struct TableValues {
    /// Grid points along each axis of the table.
    pub axes: Vec<Vec<f64>>,
    /// Values in the order of the grid points, with the last axis varying fastest.
    pub values: Vec<f64>,
    /// Whether the table is interpolated by splines.
    pub smooth: bool,
    /// Whether the table is extrapolated beyond its grid.
    pub extrapolated: bool,
}

/// Start values of all variables of an FMU.
#[derive(Clone, Debug, Default)]
pub struct StartValues {
    /// Values of the parameters, which include the states of first order.
    pub parameters: Vec<f64>,
    /// Initial configuration.
    pub q: Vec<f64>,
    /// Initial velocity.
    pub v: Vec<f64>,
    /// Values of the inputs at the start of the simulation.
    pub u: Vec<f64>,
    /// Interpolation tables of the mechanism, which are constant.
    pub tables: Vec<TableValues>,
    /// Indices of the states of first order among the parameters.
    pub states: Vec<usize>,
}
