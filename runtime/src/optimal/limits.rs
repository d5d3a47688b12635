//! Limits of the inputs in the backward recursion of differential dynamic programming.

use super::{Indefinite, Policy, Quadratic, Value};
use crate::Real;
use crate::blocks::{add_product, factors, product, solve, zeros};
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// Maximum number of iterations of the search for inputs within limits: a number for each input, plus a
/// constant.
const ITERATIONS: [usize; 2] = [4, 16];
/// Maximum number of halvings of a step in the line search.
const HALVINGS: usize = 30;
/// Part of the decrease of a linear model of the costs that a step must reach.
const DECREASE: f64 = 0.1;

/// Limits of the changes of the inputs at an instant of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputLimits<T, const NU: usize> {
    lower: SVector<T, NU>,
    upper: SVector<T, NU>,
}

/// Error for limits of an input that contradict each other, or are not numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct EmptyRange {
    /// Index of the input with contradictory limits.
    pub input: usize,
}

crate::debug_as_display!(EmptyRange);

impl core::fmt::Display for EmptyRange {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "no value of input {} satisfies its limits: the lower one must not exceed the upper one",
            self.input
        )
    }
}

impl core::error::Error for EmptyRange {}

impl<T: Real, const NU: usize> InputLimits<T, NU> {
    /// Returns the limits of the changes of the inputs `u` that keep them between `lower` and `upper`. An
    /// input without a limit has an infinite one.
    ///
    /// # Errors
    ///
    /// [`EmptyRange`] if a lower limit exceeds the upper one, or if a value is NaN.
    pub fn around(
        u: &SVector<T, NU>,
        lower: &SVector<T, NU>,
        upper: &SVector<T, NU>,
    ) -> Result<Self, EmptyRange> {
        let limits = Self { lower: lower - u, upper: upper - u };
        match limits
            .lower
            .iter()
            .zip(&limits.upper)
            .position(|(lower, upper)| !matches!(lower.partial_cmp(upper), Some(order) if order.is_le()))
        {
            Some(input) => Err(EmptyRange { input }),
            None => Ok(limits),
        }
    }

    /// Returns the change of the inputs that is nearest to `change` within the limits.
    pub fn clamp(&self, change: &SVector<T, NU>) -> SVector<T, NU> {
        let mut clamped = *change;
        for (x, (lower, upper)) in clamped.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            *x = x.max(*lower).min(*upper);
        }
        clamped
    }

    /// Returns true for inputs that may change against the gradient of the costs.
    fn free_input_mask(&self, change: &SVector<T, NU>, gradient: &SVector<T, NU>) -> [bool; NU] {
        let mut free = [true; NU];
        let ranges = self.lower.iter().zip(&self.upper);
        for ((free, x), ((lower, upper), slope)) in free.iter_mut().zip(change).zip(ranges.zip(gradient)) {
            let none = T::zero();
            *free = lower < upper && !(*x <= *lower && *slope > none || *x >= *upper && *slope < none);
        }
        free
    }

    /// Returns the change within the limits that minimises `gradient · δu + ½ δu · hessian δu`, by a
    /// projected Newton method from a start, and the inputs that are not at a limit.
    fn minimise_within_limits(
        &self,
        (gradient, hessian): (&SVector<T, NU>, &SMatrix<T, NU, NU>),
        start: &SVector<T, NU>,
    ) -> Result<(SVector<T, NU>, [bool; NU]), Indefinite> {
        let mut x = self.clamp(start);
        let cost_slope_at = |x: &SVector<T, NU>| gradient + product(hessian, x);
        let quadratic_cost =
            |x: &SVector<T, NU>| gradient.dot(x) + x.dot(&product(hessian, x)) * constant(0.5);
        let mut slope = cost_slope_at(&x);
        let mut free = self.free_input_mask(&x, &slope);
        for _ in 0..ITERATIONS[0] * NU + ITERATIONS[1] {
            let reach = gradient.amax() + product(&hessian.abs(), &x.abs()).amax();
            let is_still =
                |(slope, free): (&T, &bool)| !free || slope.abs() <= reach * epsilon() * constant(16.0);
            if slope.iter().zip(&free).all(is_still) {
                break;
            }
            let mut step = vector_with_fixed_inputs_zeroed(&slope, &free);
            let (factor, pivots) = factors(&matrix_with_fixed_inputs_masked(hessian, &free), T::zero())
                .map_err(|input| Indefinite { input })?;
            solve(&factor, &pivots, &mut step);
            let (before, mut length) = (quadratic_cost(&x), T::one());
            let mut next = x;
            for _ in 0..HALVINGS {
                next = self.clamp(&(x + step * length));
                if quadratic_cost(&next) <= before + slope.dot(&(next - x)) * constant(DECREASE) {
                    break;
                }
                length *= constant(0.5);
            }
            if next == x {
                break;
            }
            x = next;
            slope = cost_slope_at(&x);
            free = self.free_input_mask(&x, &slope);
        }
        Ok((x, free))
    }
}

