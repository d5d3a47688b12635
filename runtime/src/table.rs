//! Lookup tables: functions of one to three variables, interpolated between values on a grid.

mod interpolation;

use crate::Real;
use crate::private::constant;
use core::fmt;
use core::ops::Deref;
use interpolation::{AxisPosition, Shape, WeightArguments};

/// Function of `N` variables, one to three, interpolated between values on a grid. A table is a parameter of
/// a mechanism.
///
/// Expressions call a field `pub lift: Table<2>` as `lift(alpha, elevator)`. Derivatives of the mechanism use
/// the slopes of the interpolation. The units of values and axes are inferred from use, as for parameters
/// that are numbers.
///
/// Between grid points the table is linear in each variable, or [`smooth`](Table::smooth) with continuous
/// slopes. Beyond the grid it has the constant value of the edge, or is
/// [`extrapolated`](Table::extrapolated).
///
/// A compiled mechanism has tables that borrow their grid and values for `'static`, so that the mechanism is
/// `Copy` and allocates no memory. They are constants, or slices from `Vec::leak` if they are read at run
/// time. Tables of loaded mechanisms own their values, as `Vec<f64>` or `Arc<[f64]>`: see
/// [`from_storage`](Table::from_storage). Values are `f64` for every scalar type of the mechanism.
///
/// ```
/// use linkwork::{Table, TableError};
///
/// // One row for each angle of the first axis, one column for each angle of the second.
/// const LIFT: Table<2> = match Table::new(
///     [&[0.0, 0.1], &[-0.2, 0.0, 0.2]],
///     &[-0.1, 0.0, 0.1, 0.4, 0.5, 0.6],
/// ) {
///     Ok(table) => table,
///     Err(error) => panic!("{}", error.message()),
/// };
/// assert!((LIFT.value([0.05, 0.1]) - 0.3_f64).abs() < 1e-15);
/// assert!((LIFT.slope([0.05, 0.1], 0) - 5.0_f64).abs() < 1e-14);
/// assert_eq!(LIFT.value([9.0, 0.0]), 0.5);
/// assert_eq!(Table::new([&[0.0, 0.0]], &[1.0, 2.0]), Err(TableError::NotIncreasing { axis: 0, place: 1 }));
/// ```
///
/// Invalid axes or values of a constant are a compile error:
///
/// ```compile_fail,E0080
/// use linkwork::Table;
///
/// const LIFT: Table<1> = match Table::new([&[0.0, 0.2, 0.1]], &[-0.1, 0.4, 0.5]) {
///     Ok(table) => table,
///     // error: an axis of this table does not increase strictly
///     Err(error) => panic!("{}", error.message()),
/// };
/// assert!(LIFT.value([0.0]) < 0.0_f64);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<const N: usize, V = &'static [f64]> {
    axes: [V; N],
    values: V,
    smooth: bool,
    extrapolated: bool,
}

/// Error for axes and values that do not form a table.
#[derive(Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TableError {
    /// An axis of the table has fewer than two grid points.
    TooFewPoints {
        /// Index of the invalid axis, counted from zero.
        axis: usize,
    },
    /// A point of an axis is not greater than the point before it, or is infinite or NaN.
    NotIncreasing {
        /// Index of the invalid axis, counted from zero.
        axis: usize,
        /// Index of the grid point on the axis that does not increase or is not finite.
        place: usize,
    },
    /// The number of values differs from the number of grid points.
    Size {
        /// Number of grid points, which is the expected number of values.
        expected: usize,
        /// Number of values that were provided.
        found: usize,
    },
    /// A value of the table is infinite or NaN.
    NotFinite {
        /// Index of the value that is infinite or NaN.
        place: usize,
    },
}

impl TableError {
    /// Returns a message without the indices, as a constant: constants cannot use formatting.
    #[must_use]
    pub const fn message(self) -> &'static str {
        match self {
            TableError::TooFewPoints { .. } => "an axis of this table has fewer than two points",
            TableError::NotIncreasing { .. } => "an axis of this table does not increase strictly",
            TableError::Size { .. } => "this table has not as many values as its grid has points",
            TableError::NotFinite { .. } => "a value of this table is not a finite number",
        }
    }
}

