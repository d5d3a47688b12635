//! Accelerations and multipliers from what straight-line elimination found, as long as it loses few digits.

use super::Solution;
use super::layout::{Elimination, Responses};
use super::span::{dot, orthogonal};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::SVector;

/// What must be left of a constraint's pivot after the other constraints took their part. Pivots are squares
/// of lengths: the accelerations keep three quarters of the digits.
fn tolerance<T: Real>() -> T {
    epsilon::<T>().sqrt().sqrt()
}

/// What a constraint must be beside others of its group: less is rounding for the most part. Squares of
/// lengths, too.
fn noise<T: Real>() -> T {
    epsilon::<T>().cbrt()
}

/// The sum over the group of a constraint.
fn of_group<T: Real, const NC: usize>(groups: &[usize; NC], k: usize, each: impl Fn(usize) -> T) -> T {
    let own = |i: &usize| groups.get(*i) == groups.get(k);
    (0..NC).filter(own).fold(T::zero(), |sum, i| sum + each(i))
}

/// Splits the result of an elimination into accelerations and multipliers; `None` if a pivot is too small
/// beside what it was.
#[inline]
pub fn regular_solution<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    found: &Elimination<T, NV, NC>,
) -> Option<Solution<T, NV, NC>> {
    (0..NC).all(|k| regular(groups, found, k)).then(|| found.solution())
}

impl<T: Real, const NV: usize, const NC: usize> Elimination<T, NV, NC> {
    /// Accelerations and multipliers.
    #[inline]
    pub(super) fn solution(&self) -> Solution<T, NV, NC> {
        (SVector::from(self.accelerations), SVector::from(self.multipliers))
    }

    /// The pivot of a constraint, and what it was before; zeros for one that is none.
    #[inline]
    fn pivot(&self, k: usize) -> (T, T) {
        let of = |list: &[T; NC]| list.get(k).copied().unwrap_or(T::zero());
        (of(&self.pivots), of(&self.before))
    }
}

/// Whether the pivot of a constraint can be trusted; not so what is not a number.
#[inline]
fn regular<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    found: &Elimination<T, NV, NC>,
    k: usize,
) -> bool {
    let (pivot, before) = found.pivot(k);
    pivot > tolerance::<T>() * before && pivot > noise::<T>() * of_group(groups, k, |k| found.pivot(k).1)
}

/// Whether the pivot of a contact that slips can be trusted: it must keep its sign, and nothing else decides.
#[inline]
pub(super) fn determined<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    found: &Elimination<T, NV, NC>,
    k: usize,
) -> bool {
    let (pivot, before) = found.pivot(k);
    let least = epsilon::<T>().sqrt();
    pivot > least * before && pivot > noise::<T>() * of_group(groups, k, |k| found.pivot(k).1)
}

/// What [`regular_solution`] does with an elimination whose pivots are entries of the Jacobian, at places
/// chosen in advance. The pivots are squared, as are the lengths that their rows had. What rounding grows by
/// is at most the product of what the pivots lack of a third of their rows.
#[inline]
pub fn independent_solution<T: Real, const NV: usize, const NC: usize>(
    found: &Elimination<T, NV, NC>,
) -> Option<Solution<T, NV, NC>> {
    let share = |k: usize| {
        let (pivot, before) = found.pivot(k);
        constant::<T>(9.0) * pivot / before
    };
    // A share that is not a number must not be passed over.
    let product = (0..NC).fold(T::one(), |product, k| {
        let share = share(k);
        product * if share > T::one() { T::one() } else { share }
    });
    (product > tolerance::<T>() * constant(1e-2)).then(|| found.solution())
}

/// Accelerations and multipliers of constraints of which some always follow from others. The multipliers are
/// those of least norm; `None` unless `rank` of the constraints are clearly independent, and the others
/// clearly follow from them.
#[inline]
pub fn least_solution<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    rank: usize,
    found: &Responses<T, NV, NC>,
) -> Option<Solution<T, NV, NC>> {
    let lambda = least_norm(groups, rank, found.gram, found.lacking)?;
    let mut a = found.free;
    for (lambda, given) in lambda.iter().zip(&found.given) {
        a.iter_mut().zip(given).for_each(|(a, given)| *a += *given * *lambda);
    }
    Some((SVector::from(a), SVector::from(lambda)))
}

/// The solution of least norm of `A x = b` for a positive semidefinite `A` of the given rank: with `A = L Lᵀ`
/// for as many columns of `L` and `L = U S`, `x = U S⁻ᵀ S⁻¹ Uᵀ b` (Higham, *Accuracy and Stability of
/// Numerical Algorithms*, 2002, § 10.3).
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
