//! Forces linear in accelerations: of the rates of angles of attack, of water that a body carries along. A force `Σ cₖ v̇ₖ` on a
//! rate `ṡ` contributes `(∂ṡ/∂v)ᵀ c v̇` to the generalized forces, so that the equation of motion is
//!
//! `(M − Σ (∂ṡ/∂v)ᵀ c) v̇ + h = τ`.
//!
//! The matrix depends on the velocities where the factors `c` do, and is symmetric where `c` is a multiple of `∂ṡ/∂v` (Lamb,
//! *Hydrodynamics*, 1932, ch. VI; Etkin and Reid, *Dynamics of Flight*, 1996, § 4.9).

use super::crba::Matrix;
use crate::expr::Expr;
use crate::kinematics::known_gradient;
use crate::mechanism::Model;

/// What is to be multiplied by the accelerations: the mass matrix less these forces.
pub fn effective<'g>(model: &Model<'g>, mass: &Matrix<'g>) -> Matrix<'g> {
    let mut m = mass.clone();
    for force in &model.acceleration_forces {
        for (i, d) in known_gradient(model, force.rate) {
            for (k, factor) in &force.factors {
                m[i][*k] -= d * *factor;
            }
        }
    }
    m
}

/// Subtracts them from what the accelerations `a` ask for.
pub fn subtract_from_forces<'g>(model: &Model<'g>, a: &[Expr<'g>], tau: &mut [Expr<'g>]) {
    for force in &model.acceleration_forces {
        let terms = force.factors.iter().map(|(k, factor)| *factor * a[*k]);
        let value = terms.fold(model.graph.zero(), |sum, term| sum + term);
        for (i, d) in known_gradient(model, force.rate) {
            tau[i] -= value * d;
        }
    }
}
