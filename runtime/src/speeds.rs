//! Derivatives on the configuration space in declared speeds `u = Y(q) v` of the velocities `v = Z(q) u` that joints have, from
//! those in the velocities of the joints: what generated code composes.
//!
//! The matrix `G(q, u)` has as its columns how `Z(q) u` changes at constant `u` along the configurations that move with a speed.

use crate::Real;
use nalgebra::SMatrix;

type Square<T, const N: usize> = SMatrix<T, N, N>;

/// `(∂/∂q, ∂/∂dv)` of `q₁ = q ⊕ Z(q) dv`, from `Z(q)`, `Y(q₁)`, the derivatives for the joints' displacement, and `G(q, dv)`.
pub fn integrate_derivatives_in_speeds<T: Real, const N: usize>(
    z: &Square<T, N>,
    y: &Square<T, N>,
    (by_q, by_dv): &(Square<T, N>, Square<T, N>),
    changes: &Square<T, N>,
) -> (Square<T, N>, Square<T, N>) {
    (y * (by_q * z + by_dv * changes), y * by_dv * z)
}

/// `(∂/∂q, ∂/∂dv, ∂/∂v)` of `f = Y(q) R(Z(q) dv, Z(q₁) v)`, the rate of `dv` where `q₁ = q ⊕ dv` moves with the speeds `v`: from
/// `Y(q)`, `Z(q)` and `Z(q₁)`; the derivatives of `R`; those of `q₁`; and `G(q, dv)`, `G(q, f)` and `G(q₁, v)`.
pub fn displacement_rate_derivatives_in_speeds<T: Real, const N: usize>(
    [y, z, z_there]: [&Square<T, N>; 3],
    (by_way, by_rates): &(Square<T, N>, Square<T, N>),
    (moved_by_q, moved_by_dv): &(Square<T, N>, Square<T, N>),
    [changes, changes_of_rate, changes_there]: [&Square<T, N>; 3],
) -> (Square<T, N>, Square<T, N>, Square<T, N>) {
    let turned = by_rates * changes_there;
    (
        y * (by_way * changes + turned * moved_by_q - changes_of_rate),
        y * (by_way * z + turned * moved_by_dv),
        y * by_rates * z_there,
    )
}