/// Returns the vector with zeros at the inputs that are not free.
fn vector_with_fixed_inputs_zeroed<T: Real, const NU: usize>(
    vector: &SVector<T, NU>,
    free: &[bool; NU],
) -> SVector<T, NU> {
    let mut masked = *vector;
    masked.iter_mut().zip(free).filter(|(_, free)| !**free).for_each(|(x, _)| *x = T::zero());
    masked
}

/// Returns the matrix with the rows and columns of the identity at the inputs that are not free.
fn matrix_with_fixed_inputs_masked<T: Real, const NU: usize>(
    matrix: &SMatrix<T, NU, NU>,
    free: &[bool; NU],
) -> SMatrix<T, NU, NU> {
    let mut masked = *matrix;
    for (j, (column, column_free)) in masked.data.0.iter_mut().zip(free).enumerate() {
        for (i, (entry, row_free)) in column.iter_mut().zip(free).enumerate() {
            if !(*column_free && *row_free) {
                *entry = if i == j { T::one() } else { T::zero() };
            }
        }
    }
    masked
}

/// Sets the columns of a matrix to zero where inputs are not free.
fn clear_limited_input_columns<T: Real, const NV: usize, const NU: usize>(
    matrix: &mut SMatrix<T, NV, NU>,
    free: &[bool; NU],
) {
    matrix
        .data
        .0
        .iter_mut()
        .zip(free)
        .filter(|(_, free)| !**free)
        .for_each(|(column, _)| *column = [T::zero(); NV]);
}

/// Computes the change of the inputs within limits that minimises the costs, and the resulting cost-to-go. An
/// input at a limit stays there for states near the trajectory: its gains are zero.
pub(super) fn minimise_over_limited_inputs<T: Real, const NV: usize, const NU: usize>(
    before: &mut Quadratic<T, NV, NU>,
    regularisation: T,
    limits: &InputLimits<T, NU>,
    policy: &mut Policy<T, NV, NU>,
    to_go: &mut Value<T, NV>,
) -> Result<(), Indefinite> {
    let mut hessian = before.uu;
    for (i, column) in hessian.data.0.iter_mut().enumerate() {
        column.iter_mut().skip(i).take(1).for_each(|entry| *entry += regularisation);
    }
    // All costs must be convex, at a limit as well: whether an input is at one changes between iterations.
    factors(&hessian, T::zero()).map_err(|input| Indefinite { input })?;
    let (change, free) = limits.minimise_within_limits((&before.u, &hessian), &policy.change)?;
    let expected = [before.u.dot(&change), change.dot(&product(&before.uu, &change)) * constant(0.5)];
    // Inputs at their limits change the costs like a known disturbance.
    let fixed = change - vector_with_fixed_inputs_zeroed(&change, &free);
    let mut disturbance = zeros();
    add_product(&mut disturbance, &before.uu, &fixed);
    let disturbed = before.u + disturbance;
    before.u = vector_with_fixed_inputs_zeroed(&disturbed, &free);
    let Quadratic { q, v, qu, vu, uu, .. } = before;
    add_product(q, qu, &fixed);
    add_product(v, vu, &fixed);
    clear_limited_input_columns(qu, &free);
    clear_limited_input_columns(vu, &free);
    *uu = matrix_with_fixed_inputs_masked(uu, &free);
    super::minimise_over_inputs(before, regularisation, policy, to_go)?;
    (policy.change, policy.expected) = (change, expected);
    Ok(())
}