crate::debug_as_display!(TableError);

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TableError::TooFewPoints { axis } => {
                write!(f, "axis {axis} of the table has fewer than two points")
            }
            TableError::NotIncreasing { axis, place } => {
                write!(f, "axis {axis} of the table does not increase strictly at its point {place}")
            }
            TableError::Size { expected, found } => {
                write!(f, "the grid of the table has {expected} points, but there are {found} values")
            }
            TableError::NotFinite { place } => write!(f, "value {place} of the table is not a finite number"),
        }
    }
}

impl core::error::Error for TableError {}

impl<'a, const N: usize> Table<N, &'a [f64]> {
    /// Returns a table that is linear between its grid points and constant beyond the grid. Values are
    /// ordered like the grid points, with the last axis varying fastest.
    ///
    /// # Errors
    ///
    /// Axes that do not increase strictly or have fewer than two points, values that are not finite, or a
    /// number of values that differs from the number of grid points. In a constant these errors can stop the
    /// compilation, see the example of [`Table`].
    pub const fn new(axes: [&'a [f64]; N], values: &'a [f64]) -> Result<Table<N, &'a [f64]>, TableError> {
        const { assert!(N >= 1 && N <= 3, "a table has one to three variables") };
        let (mut axis, mut expected) = (0, 1_usize);
        while axis < N {
            let points = axes[axis];
            if points.len() < 2 {
                return Err(TableError::TooFewPoints { axis });
            }
            let mut place = 0;
            while place < points.len() {
                if !points[place].is_finite() || (place > 0 && points[place - 1] >= points[place]) {
                    return Err(TableError::NotIncreasing { axis, place });
                }
                place += 1;
            }
            expected = expected.saturating_mul(points.len());
            axis += 1;
        }
        if values.len() != expected {
            return Err(TableError::Size { expected, found: values.len() });
        }
        let mut place = 0;
        while place < values.len() {
            if !values[place].is_finite() {
                return Err(TableError::NotFinite { place });
            }
            place += 1;
        }
        Ok(Table { axes, values, smooth: false, extrapolated: false })
    }
}

impl<const N: usize, V> Table<N, V> {
    /// Returns the table with continuous slopes. Along each axis it is cubic between neighbouring points; the
    /// slope at a point is that of the parabola through the point and its two neighbours (Bessel's tangents;
    /// de Boor, *A Practical Guide to Splines*, ch. IV). The interpolation passes through all values and is
    /// exact for parabolas. Second derivatives jump at the points, where the value to the right is returned.
    #[must_use]
    pub const fn smooth(mut self) -> Table<N, V> {
        self.smooth = true;
        self
    }

    /// Returns the table extrapolated linearly beyond its grid, with the slopes of the edge.
    #[must_use]
    pub const fn extrapolated(mut self) -> Table<N, V> {
        self.extrapolated = true;
        self
    }

    /// Returns the grid points of each axis of the table.
    #[must_use]
    pub const fn axes(&self) -> &[V; N] {
        &self.axes
    }

    /// Returns true if the interpolation has continuous slopes.
    #[must_use]
    pub const fn is_smooth(&self) -> bool {
        self.smooth
    }

    /// Returns true if the table is extrapolated beyond its grid.
    #[must_use]
    pub const fn is_extrapolated(&self) -> bool {
        self.extrapolated
    }

    /// Returns the table with its grid and values stored in another type of list.
    #[must_use]
    pub fn into_storage<W>(self) -> Table<N, W>
    where
        V: Into<W>,
    {
        Table {
            axes: self.axes.map(Into::into),
            values: self.values.into(),
            smooth: self.smooth,
            extrapolated: self.extrapolated,
        }
    }
}

impl<const N: usize, V: Deref<Target = [f64]>> Table<N, V> {
    /// Returns the values in the order of the grid points, with the last axis varying fastest.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns a table whose grid and values are owned lists, for example `Vec<f64>` or `Arc<[f64]>`. See
    /// [`new`](Table::new) for the order of the values.
    ///
    /// ```
    /// use linkwork::Table;
    ///
    /// let heights: Vec<f64> = [0.0, 0.5, 2.0].iter().map(|x| x * x).collect();
    /// let table = Table::from_storage([vec![0.0, 0.5, 2.0]], heights)?;
    /// assert_eq!(table.value([0.25]), 0.125);
    /// # Ok::<(), linkwork::TableError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`new`](Table::new).
    pub fn from_storage(axes: [V; N], values: V) -> Result<Table<N, V>, TableError> {
        Table::new(axes.each_ref().map(|axis| &**axis), &values)?;
        Ok(Table { axes, values, smooth: false, extrapolated: false })
    }

