//! What generated code calls to solve for accelerations and multipliers where its own elimination cannot be trusted:
//! in singular configurations and with redundant constraints.

use super::Solution;
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// What may be left of a constraint's pivot after the other constraints took their part.
fn tolerance<T: Real>() -> T {
    if epsilon::<T>() < constant(1e-10) { constant(1e-8) } else { constant(1e-4) }
}

/// Splits the result of an elimination into accelerations and multipliers; `None` if a pivot is too small beside what
/// it was. `found` holds `NV` accelerations, and `NC` multipliers, pivots and former pivots.
#[inline]
pub fn regular_solution<T: Real, const NV: usize, const NC: usize, const N: usize>(
    found: &[T; N],
) -> Option<Solution<T, NV, NC>> {
    if !(0..NC).all(|k| regular::<T, NV, NC, N>(found, k)) {
        return None;
    }
    let part = |k: usize| found.get(k).copied().unwrap_or(T::zero());
    Some((SVector::from_fn(|k, _| part(k)), SVector::from_fn(|k, _| part(NV + k))))
}

/// Whether the pivot of a constraint can be trusted; not so what is not a number.
#[inline]
pub fn regular<T: Real, const NV: usize, const NC: usize, const N: usize>(found: &[T; N], k: usize) -> bool {
    match (found.get(NV + NC + k), found.get(NV + 2 * NC + k)) {
        (Some(pivot), Some(before)) => *pivot > tolerance::<T>() * *before,
        _ => false,
    }
}

/// `v̇` and the multipliers of least norm: `M v̇ = f + Jᵀ λ`, `J v̇ = −b`. Constraints that follow from others are
/// found by a factorisation with pivots (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, § 10.3); where
/// they contradict each other, the least squares count. Constraints of one number in `groups` are components of one
/// vector; those in `determining` determine coordinates without inertia, and the mass matrix is made regular by them.
pub fn least_multipliers<T: Real, const NV: usize, const NC: usize>(
    groups: &[usize; NC],
    determining: &[usize],
    mass: &SMatrix<T, NV, NV>,
    jacobian: &SMatrix<T, NC, NV>,
    force: &SVector<T, NV>,
    bias: &SVector<T, NC>,
) -> Solution<T, NV, NC> {
    let (mut mass, mut force) = (mass.data.0, force.data.0[0]);
    let weight = (0..NV).fold(T::zero(), |most, k| most.max(mass[k][k]));
    for (row, bias) in bias.data.0[0].iter().enumerate().filter(|(row, _)| determining.contains(row)) {
        for i in 0..NV {
            let heavy = jacobian.data.0[i][row] * weight;
            force[i] -= heavy * *bias;
            for j in 0..NV {
                mass[j][i] += heavy * jacobian.data.0[j][row];
            }
        }
    }
    let factors = Factors::of(&mass);
    let rows: [[T; NV]; NC] = core::array::from_fn(|k| core::array::from_fn(|i| jacobian.data.0[i][k]));
    let (free, given) = (factors.solve(force), rows.map(|row| factors.solve(row)));
    let dot = |a: &[T; NV], b: &[T; NV]| a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b);
    let gram = core::array::from_fn(|i| core::array::from_fn(|j| dot(&rows[i.max(j)], &given[i.min(j)])));
    let lacking = core::array::from_fn(|k| -bias.data.0[0][k] - dot(&rows[k], &free));
    let lambda = least_norm(groups, gram, lacking);
    let mut a = free;
    for (given, lambda) in given.iter().zip(&lambda) {
        a.iter_mut().zip(given).for_each(|(sum, x)| *sum += *x * *lambda);
    }
    (SVector::from(a), SVector::from(lambda))
}

/// The same for constraints of which some always follow from others, from what straight-line code has `found`: `NV`
/// free accelerations, `NC` numbers that the constraints lack of zero under those, the rows of `J M⁻¹ Jᵀ`, and for each
/// multiplier the `NV` accelerations that it gives.
#[inline]
pub fn least_solution<T: Real, const NV: usize, const NC: usize, const N: usize>(
    groups: &[usize; NC],
    found: &[T; N],
) -> Solution<T, NV, NC> {
    let part = |k: usize| found.get(k).copied().unwrap_or(T::zero());
    let gram = core::array::from_fn(|i| core::array::from_fn(|j| part(NV + NC + i * NC + j)));
    let lambda = least_norm(groups, gram, core::array::from_fn(|k| part(NV + k)));
    let given = |i: usize| NV + NC + NC * NC + i;
    let a = SVector::from_fn(|i, _| {
        let all = lambda.iter().enumerate();
        all.fold(part(i), |sum, (k, lambda)| sum + part(given(k * NV + i)) * *lambda)
    });
    (a, SVector::from(lambda))
}

/// `A = L D Lᵀ`: the rows of `L` below its diagonal of ones, and the reciprocals of `D`.
struct Factors<T, const N: usize> {
    lower: [[T; N]; N],
    inverse: [T; N],
}

