//! Accelerations and multipliers from what straight-line elimination found, as long as it loses few digits.

use super::Solution;
use super::span::{dot, orthogonal};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::SVector;

/// What must be left of a constraint's pivot after the other constraints took their part. Pivots are squares of lengths:
/// the accelerations keep three quarters of the digits.
fn tolerance<T: Real>() -> T {
    epsilon::<T>().sqrt().sqrt()
}

/// What a constraint must be beside others of its group: less is rounding for the most part. Squares of lengths, too.
fn noise<T: Real>() -> T {
    epsilon::<T>().cbrt()
}

/// The sum over the group of a constraint.
fn of_group<T: Real, const NC: usize>(groups: &[usize; NC], k: usize, each: impl Fn(usize) -> T) -> T {
    let own = |i: &usize| groups.get(*i) == groups.get(k);
    (0..NC).filter(own).fold(T::zero(), |sum, i| sum + each(i))
}

/// Splits the result of an elimination into accelerations and multipliers; `None` if a pivot is too small beside what
/// it was. `found` holds `NV` accelerations, and `NC` multipliers, pivots and former pivots.
#[inline]
pub fn regular_solution<T: Real, const NV: usize, const NC: usize, const N: usize>(
    groups: &[usize; NC],
    found: &[T; N],
) -> Option<Solution<T, NV, NC>> {
    (0..NC).all(|k| regular::<T, NV, NC, N>(groups, found, k)).then(|| split(found))
}

/// Accelerations and multipliers are the first of what was found.
#[inline]
pub(super) fn split<T: Real, const NV: usize, const NC: usize, const N: usize>(
    found: &[T; N],
) -> Solution<T, NV, NC> {
    let part = |k: usize| found.get(k).copied().unwrap_or(T::zero());
    (SVector::from_fn(|k, _| part(k)), SVector::from_fn(|k, _| part(NV + k)))
}

/// Whether the pivot of a constraint can be trusted; not so what is not a number.
#[inline]
fn regular<T: Real, const NV: usize, const NC: usize, const N: usize>(
    groups: &[usize; NC],
    found: &[T; N],
    k: usize,
) -> bool {
    let part = |k: usize| found.get(k).copied().unwrap_or(T::zero());
    let (pivot, before) = (part(NV + NC + k), |k: usize| part(NV + 2 * NC + k));
    pivot > tolerance::<T>() * before(k) && pivot > noise::<T>() * of_group(groups, k, before)
}

/// Whether the pivot of a contact that slips can be trusted: it must keep its sign, and nothing else decides.
#[inline]
pub(super) fn determined<T: Real, const NV: usize, const NC: usize, const N: usize>(
    groups: &[usize; NC],
    found: &[T; N],
    k: usize,
) -> bool {
    let part = |k: usize| found.get(k).copied().unwrap_or(T::zero());
    let (pivot, before) = (part(NV + NC + k), |k: usize| part(NV + 2 * NC + k));
    let least = epsilon::<T>().sqrt();
    pivot > least * before(k) && pivot > noise::<T>() * of_group(groups, k, before)
}

/// What [`regular_solution`] does with an elimination whose pivots are entries of the Jacobian, at places chosen in
/// advance. The pivots are squared, as are the lengths that their rows had. What rounding grows by is at most the product
/// of what the pivots lack of a third of their rows.
#[inline]
pub fn independent_solution<T: Real, const NV: usize, const NC: usize, const N: usize>(
    found: &[T; N],
) -> Option<Solution<T, NV, NC>> {
    let part = |k: usize| found.get(k).copied().unwrap_or(T::zero());
    let share = |k: usize| constant::<T>(9.0) * part(NV + NC + k) / part(NV + 2 * NC + k);
    // A share that is not a number must not be passed over.
    let product = (0..NC).fold(T::one(), |product, k| {
        let share = share(k);
        product * if share > T::one() { T::one() } else { share }
    });
    (product > tolerance::<T>() * constant(1e-2)).then(|| split(found))
}

/// The same for constraints of which some always follow from others, from what straight-line code has `found`: `NV`
/// free accelerations, `NC` numbers that the constraints lack of zero under those, the rows of `J M⁻¹ Jᵀ`, and for each
/// multiplier the `NV` accelerations that it gives. The multipliers are those of least norm; `None` unless `rank` of the
/// constraints are clearly independent, and the others clearly follow from them.
#[inline]
pub fn least_solution<T: Real, const NV: usize, const NC: usize, const N: usize>(
    groups: &[usize; NC],
    rank: usize,
    found: &[T; N],
) -> Option<Solution<T, NV, NC>> {
    let part = |k: usize| found.get(k).copied().unwrap_or(T::zero());
    let gram = core::array::from_fn(|i| core::array::from_fn(|j| part(NV + NC + i * NC + j)));
    let lambda = least_norm(groups, rank, gram, core::array::from_fn(|k| part(NV + k)))?;
    let given = |i: usize| NV + NC + NC * NC + i;
    let a = SVector::from_fn(|i, _| {
        let all = lambda.iter().enumerate();
        all.fold(part(i), |sum, (k, lambda)| sum + part(given(k * NV + i)) * *lambda)
    });
    Some((a, SVector::from(lambda)))
}

/// The solution of least norm of `A x = b` for a positive semidefinite `A` of the given rank: with `A = L Lᵀ` for as many
/// columns of `L` and `L = U S`, `x = U S⁻ᵀ S⁻¹ Uᵀ b` (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002,
/// § 10.3).
fn least_norm<T: Real, const N: usize>(
    groups: &[usize; N],
    rank: usize,
    mut a: [[T; N]; N],
    b: [T; N],
) -> Option<[T; N]> {
    let before: [T; N] = core::array::from_fn(|k| a[k][k]);
    let is_more = |k: usize| before[k] >= of_group(groups, k, |i| before[i]) * noise();
    let sound = (0..N).all(|k| before[k] == T::zero() || is_more(k));
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
        let k = best.filter(|k| part(*k, &a) > tolerance())?;
        taken[k] = true;
        let inverse = T::one() / a[k][k].sqrt();
        *column = core::array::from_fn(|i| if taken[i] && i != k { T::zero() } else { a[i][k] * inverse });
        for i in 0..N {
            for j in 0..N {
                a[i][j] -= column[i] * column[j];
            }
        }
    }
    // States between the steps of an integrator do not quite fulfil what follows from other constraints.
    let follow = (0..N).all(|k| taken[k] || part(k, &a) < epsilon::<T>().sqrt());
    if !follow {
        return None;
    }
    let upper = orthogonal(&mut columns, rank);
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