    /// Returns the value at `x`; NaN if an entry of `x` is NaN.
    #[must_use]
    pub fn value<T: Real>(&self, x: [T; N]) -> T {
        self.derivative(x, [0; N])
    }

    /// Returns the slope with respect to variable `k` at `x`. The slope is zero where the table is constant
    /// beyond its edge, and for `k ≥ N`. At a grid point of a linear table it is the slope to the right.
    #[must_use]
    pub fn slope<T: Real>(&self, x: [T; N], k: usize) -> T {
        if k >= N {
            return T::zero();
        }
        self.derivative(x, core::array::from_fn(|i| u8::from(i == k)))
    }

    /// Returns the partial derivative of the interpolated function at `x`, with these orders in each
    /// variable: `[1, 1]` is ∂²f/∂x₀∂x₁. Higher than first derivatives in one variable are zero for a linear
    /// table; higher than third ones are zero for every table.
    #[must_use]
    pub fn derivative<T: Real>(&self, x: [T; N], orders: [u8; N]) -> T {
        let mut all = [WeightArguments::one(); 3];
        let mut cells = [[0, 1]; 3];
        let axes = self.axes.iter().zip(x).zip(orders);
        for (((points, x), order), (weights, range)) in axes.zip(all.iter_mut().zip(&mut cells)) {
            let place = AxisPosition::locate_on_axis(points, x);
            *range = place.possible_cells(points);
            *weights = WeightArguments { place: Some(place), order };
        }
        let [first, second, third] = cells;
        let mut sum = T::zero();
        for i in first[0]..first[1] {
            let outer = self.weights_around_cell(0, i, first, &all);
            for j in second[0]..second[1] {
                let middle = self.weights_around_cell(1, j, second, &all);
                for k in third[0]..third[1] {
                    let inner = self.weights_around_cell(2, k, third, &all);
                    sum += self.weighted_sum_around_cell([i, j, k], [&outer, &middle, &inner]);
                }
            }
        }
        sum
    }

    /// Returns the interpolation weights of the four grid values around a cell of an axis. For an axis beyond
    /// the dimension of the table, only one value has a weight, which is one.
    fn weights_around_cell<T: Real>(
        &self,
        axis: usize,
        cell: usize,
        range: [usize; 2],
        all: &[WeightArguments<T>; 3],
    ) -> [T; 4] {
        let only = [T::zero(), T::one(), T::zero(), T::zero()];
        let (Some(points), Some(WeightArguments { place: Some(place), order })) =
            (self.axes.get(axis), all.get(axis))
        else {
            return only;
        };
        let shape = Shape { smooth: self.smooth, extrapolated: self.extrapolated };
        let weights = place.weights_of_points(points, cell, *order, shape);
        if range[1] - range[0] <= 1 {
            return weights;
        }
        let share = place.cell_indicator(points, cell);
        weights.map(|w| w * share)
    }

    /// Returns the range of the four weights of an axis that can be nonzero.
    fn nonzero_weight_slots(&self, axis: usize) -> core::ops::Range<usize> {
        match (axis < N, self.smooth) {
            (false, _) => 1..2,
            (true, false) => 1..3,
            (true, true) => 0..4,
        }
    }

    /// Returns the weighted sum of the values around a cell.
    fn weighted_sum_around_cell<T: Real>(&self, cells: [usize; 3], weights: [&[T; 4]; 3]) -> T {
        let axis_length = |axis: usize| self.axes.get(axis).map_or(1, |points| points.len());
        // Slot 0 of the weights is the point before the cell.
        let axis_point_of_slot = |axis: usize, slot: usize| (cells[axis] + slot).checked_sub(1);
        let weight_of_slot = |axis: usize, slot: usize| weights[axis].get(slot).copied().unwrap_or(T::zero());
        let (rows, columns) = (axis_length(1), axis_length(2));
        let mut sum = T::zero();
        for a in self.nonzero_weight_slots(0) {
            let Some(i) = axis_point_of_slot(0, a) else { continue };
            for b in self.nonzero_weight_slots(1) {
                let Some(j) = axis_point_of_slot(1, b) else { continue };
                let both = weight_of_slot(0, a) * weight_of_slot(1, b);
                for c in self.nonzero_weight_slots(2) {
                    let value =
                        axis_point_of_slot(2, c).and_then(|k| self.values.get((i * rows + j) * columns + k));
                    if let Some(value) = value {
                        sum += both * weight_of_slot(2, c) * constant(*value);
                    }
                }
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests;