impl<T: Real, const N: usize> Factors<T, N> {
    fn of(a: &[[T; N]; N]) -> Self {
        let (mut lower, mut inverse) = ([[T::zero(); N]; N], [T::zero(); N]);
        for i in 0..N {
            let mut scaled = [T::zero(); N];
            for j in 0..i {
                scaled[j] = (0..j).fold(a[i][j], |sum, k| sum - scaled[k] * lower[j][k]);
                lower[i][j] = scaled[j] * inverse[j];
            }
            inverse[i] = T::one() / (0..i).fold(a[i][i], |sum, k| sum - scaled[k] * lower[i][k]);
        }
        Self { lower, inverse }
    }

    /// `A⁻¹ b`.
    fn solve(&self, mut b: [T; N]) -> [T; N] {
        for i in 0..N {
            b[i] = (0..i).fold(b[i], |sum, k| sum - self.lower[i][k] * b[k]);
        }
        for i in (0..N).rev() {
            b[i] = (i + 1..N).fold(b[i] * self.inverse[i], |sum, k| sum - self.lower[k][i] * b[k]);
        }
        b
    }
}

/// The solution of least norm of `A x = b` for a positive semidefinite `A`: with `A = L Lᵀ` for as many columns of `L` as
/// `A` has rank, `x = L (LᵀL)⁻² Lᵀ b`.
fn least_norm<T: Real, const N: usize>(groups: &[usize; N], mut a: [[T; N]; N], b: [T; N]) -> [T; N] {
    let before: [T; N] = core::array::from_fn(|k| {
        (0..N).filter(|i| groups[*i] == groups[k]).fold(T::zero(), |sum, i| sum + a[i][i])
    });
    let mut columns = [[T::zero(); N]; N];
    let mut taken = [false; N];
    let mut rank = 0;
    for column in &mut columns {
        let part =
            |k: usize, a: &[[T; N]; N]| if before[k] > T::zero() { a[k][k] / before[k] } else { T::zero() };
        let best = (0..N)
            .filter(|k| !taken[*k])
            .max_by(|i, j| part(*i, &a).partial_cmp(&part(*j, &a)).unwrap_or(core::cmp::Ordering::Equal));
        let Some(k) = best.filter(|k| part(*k, &a) > tolerance()) else { break };
        taken[k] = true;
        rank += 1;
        let inverse = T::one() / a[k][k].sqrt();
        *column = core::array::from_fn(|i| if taken[i] && i != k { T::zero() } else { a[i][k] * inverse });
        for i in 0..N {
            for j in 0..N {
                a[i][j] -= column[i] * column[j];
            }
        }
    }
    // Columns beyond the rank are zero; a one on the diagonal keeps their part of the system regular.
    let gram: [[T; N]; N] = core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let sum = (0..N).fold(T::zero(), |sum, k| sum + columns[i][k] * columns[j][k]);
            if i == j && i >= rank { T::one() } else { sum }
        })
    });
    let factors = Factors::of(&gram);
    let y = core::array::from_fn(|i| (0..N).fold(T::zero(), |sum, k| sum + columns[i][k] * b[k]));
    let y = factors.solve(factors.solve(y));
    core::array::from_fn(|k| (0..N).fold(T::zero(), |sum, i| sum + columns[i][k] * y[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A particle on a line in the plane, held by the same constraint twice: each carries half of the force.
    #[test]
    fn redundant_constraints_share_the_force() {
        let mass = SMatrix::<f64, 2, 2>::identity() * 2.0;
        let jacobian = SMatrix::<f64, 2, 2>::new(0.0, 1.0, 0.0, 1.0);
        let (a, lambda) = least_multipliers(
            &[0, 1],
            &[],
            &mass,
            &jacobian,
            &SVector::from([3.0, -20.0]),
            &SVector::zeros(),
        );
        assert!((a - SVector::from([1.5, 0.0])).norm() < 1e-14);
        assert!((lambda - SVector::from([10.0, 10.0])).norm() < 1e-14);
    }

    /// A mass on a line, and a coordinate without inertia that is twice its place: the force on both moves the mass.
    #[test]
    fn coordinates_without_inertia_are_determined() {
        let mass = SMatrix::<f64, 2, 2>::new(4.0, 0.0, 0.0, 0.0);
        let jacobian = SMatrix::<f64, 1, 2>::new(-2.0, 1.0);
        let (force, bias) = (SVector::from([1.0, 3.0]), SVector::from([0.5]));
        let (a, lambda) = least_multipliers(&[0], &[0], &mass, &jacobian, &force, &bias);
        assert!((a - SVector::from([1.75, 3.0])).norm() < 1e-14, "{a}");
        assert!((lambda[0] + 3.0).abs() < 1e-14, "{lambda}");
    }

    /// Regular constraints: the equations themselves hold.
    #[test]
    fn regular_constraints_fulfil_the_equations() {
        let mass = SMatrix::<f64, 3, 3>::new(4.0, 1.0, 0.5, 1.0, 3.0, 0.2, 0.5, 0.2, 2.0);
        let jacobian = SMatrix::<f64, 2, 3>::new(1.0, -2.0, 0.3, 0.4, 0.1, 2.0);
        let (force, bias) = (SVector::from([1.0, 2.0, 3.0]), SVector::from([0.7, -0.2]));
        let (a, lambda) = least_multipliers(&[0, 1], &[], &mass, &jacobian, &force, &bias);
        assert!((mass * a - force - jacobian.transpose() * lambda).norm() < 1e-13);
        assert!((jacobian * a + bias).norm() < 1e-13);
    }
}
