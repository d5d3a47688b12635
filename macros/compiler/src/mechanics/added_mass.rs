//! Forces that are linear in accelerations, such as added mass of water and forces due to the rate of the
//! angle of attack. A force `Σ cₖ v̇ₖ` on a velocity `ṡ` contributes `(∂ṡ/∂v)ᵀ c v̇` to the generalized
//! forces, so that the equation of motion is
//!
//! `(M − Σ (∂ṡ/∂v)ᵀ c) v̇ + h = τ`.
//!
//! The effective mass matrix depends on the velocities if the factors `c` do. It is symmetric if `c` is a
//! multiple of `∂ṡ/∂v` (Lamb, *Hydrodynamics*, 1932, ch. VI; Etkin and Reid, *Dynamics of Flight*, 1996, §
//! 4.9).

use super::crba::Matrix;
use crate::expr::Expr;
use crate::kinematics::cached_velocity_gradient;
use crate::mechanism::Model;

/// Returns the effective mass matrix: `mass` minus the coefficients of the forces that are linear in
/// accelerations.
pub fn effective_mass_matrix<'g>(model: &Model<'g>, mass: &Matrix<'g>) -> Matrix<'g> {
    let mut m = mass.clone();
    for force in &model.acceleration_forces {
        for (i, d) in cached_velocity_gradient(model, force.rate) {
            for (k, factor) in &force.factors {
                m[i][*k] -= d * *factor;
            }
        }
    }
    m
}

/// Subtracts the forces that are linear in accelerations, evaluated at the accelerations `a`, from `tau`.
pub fn subtract_acceleration_forces<'g>(model: &Model<'g>, a: &[Expr<'g>], tau: &mut [Expr<'g>]) {
    for force in &model.acceleration_forces {
        let terms = force.factors.iter().map(|(k, factor)| *factor * a[*k]);
        let value = terms.fold(model.graph.zero(), |sum, term| sum + term);
        for (i, d) in cached_velocity_gradient(model, force.rate) {
            tau[i] -= value * d;
        }
    }
}
