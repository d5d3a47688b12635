//! Interpolation tables of a mechanism with any number of variables, which are parameters.

use linkwork::{Table, TableError};
use std::sync::Arc;

/// Interpolation table of one, two or three variables, or a table that has not been set.
///
/// Copies share the values, whose memory is returned with the last copy. Tables of static slices, of `Vec`
/// and of `Arc` become values of this type by `into`.
///
/// ```
/// use linkwork::Table;
/// use linkwork_jit::AnyTable;
///
/// let table = Table::from_storage([vec![0.0, 1.0]], vec![2.0, 3.0])?;
/// assert_eq!(AnyTable::from(table), AnyTable::from_grid(&[[0.0, 1.0]], &[2.0, 3.0])?);
/// # Ok::<(), linkwork::TableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnyTable {
    /// Missing table, which has not been set: its values are NaN.
    Missing,
    /// Interpolation table of one variable.
    One(Table<1, Arc<[f64]>>),
    /// Interpolation table of two variables.
    Two(Table<2, Arc<[f64]>>),
    /// Interpolation table of three variables.
    Three(Table<3, Arc<[f64]>>),
}

impl AnyTable {
    /// Returns a table that is linear between its grid points and constant beyond the grid. Values are
    /// ordered like the grid points, with the last axis varying fastest.
    ///
    /// # Errors
    ///
    /// The errors of [`Table::new`]. Other numbers of axes than one, two and three are
    /// [`TableError::Size`].
    pub fn from_grid(axes: &[impl AsRef<[f64]>], values: &[f64]) -> Result<AnyTable, TableError> {
        let shared_axis = |axis: &dyn AsRef<[f64]>| Arc::<[f64]>::from(axis.as_ref());
        match axes {
            [a] => Table::from_storage([shared_axis(a)], values.into()).map(AnyTable::One),
            [a, b] => Table::from_storage([shared_axis(a), shared_axis(b)], values.into()).map(AnyTable::Two),
            [a, b, c] => Table::from_storage([shared_axis(a), shared_axis(b), shared_axis(c)], values.into())
                .map(AnyTable::Three),
            _ => Err(TableError::Size { expected: 3, found: axes.len() }),
        }
    }

    /// Returns the table with continuous slopes: see [`Table::smooth`].
    #[must_use]
    pub fn smooth(self) -> AnyTable {
        match self {
            AnyTable::Missing => AnyTable::Missing,
            AnyTable::One(table) => AnyTable::One(table.smooth()),
            AnyTable::Two(table) => AnyTable::Two(table.smooth()),
            AnyTable::Three(table) => AnyTable::Three(table.smooth()),
        }
    }

    /// Returns the table extrapolated linearly beyond its grid: see [`Table::extrapolated`].
    #[must_use]
    pub fn extrapolated(self) -> AnyTable {
        match self {
            AnyTable::Missing => AnyTable::Missing,
            AnyTable::One(table) => AnyTable::One(table.extrapolated()),
            AnyTable::Two(table) => AnyTable::Two(table.extrapolated()),
            AnyTable::Three(table) => AnyTable::Three(table.extrapolated()),
        }
    }

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
    pub(crate) fn grid(&self) -> Option<TableData<'_>> {
        match self {
            AnyTable::Missing => None,
            AnyTable::One(table) => Some(TableData::new(table)),
            AnyTable::Two(table) => Some(TableData::new(table)),
            AnyTable::Three(table) => Some(TableData::new(table)),
        }
    }

    /// Returns the value of the table, or its partial derivative of the given orders, at a point.
    pub(crate) fn value_or_derivative(&self, [x, y, z]: [f64; 3], [a, b, c]: [u8; 3]) -> f64 {
        match self {
            AnyTable::Missing => f64::NAN,
            AnyTable::One(table) => table.derivative([x], [a]),
            AnyTable::Two(table) => table.derivative([x, y], [a, b]),
            AnyTable::Three(table) => table.derivative([x, y, z], [a, b, c]),
        }
    }
}

/// Grid and values of a table with any number of variables.
pub(crate) struct TableData<'a> {
    /// Points of each axis.
    pub axes: Vec<&'a [f64]>,
    /// Values in the order of the grid points, with the last axis varying fastest.
    pub values: &'a [f64],
    /// Whether the interpolation has continuous slopes.
    pub is_smooth: bool,
    /// Whether the table is extrapolated beyond its grid.
    pub is_extrapolated: bool,
}

impl<'a> TableData<'a> {
    fn new<const N: usize>(table: &'a Table<N, Arc<[f64]>>) -> TableData<'a> {
        TableData {
            axes: table.axes().iter().map(|axis| &**axis).collect(),
            values: table.values(),
            is_smooth: table.is_smooth(),
            is_extrapolated: table.is_extrapolated(),
        }
    }
}

impl<V: Into<Arc<[f64]>>> From<Table<1, V>> for AnyTable {
    fn from(table: Table<1, V>) -> AnyTable {
        AnyTable::One(table.into_storage())
    }
}

impl<V: Into<Arc<[f64]>>> From<Table<2, V>> for AnyTable {
    fn from(table: Table<2, V>) -> AnyTable {
        AnyTable::Two(table.into_storage())
    }
}

impl<V: Into<Arc<[f64]>>> From<Table<3, V>> for AnyTable {
    fn from(table: Table<3, V>) -> AnyTable {
        AnyTable::Three(table.into_storage())
    }
}
