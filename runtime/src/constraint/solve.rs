//! Accelerations and multipliers from straight-line elimination, if its loss of accuracy is small.

use super::Solution;
use super::layout::{Elimination, Responses};
use super::span::{dot, orthonormalise_vectors};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::SVector;

/// Returns the minimum ratio of a constraint's pivot to its value before elimination of the other
/// constraints. Pivots are squared lengths: accelerations retain three quarters of the digits.
fn minimum_pivot_ratio<T: Real>() -> T {
    epsilon::<T>().sqrt().sqrt()
}

/// Returns the minimum ratio of a pivot to the pivots of its group of constraints. Smaller pivots are mostly
/// rounding errors. Pivots are squared lengths.
fn minimum_pivot_ratio_in_group<T: Real>() -> T {
    epsilon::<T>().cbrt()
}

/// Returns the sum of `each` over the constraints in the group of constraint `k`.
fn sum_over_constraint_group<T: Real, const NC: usize>(
    groups: &[usize; NC],
    k: usize,
    each: impl Fn(usize) -> T,
) -> T {
    let is_in_group = |i: &usize| groups.get(*i) == groups.get(k);
    (0..NC).filter(is_in_group).fold(T::zero(), |sum, i| sum + each(i))
}

/// Splits the result of an elimination into accelerations and multipliers. Returns `None` if a pivot is too
/// small relative to its value before elimination.
#[inline]
pub fn regular_solution<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    found: &Elimination<T, NV, NC>,
) -> Option<Solution<T, NV, NC>> {
    (0..NC).all(|k| has_accurate_pivot(groups, found, k)).then(|| found.accelerations_and_multipliers())
}

impl<T: Real, const NV: usize, const NC: usize> Elimination<T, NV, NC> {
    /// Returns the accelerations and multipliers of the elimination as vectors.
    #[inline]
    pub(super) fn accelerations_and_multipliers(&self) -> Solution<T, NV, NC> {
        (SVector::from(self.accelerations), SVector::from(self.multipliers))
    }

    /// Returns the pivot of a constraint, and its value before elimination; zeros if the index is out of
    /// range.
    #[inline]
    fn pivot_and_initial_value(&self, k: usize) -> (T, T) {
        let entry_or_zero = |list: &[T; NC]| list.get(k).copied().unwrap_or(T::zero());
        (entry_or_zero(&self.pivots), entry_or_zero(&self.before))
    }
}

/// Returns whether the pivot of a constraint is sufficiently accurate; false for NaN.
#[inline]
fn has_accurate_pivot<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    found: &Elimination<T, NV, NC>,
    k: usize,
) -> bool {
    let (pivot, before) = found.pivot_and_initial_value(k);
    pivot > minimum_pivot_ratio::<T>() * before
        && pivot
            > minimum_pivot_ratio_in_group::<T>()
                * sum_over_constraint_group(groups, k, |k| found.pivot_and_initial_value(k).1)
}

/// Returns whether the pivot of a sliding contact is accurate enough: it must be positive and clearly above
/// rounding error, so that rounding cannot change its sign.
#[inline]
pub(super) fn has_determined_pivot<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    found: &Elimination<T, NV, NC>,
    k: usize,
) -> bool {
    let (pivot, before) = found.pivot_and_initial_value(k);
    let least = epsilon::<T>().sqrt();
    pivot > least * before
        && pivot
            > minimum_pivot_ratio_in_group::<T>()
                * sum_over_constraint_group(groups, k, |k| found.pivot_and_initial_value(k).1)
}

