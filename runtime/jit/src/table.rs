//! Tables of a mechanism with any number of variables: functions that are parameters.

use linkwork::Table;

/// Interpolation table of one, two or three variables, or a table that has not been set.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnyTable {
    /// No table has been set: its values are NaN.
    Missing,
    /// Interpolation table of one variable.
    One(Table<1>),
    /// Interpolation table of two variables.
    Two(Table<2>),
    /// Interpolation table of three variables.
    Three(Table<3>),
}

impl AnyTable {
    /// Returns the number of variables, zero for a missing table.
    #[must_use]
    pub fn variables(&self) -> usize {
        match self {
            AnyTable::Missing => 0,
            AnyTable::One(_) => 1,
            AnyTable::Two(_) => 2,
            AnyTable::Three(_) => 3,
        }
    }

    /// Returns the grid and the values of the table; `None` for a missing table.
    pub(crate) fn grid(&self) -> Option<Grid> {
        match self {
            AnyTable::Missing => None,
            AnyTable::One(table) => Some(Grid::new(table)),
            AnyTable::Two(table) => Some(Grid::new(table)),
            AnyTable::Three(table) => Some(Grid::new(table)),
        }
    }

    /// Returns the value of the table, or its partial derivative of the given orders, at a point.
    pub(crate) fn derivative_value(&self, [x, y, z]: [f64; 3], [a, b, c]: [u8; 3]) -> f64 {
        match self {
            AnyTable::Missing => f64::NAN,
            AnyTable::One(table) => table.derivative([x], [a]),
            AnyTable::Two(table) => table.derivative([x, y], [a, b]),
            AnyTable::Three(table) => table.derivative([x, y, z], [a, b, c]),
        }
    }
}

/// Grid and values of a table with any number of variables.
pub(crate) struct Grid {
    /// Points of each axis.
    pub axes: Vec<&'static [f64]>,
    /// Values in the order of the grid points, with the last axis varying fastest.
    pub values: &'static [f64],
    /// Whether the interpolation has continuous slopes.
    pub is_smooth: bool,
    /// Whether the table is extrapolated beyond its grid.
    pub is_extrapolated: bool,
}

impl Grid {
    fn new<const N: usize>(table: &Table<N>) -> Grid {
        Grid {
            axes: table.axes().to_vec(),
            values: table.values(),
            is_smooth: table.is_smooth(),
            is_extrapolated: table.is_extrapolated(),
        }
    }
}

impl From<Table<1>> for AnyTable {
    fn from(table: Table<1>) -> AnyTable {
        AnyTable::One(table)
    }
}

impl From<Table<2>> for AnyTable {
    fn from(table: Table<2>) -> AnyTable {
        AnyTable::Two(table)
    }
}

impl From<Table<3>> for AnyTable {
    fn from(table: Table<3>) -> AnyTable {
        AnyTable::Three(table)
    }
}
