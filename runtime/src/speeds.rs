//! Derivatives on the configuration manifold with respect to declared generalized speeds `u = Y(q) v`,
//! composed from derivatives with respect to the joint velocities `v = Z(q) u`; used by generated code.
//!
//! Column `i` of the matrix `G(q, u)` is the change of `Z(q) u` at constant `u` along the configurations that
//! move with speed `i`.

use crate::discrete::eliminate_with_pivoting;
use crate::private::{constant, epsilon};
use crate::{Derivatives, Mechanism, Real};
use nalgebra::{SMatrix, SVector};

type SquareMatrix<T, const N: usize> = SMatrix<T, N, N>;

/// Maximum number of iterations for a displacement; each reduces the error by a factor of about the angle
/// through which the axes of the speeds rotate.
const MOST_ITERATIONS: usize = 50;

/// Returns the displacement `ξ = s ξ̇(ξ, v)` after `s` seconds, given the generalized speeds `v` at its end
/// and the rate `ξ̇` of a displacement. Midpoints of the implicit midpoint rule have this form. The result is
/// `s v` if the speeds are joint velocities.
///
/// If the iteration does not converge, the last iterate is returned: integration methods check their own
/// equations.
pub(crate) fn displacement_given_final_velocity<T: Real, const N: usize>(
    rate: impl Fn(&SVector<T, N>) -> SVector<T, N>,
    v: &SVector<T, N>,
    s: T,
) -> SVector<T, N> {
    let mut way = v * s;
    let mut last = None;
    for _ in 0..MOST_ITERATIONS {
        let next = rate(&way) * s;
        let change = (next - way).amax();
        way = next;
        let stalls = last.is_some_and(|last| change >= last);
        if change <= way.amax() * epsilon() || (stalls && change <= way.amax() * epsilon::<T>().sqrt()) {
            break;
        }
        last = Some(change);
    }
    way
}

/// Returns the displacement of a mechanism after `s` seconds, given the velocity at its end (see
/// [`displacement_given_final_velocity`]).
pub(crate) fn mechanism_displacement_given_final_velocity<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
>(
    m: &M,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    s: T,
) -> SVector<T, NV>
where
    T: Real,
    M: Mechanism<NQ, NV, NU, Scalar = T> + ?Sized,
{
    if m.features().speeds {
        displacement_given_final_velocity(|way| m.displacement_rate(q, way, v), v, s)
    } else {
        v * s
    }
}

/// Returns the velocity of the midpoint of a displacement that takes `2 s` seconds, given the mean rate of
/// the displacement.
pub(crate) fn midpoint_velocity<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<T, NQ>,
    mean: SVector<T, NV>,
    s: T,
) -> SVector<T, NV>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    if !m.features().speeds {
        return mean;
    }
    // The rate of a displacement is linear in the velocity.
    let (.., by_v) = m.displacement_rate_derivatives(q, &(mean * s), &mean);
    eliminate_with_pivoting(by_v, mean)
}

/// Returns the derivatives of the configurations reached from `q` with the midpoint velocity `v` after `s`
/// and after `2 s` seconds, with respect to `q` and to the displacement `s v`, or `2 s v`, in joint
/// velocities.
pub(crate) fn reached_configuration_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    s: T,
) -> [(SquareMatrix<T, NV>, SquareMatrix<T, NV>); 2]
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    let two = constant::<T>(2.0);
    let way = mechanism_displacement_given_final_velocity(m, q, v, s);
    if !m.features().speeds {
        return [m.integrate_derivatives(&way), m.integrate_derivatives(&(v * (s * two)))];
    }
    // δξ = s (∂ξ̇/∂q δq + ∂ξ̇/∂ξ δξ + ∂ξ̇/∂v δv)
    let (by_q, by_way, by_v) = m.displacement_rate_derivatives(q, &way, v);
    let own = SquareMatrix::<T, NV>::identity() - by_way * s;
    let (by_q, by_v) = (eliminate_with_pivoting(own, by_q * s), eliminate_with_pivoting(own, by_v));
    let derivatives_at_scaled_displacement = |times: T| {
        let (turned, moves) = m.integrate_derivatives_at(q, &(way * times));
        (turned + moves * by_q * times, moves * by_v)
    };
    [derivatives_at_scaled_displacement(T::one()), derivatives_at_scaled_displacement(two)]
}

/// Returns the derivatives `(∂/∂q, ∂/∂dv)` of the displaced configuration `q₁ = q ⊕ Z(q) dv` in generalized
/// speeds, from `Z(q)`, `Y(q₁)`, the derivatives for the joints' displacement, and `G(q, dv)`.
pub fn integrate_derivatives_in_speeds<T: Real, const N: usize>(
    z: &SquareMatrix<T, N>,
    y: &SquareMatrix<T, N>,
    (by_q, by_dv): &(SquareMatrix<T, N>, SquareMatrix<T, N>),
    changes: &SquareMatrix<T, N>,
) -> (SquareMatrix<T, N>, SquareMatrix<T, N>) {
    (y * (by_q * z + by_dv * changes), y * by_dv * z)
}

/// Returns the derivatives `(∂/∂q, ∂/∂dv, ∂/∂v)` of `f = Y(q) R(Z(q) dv, Z(q₁) v)`: the rate of `dv` for
/// which `q₁ = q ⊕ dv` moves with the generalized speeds `v`. Arguments are `Y(q)`, `Z(q)` and `Z(q₁)`; the
/// derivatives of `R` and of `q₁`; and `G(q, dv)`, `G(q, f)` and `G(q₁, v)`.
pub fn displacement_rate_derivatives_in_speeds<T: Real, const N: usize>(
    [y, z, z_there]: [&SquareMatrix<T, N>; 3],
    (by_way, by_rates): &(SquareMatrix<T, N>, SquareMatrix<T, N>),
    (moved_by_q, moved_by_dv): &(SquareMatrix<T, N>, SquareMatrix<T, N>),
    [changes, changes_of_rate, changes_there]: [&SquareMatrix<T, N>; 3],
) -> (SquareMatrix<T, N>, SquareMatrix<T, N>, SquareMatrix<T, N>) {
    let turned = by_rates * changes_there;
    (
        y * (by_way * changes + turned * moved_by_q - changes_of_rate),
        y * (by_way * z + turned * moved_by_dv),
        y * by_rates * z_there,
    )
}