/// Splits the result of an elimination whose pivots are entries of the Jacobian in predetermined columns.
/// Pivots and the lengths of their rows before elimination are squared. The growth of rounding errors is
/// bounded by the product of the ratios of a third of the row lengths to the pivots.
#[inline]
pub fn solution_with_predetermined_pivots<T: Real, const NV: usize, const NC: usize>(
    found: &Elimination<T, NV, NC>,
) -> Option<Solution<T, NV, NC>> {
    let relative_pivot = |k: usize| {
        let (pivot, before) = found.pivot_and_initial_value(k);
        constant::<T>(9.0) * pivot / before
    };
    // A ratio of NaN must not be skipped.
    let product = (0..NC).fold(T::one(), |product, k| {
        let share = relative_pivot(k);
        product * if share > T::one() { T::one() } else { share }
    });
    (product > minimum_pivot_ratio::<T>() * constant(1e-2)).then(|| found.accelerations_and_multipliers())
}

/// Returns accelerations and multipliers of mechanisms with redundant constraints. The multipliers have
/// minimum norm. Returns `None` unless exactly `rank` constraints are clearly independent.
#[inline]
pub fn least_solution<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    rank: usize,
    found: &Responses<T, NV, NC>,
) -> Option<Solution<T, NV, NC>> {
    let lambda = least_norm_solution(groups, rank, found.gram, found.lacking)?;
    let mut a = found.free;
    for (lambda, given) in lambda.iter().zip(&found.given) {
        a.iter_mut().zip(given).for_each(|(a, given)| *a += *given * *lambda);
    }
    Some((SVector::from(a), SVector::from(lambda)))
}

/// Returns the minimum-norm solution of `A x = b` for a positive semidefinite `A` of the given rank. With `A
/// = L Lᵀ` for `rank` columns of `L`, and `L = U S`, the solution is `x = U S⁻ᵀ S⁻¹ Uᵀ b` (Higham, *Accuracy
/// and Stability of Numerical Algorithms*, 2002, § 10.3).
fn least_norm_solution<T: Real, const N: usize>(
    groups: &[usize; N],
    rank: usize,
    mut a: [[T; N]; N],
    b: [T; N],
) -> Option<[T; N]> {
    let before: [T; N] = core::array::from_fn(|k| a[k][k]);
    let is_above_noise = |k: usize| {
        before[k] >= sum_over_constraint_group(groups, k, |i| before[i]) * minimum_pivot_ratio_in_group()
    };
    let sound = (0..N).all(|k| before[k] == T::zero() || is_above_noise(k));
    if !sound {
        return None;
    }
    let part =
        |k: usize, a: &[[T; N]; N]| if before[k] > T::zero() { a[k][k] / before[k] } else { T::zero() };
    let mut columns = [[T::zero(); N]; N];
    let mut taken = [false; N];
    for column in columns.iter_mut().take(rank) {
        let best = (0..N)
            .filter(|k| !taken[*k])
            .max_by(|i, j| part(*i, &a).partial_cmp(&part(*j, &a)).unwrap_or(core::cmp::Ordering::Equal));
        let k = best.filter(|k| part(*k, &a) > minimum_pivot_ratio())?;
        taken[k] = true;
        let inverse = T::one() / a[k][k].sqrt();
        *column = core::array::from_fn(|i| if taken[i] && i != k { T::zero() } else { a[i][k] * inverse });
        for i in 0..N {
            for j in 0..N {
                a[i][j] -= column[i] * column[j];
            }
        }
    }
    // States between the steps of an integrator do not satisfy redundant constraints exactly.
    let follow = (0..N).all(|k| taken[k] || part(k, &a) < epsilon::<T>().sqrt());
    if !follow {
        return None;
    }
    let upper = orthonormalise_vectors(&mut columns, rank);
    let mut y = columns.map(|u| dot(&u, &b));
    for j in (0..N).rev() {
        if j >= rank {
            continue;
        }
        y[j] = (j + 1..N).filter(|i| *i < rank).fold(y[j], |sum, i| sum - upper[j][i] * y[i]) / upper[j][j];
    }
    for j in 0..N {
        if j >= rank {
            break;
        }
        y[j] = (0..j).fold(y[j], |sum, i| sum - upper[i][j] * y[i]) / upper[j][j];
    }
    Some(core::array::from_fn(|k| {
        (0..N).filter(|i| *i < rank).fold(T::zero(), |sum, i| sum + columns[i][k] * y[i])
    }))
}
