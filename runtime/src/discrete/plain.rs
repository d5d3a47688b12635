//! Steps of the classical Runge–Kutta method with their Jacobians, for mechanisms whose velocities are the
//! rates of the coordinates.
//!
//! Displacements are then sums of accelerations, so that only accelerations are propagated from stage to
//! stage. With the derivatives `K = (∂a/∂q, ∂a/∂v, ∂a/∂u)` of a stage's acceleration with respect to the
//! start, and `A_q`, `A_v`, `B` with respect to the point of evaluation, a stage at `q + s v + r a_i`, `v + s
//! a_j` has `K = (A_q, A_v + s A_q, B) + r A_q K_i + s A_v K_j`. One step takes five products of matrices
//! with such derivatives.

use super::Transition;
use super::explicit::{DifferentiatedStepStart, VectorWithDerivatives};
use crate::Real;
use crate::blocks::{add_multiple, add_product, weighted_matrix_sum};
use crate::derivatives::Derivatives;
use crate::private::constant;
use nalgebra::{SMatrix, SVector};

/// Coefficient and acceleration of an earlier Runge–Kutta stage. The acceleration has derivatives.
type EarlierStage<'a, T, const NV: usize, const NU: usize> = (T, &'a VectorWithDerivatives<T, NV, NU>);

impl<T: Real, const NV: usize, const NU: usize> VectorWithDerivatives<T, NV, NU> {
    /// Adds a matrix times the derivatives of another vector.
    fn add_matrix_product(&mut self, by: &SMatrix<T, NV, NV>, other: &Self) {
        add_product(&mut self.by_q, by, &other.by_q);
        add_product(&mut self.by_v, by, &other.by_v);
        add_product(&mut self.by_u, by, &other.by_u);
    }
}

/// Returns the acceleration of a Runge–Kutta stage `after` seconds after the start, with derivatives.
/// Multiples of the earlier accelerations `near` and `far` are added to the velocity and to the displacement
/// of the stage.
fn stage_acceleration_with_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
    v: &SVector<T, NV>,
    after: T,
    near: Option<EarlierStage<'_, T, NV, NU>>,
    far: Option<EarlierStage<'_, T, NV, NU>>,
) -> VectorWithDerivatives<T, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    let (mut displacement, mut velocity) = (v * after, *v);
    if let Some((s, near)) = near {
        velocity += near.value * s;
    }
    if let Some((r, far)) = far {
        displacement += far.value * r;
    }
    let q = start.mechanism.integrate(start.q, &displacement);
    let mut found = start.acceleration_with_derivatives(after, (&q, &velocity));
    if near.is_none() && far.is_none() {
        return found;
    }
    let parts = [near.map(|(s, _)| found.by_v * s), far.map(|(r, _)| found.by_q * r)];
    let by_q = found.by_q;
    add_multiple(&mut found.by_v, after, &by_q);
    for (by, part) in parts.iter().zip([near, far]) {
        if let (Some(by), Some((_, part))) = (by, part) {
            found.add_matrix_product(by, part);
        }
    }
    found
}

/// Returns the Runge–Kutta step of `h` seconds from a start with the velocity `v`, with its Jacobians.
pub(super) fn runge_kutta_transition<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
    v: &SVector<T, NV>,
    h: T,
) -> Transition<T, NQ, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    let half = h * constant(0.5);
    let k1 = stage_acceleration_with_derivatives(start, v, T::zero(), None, None);
    let k2 = stage_acceleration_with_derivatives(start, v, half, Some((half, &k1)), None);
    let k3 = stage_acceleration_with_derivatives(start, v, half, Some((half, &k2)), Some((half * half, &k1)));
    let k4 = stage_acceleration_with_derivatives(start, v, h, Some((h, &k3)), Some((h * half, &k2)));
    // q⁺ = q + h v + h²/6 (a₁ + a₂ + a₃), v⁺ = v + h/6 (a₁ + 2 a₂ + 2 a₃ + a₄).
    let sixth = h / constant(6.0);
    let change = weighted_sum(sixth, [(1.0, &k1), (2.0, &k2), (2.0, &k3), (1.0, &k4)]);
    let mut way = weighted_sum(h * sixth, [(1.0, &k1), (1.0, &k2), (1.0, &k3)]);
    way.value += v * h;
    let one = SMatrix::identity();
    Transition {
        q: start.mechanism.integrate(start.q, &way.value),
        v: v + change.value,
        q_by_q: way.by_q + one,
        q_by_v: way.by_v + one * h,
        q_by_u: way.by_u,
        v_by_q: change.by_q,
        v_by_v: change.by_v + one,
        v_by_u: change.by_u,
        chained: None,
    }
}

/// Returns the weighted sum `s Σ weight · term` of vectors with derivatives.
fn weighted_sum<T: Real, const NV: usize, const NU: usize, const N: usize>(
    s: T,
    terms: [(f64, &VectorWithDerivatives<T, NV, NU>); N],
) -> VectorWithDerivatives<T, NV, NU> {
    let weights = terms.map(|(weight, _)| s * constant(weight));
    VectorWithDerivatives {
        value: weighted_matrix_sum(&weights, terms.map(|(_, k)| &k.value)),
        by_q: weighted_matrix_sum(&weights, terms.map(|(_, k)| &k.by_q)),
        by_v: weighted_matrix_sum(&weights, terms.map(|(_, k)| &k.by_v)),
        by_u: weighted_matrix_sum(&weights, terms.map(|(_, k)| &k.by_u)),
    }
}
