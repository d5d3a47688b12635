//! First derivatives of the equations of motion, on the tangent space of the configurations: column `i` of a derivative
//! by `q` is along `q ⊕ ε eᵢ` (for ball and free joints: a motion in body axes, as in Pinocchio). With
//! `τ = ID(q, v, a)`, differentiating `ID(q, v, FD(q, v, τ)) = τ` gives `∂v̇/∂x = −M⁻¹ ∂ID/∂x` at `a = v̇`
//! (Carpentier and Mansard, *Analytical derivatives of rigid body dynamics algorithms*, 2018, § IV).

use super::crba::Matrix;
use super::{accelerations, rnea, velocities};
use crate::expr::Expr;
use crate::expr::replace::replace_all;
use crate::kinematics::Joint;
use crate::mechanism::{Model, Quantity};

pub mod analytic;
mod columns;
mod factor;
pub mod invariance;
pub mod parameters;
pub mod second;
mod subtree;
pub mod symbolic;
mod trunk;

pub use factor::Factor;
pub use trunk::{Inverse, Trunk, divided};

/// Derivatives of forces: a row for each entry of `τ`, a column for each velocity.
pub struct ForceDerivatives<'g> {
    /// `∂τ/∂q`.
    pub by_q: Matrix<'g>,
    /// `∂τ/∂v`.
    pub by_v: Matrix<'g>,
}

/// The equations of motion to first order about a state: `M δv̇ + ∂q δq + ∂v δv = δτ`.
pub struct Linearized<'g> {
    /// Derivatives of all forces but inertia and `τ`.
    pub forces: ForceDerivatives<'g>,
    /// What the inputs do: `∂τ/∂u`; no columns if `τ` itself is given.
    pub by_u: Matrix<'g>,
    /// `M⁻¹`.
    pub inverse: Matrix<'g>,
    /// The accelerations at which these are the derivatives.
    pub accelerations: Vec<Expr<'g>>,
}

/// How the derivatives of inverse dynamics are found. The results are equal; what they cost is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// By recursion, in up to so many lanes, where every motion subspace is constant in link axes; else by
    /// differentiation.
    Recursion(usize),
    /// By differentiation of the equations. It costs less where axes are parallel or meet, for a few degrees of freedom.
    Differentiation,
}

/// Derivatives of inverse dynamics at the accelerations `a`.
pub fn inverse_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    a: &[Expr<'g>],
    method: Method,
) -> ForceDerivatives<'g> {
    let v = velocities(model);
    if let Method::Recursion(most) = method
        && is_analytic(model)
    {
        let mut found = analytic::inverse_dynamics(model, joints, &v, a, most);
        symbolic::add_passive_forces(model, &mut found);
        return found;
    }
    let symbols = accelerations(model);
    let found = symbolic::derivatives(model, &rnea::inverse_dynamics(model, joints, &v, Some(&symbols)));
    if a == symbols {
        return found;
    }
    let by = |s| match Quantity::of(s) {
        Quantity::Acceleration(k) => Some(a[k]),
        _ => None,
    };
    let replaced = |m: Matrix<'g>| m.iter().map(|row| replace_all(row, &by)).collect();
    ForceDerivatives { by_q: replaced(found.by_q), by_v: replaced(found.by_v) }
}

/// The equations of motion about the motion that the forces `tau` give.
pub fn forward_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    tau: &[Expr<'g>],
    method: Method,
) -> Linearized<'g> {
    let factor = Factor::of(mass, joints);
    let bias = rnea::inverse_dynamics(model, joints, &velocities(model), None);
    let r = tau.iter().zip(&bias).map(|(t, h)| *t - *h).collect();
    let accelerations = factor.solve(r);
    let forces = inverse_dynamics(model, joints, &accelerations, method);
    Linearized { forces, by_u: Vec::new(), inverse: factor.inverse(), accelerations }
}

/// The equations of motion about the motion that the inputs give; their forces `tau` may depend on the state as well.
pub fn linearized<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    tau: &[Expr<'g>],
    method: Method,
) -> Linearized<'g> {
    let mut found = forward_dynamics(model, joints, mass, tau, method);
    let by_state = symbolic::derivatives(model, tau);
    subtract(&mut found.forces.by_q, &by_state.by_q);
    subtract(&mut found.forces.by_v, &by_state.by_v);
    found.by_u = symbolic::by_input(model, tau);
    found
}

/// `m − other`, entry by entry.
pub fn subtract<'g>(m: &mut Matrix<'g>, other: &Matrix<'g>) {
    for (entry, other) in m.iter_mut().flatten().zip(other.iter().flatten()) {
        *entry -= *other;
    }
}

/// True if every subspace is constant in link axes, so that the recursion applies.
pub fn is_analytic(model: &Model<'_>) -> bool {
    model.inertances.is_empty()
        && model.acceleration_forces.is_empty()
        && model.links.iter().all(|link| link.motion.has_constant_subspace())
}
