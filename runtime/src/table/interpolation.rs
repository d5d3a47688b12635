//! Positions on the axes of a table, and weights of the grid values around them.

use crate::Real;
use crate::private::constant;

/// Interpolation between, and extrapolation beyond, the points of a table.
#[derive(Clone, Copy)]
pub struct Shape {
    pub smooth: bool,
    pub extrapolated: bool,
}

/// Position on an axis and order of the derivative, from which the weights of the axis are computed; no
/// position for an axis that the table does not have.
#[derive(Clone, Copy)]
pub struct WeightArguments<T> {
    pub place: Option<AxisPosition<T>>,
    pub order: u8,
}

impl<T> WeightArguments<T> {
    pub fn one() -> WeightArguments<T> {
        WeightArguments { place: None, order: 0 }
    }
}

/// Position of an argument on an axis of a table: its value clamped to the axis, its distance beyond the
/// axis, and one if it is within the axis, otherwise zero.
#[derive(Clone, Copy)]
pub struct AxisPosition<T> {
    x: T,
    beyond: T,
    within: T,
}

/// Returns the unit step of each lane: one for a nonnegative number and zero for a negative one.
fn unit_step<T: Real>(x: T) -> T {
    (T::one() + x.signum()) * constant(0.5)
}

impl<T: Real> AxisPosition<T> {
    pub fn locate_on_axis(points: &[f64], x: T) -> AxisPosition<T> {
        let table_point_or_zero = |p: Option<&f64>| constant::<T>(p.copied().unwrap_or(0.0));
        let (low, high) = (table_point_or_zero(points.first()), table_point_or_zero(points.last()));
        let inner = x.max(low).min(high);
        // `max` and `min` of NaN and a number are the number: adding `x · 0` restores the NaN.
        let nothing = x * T::zero();
        AxisPosition {
            x: inner + nothing,
            beyond: x - inner,
            within: unit_step(x - low) * unit_step(high - x),
        }
    }

    /// Returns the half-open range of grid cells that can contain the argument: a single cell, or all cells
    /// if SIMD lanes differ.
    pub fn possible_cells(&self, points: &[f64]) -> [usize; 2] {
        let last = points.len().saturating_sub(2);
        let (mut low, mut high) = (0, last);
        while low < high {
            let middle = low + (high - low).div_ceil(2);
            let Some(p) = points.get(middle) else { break };
            let p = constant::<T>(*p);
            if self.x >= p {
                low = middle;
            } else if self.x < p {
                high = middle - 1;
            } else {
                return [0, last + 1];
            }
        }
        [low, low + 1]
    }

    /// Returns one in each lane in which the grid cell contains the argument, and zero in others.
    pub fn cell_indicator(&self, points: &[f64], cell: usize) -> T {
        let unit_step_at_point =
            |k: usize| points.get(k).map_or(T::zero(), |p| unit_step(self.x - constant(*p)));
        let last = cell + 2 >= points.len();
        let low = if cell == 0 { T::one() } else { unit_step_at_point(cell) };
        low - if last { T::zero() } else { unit_step_at_point(cell + 1) }
    }

    /// Returns the weights of the four points around a cell, for a derivative of the given order.
    pub fn weights_of_points(&self, points: &[f64], cell: usize, order: u8, shape: Shape) -> [T; 4] {
        let around = GridCell::new(points, cell, shape.smooth);
        let s = (self.x - constant(around.start)) / constant(around.width);
        let weights_of_derivative_order = |order| around.weights_at_fraction(s, order);
        match (order, shape.extrapolated) {
            (0, true) => {
                let (value, slope) = (weights_of_derivative_order(0), weights_of_derivative_order(1));
                core::array::from_fn(|k| value[k] + self.beyond * slope[k])
            }
            (0, false) => weights_of_derivative_order(0),
            (1, true) => weights_of_derivative_order(1),
            _ => weights_of_derivative_order(order).map(|w| w * self.within),
        }
    }
}

/// Cell of an axis: its start, its width and, for smooth tables, the weights of the four points around it
/// that yield the slopes at both ends times the width.
struct GridCell {
    start: f64,
    width: f64,
    slopes: Option<[[f64; 4]; 2]>,
}

impl GridCell {
    fn new(points: &[f64], cell: usize, smooth: bool) -> GridCell {
        let coordinate_of_point = |k: usize| points.get(k).copied();
        let (start, end) =
            (coordinate_of_point(cell).unwrap_or(0.0), coordinate_of_point(cell + 1).unwrap_or(1.0));
        let h = end - start;
        let before = cell.checked_sub(1).and_then(coordinate_of_point).map(|p| start - p);
        let after = coordinate_of_point(cell + 2).map(|p| p - end);
        let slopes = smooth.then(|| {
            // Slope of the parabola through three points, times `h`: at the middle point, otherwise at the
            // first or the last point.
            let first = match before {
                Some(b) => [-h * h / (b * (b + h)), (h - b) / b, b / (b + h), 0.0],
                None => after.map_or([0.0, -1.0, 1.0, 0.0], |a| {
                    [0.0, -(2.0 * h + a) / (h + a), (h + a) / a, -h * h / (a * (h + a))]
                }),
            };
            let second = match after {
                Some(a) => [0.0, -a / (h + a), (a - h) / a, h * h / (a * (h + a))],
                None => before.map_or([0.0, -1.0, 1.0, 0.0], |b| {
                    [h * h / (b * (h + b)), -(h + b) / b, (2.0 * h + b) / (h + b), 0.0]
                }),
            };
            [first, second]
        });
        GridCell { start, width: h, slopes }
    }

    /// Returns the weights at the fraction `s` of the width, for a derivative of the given order.
    fn weights_at_fraction<T: Real>(&self, s: T, order: u8) -> [T; 4] {
        let c = constant::<T>;
        let zero = T::zero();
        let scale = (0..order).fold(T::one(), |scale, _| scale / c(self.width));
        let Some([first, second]) = &self.slopes else {
            return match order {
                0 => [zero, T::one() - s, s, zero],
                1 => [zero, -scale, scale, zero],
                _ => [zero; 4],
            };
        };
        // Hermite polynomials of the values and slopes at both ends.
        let (one, s2) = (T::one(), s * s);
        let s3 = s2 * s;
        let [end, m0, m1] = match order {
            0 => [c(3.0) * s2 - c(2.0) * s3, s3 - c(2.0) * s2 + s, s3 - s2],
            1 => [c(6.0) * (s - s2), c(3.0) * s2 - c(4.0) * s + one, c(3.0) * s2 - c(2.0) * s],
            2 => [c(6.0) - c(12.0) * s, c(6.0) * s - c(4.0), c(6.0) * s - c(2.0)],
            3 => [c(-12.0), c(6.0), c(6.0)],
            _ => [zero; 3],
        };
        let start = if order == 0 { one - end } else { -end };
        let values = [zero, start, end, zero];
        core::array::from_fn(|k| scale * (values[k] + m0 * c(first[k]) + m1 * c(second[k])))
    }
}
