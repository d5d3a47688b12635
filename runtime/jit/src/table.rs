//! Interpolation tables of a mechanism with any number of variables, which are parameters.

use linkwork::Table;

/// Interpolation table of one, two or three variables, or a table that has not been set.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnyTable {
    /// Missing table, which has not been set: its values are NaN.
    Missing,
    /// Interpolation table of one variable.
    One(Table<1>),
    /// Interpolation table of two variables.
    Two(Table<2>),
    /// Interpolation table of three variables.
    Three(Table<3>),
}

impl AnyTable {
    /// Returns the number of variables of the table, zero for a missing table.
    #[must_use]
    pub fn variables(&self) -> usize {
        match self {
            AnyTable::Missing => 0,
            AnyTable::One(_) => 1,
            AnyTable::Two(_) => 2,
            AnyTable::Three(_) => 3,
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
