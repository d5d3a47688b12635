//! First derivatives of the equations of motion on the tangent space of the configurations: column `i` of a
//! derivative with respect to `q` is the derivative along `q ⊕ ε eᵢ` (for ball and free joints: a motion in
//! body axes, as in Pinocchio). With `τ = ID(q, v, a)`, differentiating `ID(q, v, FD(q, v, τ)) = τ` gives
//! `∂v̇/∂x = −M⁻¹ ∂ID/∂x` at `a = v̇` (Carpentier and Mansard, *Analytical derivatives of rigid body dynamics
//! algorithms*, 2018, § IV).

use super::crba::Matrix;
use super::{acceleration_symbols, rnea, velocity_symbols};
use crate::expr::Expr;
use crate::expr::replace::substitute_symbols_in_all;
use crate::kinematics::Joint;
use crate::mechanism::{Model, Quantity};

/// Implements `PropagatedQuantity` for a struct whose listed fields are propagated.
macro_rules! impl_propagated {
    ($name:ident { $($field:ident),+ }) => {
        impl<'g> PropagatedQuantity<'g> for $name<'g> {
            fn zip_with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self {
                $name { $($field: self.$field.zip_with(&other.$field, f)),+ }
            }

            fn to_parent(&self, joint: &Joint<'g>) -> Self {
                $name { $($field: self.$field.to_parent(joint)),+ }
            }
        }
    };
}

pub mod analytic;
pub mod blocks;
mod columns;
mod factor;
pub mod invariance;
pub mod parameters;
pub mod second;
mod subtree;
pub mod symbolic;
mod trunk;

pub use factor::MatrixFactorisation;
pub use trunk::{BlockInverseMassMatrix, TrunkLimbPartition, inverse_terms_for_runtime_loops};

/// Derivatives of forces: a row for each entry of `τ`, a column for each velocity.
pub struct ForceDerivatives<'g> {
    /// Derivatives `∂τ/∂q` with respect to the configuration, along the tangent directions.
    pub by_q: Matrix<'g>,
    /// Derivatives `∂τ/∂v` of the generalized forces with respect to the velocities.
    pub by_v: Matrix<'g>,
}

/// The equations of motion linearised about a state: `M δv̇ + ∂q δq + ∂v δv = δτ`.
pub struct LinearizedEquations<'g> {
    /// Derivatives of inverse dynamics, minus the state derivatives of the input forces.
    pub forces: ForceDerivatives<'g>,
    /// Derivatives `∂τ/∂u` of the input forces; no columns if `τ` itself is the input.
    pub by_u: Matrix<'g>,
    /// Inverse `M⁻¹` of the effective mass matrix, symbolic.
    pub inverse: Matrix<'g>,
    /// Accelerations at which the derivatives are taken.
    pub accelerations: Vec<Expr<'g>>,
}

/// Method for the derivatives of inverse dynamics. The methods give equal results at different cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DerivationMethod {
    /// Recursion in up to this number of lanes if every motion subspace is constant in link axes, otherwise
    /// differentiation.
    Recursion(usize),
    /// Differentiation of the equations. For few degrees of freedom it costs less than the recursion if axes
    /// are parallel or intersect.
    Differentiation,
}

/// Returns the derivatives of inverse dynamics at the accelerations `a`.
pub fn inverse_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    a: &[Expr<'g>],
    method: DerivationMethod,
) -> ForceDerivatives<'g> {
    let v = velocity_symbols(model);
    if let DerivationMethod::Recursion(most) = method
        && supports_recursive_derivatives(model)
    {
        let mut found = analytic::inverse_dynamics(model, joints, &v, a, most);
        symbolic::add_passive_force_derivatives(model, &mut found);
        return found;
    }
    let symbols = acceleration_symbols(model);
    let found = symbolic::configuration_and_velocity_derivatives(
        model,
        &rnea::inverse_dynamics(model, joints, &v, Some(&symbols)),
    );
    if a == symbols {
        return found;
    }
    let acceleration_of_symbol = |s| match Quantity::from_symbol(s) {
        Quantity::Acceleration(k) => Some(a[k]),
        _ => None,
    };
    let substitute_accelerations =
        |m: Matrix<'g>| m.iter().map(|row| substitute_symbols_in_all(row, &acceleration_of_symbol)).collect();
    ForceDerivatives {
        by_q: substitute_accelerations(found.by_q),
        by_v: substitute_accelerations(found.by_v),
    }
}

/// Linearises the equations of motion about the motion under the forces `tau`.
pub fn linearize_forward_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    tau: &[Expr<'g>],
    method: DerivationMethod,
) -> LinearizedEquations<'g> {
    let factor = MatrixFactorisation::new(mass, joints);
    let bias = rnea::inverse_dynamics(model, joints, &velocity_symbols(model), None);
    let r = tau.iter().zip(&bias).map(|(t, h)| *t - *h).collect();
    let accelerations = factor.solve_factored(r);
    let forces = inverse_dynamics(model, joints, &accelerations, method);
    LinearizedEquations { forces, by_u: Vec::new(), inverse: factor.inverse(), accelerations }
}

/// Linearises the equations of motion about the motion under the inputs, whose forces `tau` may depend on the
/// state.
pub fn linearize_equations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    tau: &[Expr<'g>],
    method: DerivationMethod,
) -> LinearizedEquations<'g> {
    let mut found = linearize_forward_dynamics(model, joints, mass, tau, method);
    let by_state = symbolic::configuration_and_velocity_derivatives(model, tau);
    subtract_matrix(&mut found.forces.by_q, &by_state.by_q);
    subtract_matrix(&mut found.forces.by_v, &by_state.by_v);
    found.by_u = symbolic::input_derivatives_of_expressions(model, tau);
    found
}

/// Subtracts the matrix `other` from the matrix `m`, entry by entry.
pub fn subtract_matrix<'g>(m: &mut Matrix<'g>, other: &Matrix<'g>) {
    for (entry, other) in m.iter_mut().flatten().zip(other.iter().flatten()) {
        *entry -= *other;
    }
}

/// Returns true if every motion subspace is constant in link axes, so that the recursion applies.
pub fn supports_recursive_derivatives(model: &Model<'_>) -> bool {
    model.inertances.is_empty()
        && model.acceleration_forces.is_empty()
        && model.links.iter().all(|link| link.motion.has_constant_subspace())
}
