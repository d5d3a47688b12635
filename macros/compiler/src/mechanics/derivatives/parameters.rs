//! Derivatives of the equations of motion with respect to the parameters of the mechanism, by
//! differentiation.

use super::super::crba::Matrix;
use super::super::{acceleration_symbols, added_mass, crba, forces, rnea, velocity_symbols};
use super::MatrixFactorisation;
use crate::expr::Expr;
use crate::expr::diff::DirectionalDerivative;
use crate::expr::replace::substitute_symbols_in_all;
use crate::kinematics::Joint;
use crate::mechanism::{Model, Quantity};

/// Returns the columns of `∂τ/∂p` of inverse dynamics, one for each parameter `p`.
pub fn inverse_dynamics<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Matrix<'g> {
    let a = acceleration_symbols(model);
    parameter_derivatives(model, &rnea::inverse_dynamics(model, joints, &velocity_symbols(model), Some(&a)))
}

/// Returns the columns of `∂τ/∂p` of the input forces, one for each parameter `p`.
pub fn generalized_forces_of_inputs<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Matrix<'g> {
    parameter_derivatives(model, &forces::generalized_forces_of_inputs(model, joints))
}

/// Returns the columns of the derivatives of values, one for each parameter.
pub fn parameter_derivatives<'g>(model: &Model<'g>, values: &[Expr<'g>]) -> Matrix<'g> {
    let parameter_derivative =
        |k| DirectionalDerivative::with_respect_to(Quantity::Parameter(k).symbol(), model.graph);
    let derivative_column =
        |mut d: DirectionalDerivative<'g>| values.iter().map(|e| d.differentiate(*e)).collect();
    (0..model.parameters.len()).map(|k| derivative_column(parameter_derivative(k))).collect()
}

/// Returns the columns of `∂v̇/∂p = −M⁻¹ ∂τ/∂p` of forward dynamics under the forces `tau`, at `a = v̇`.
pub fn forward_dynamics<'g>(model: &Model<'g>, joints: &[Joint<'g>], tau: &[Expr<'g>]) -> Matrix<'g> {
    let factor = MatrixFactorisation::new(
        &added_mass::effective_mass_matrix(model, &crba::mass_matrix(model, joints)),
        joints,
    );
    let bias = rnea::inverse_dynamics(model, joints, &velocity_symbols(model), None);
    let a = factor.solve_factored(tau.iter().zip(&bias).map(|(t, h)| *t - *h).collect());
    let acceleration_of_symbol = |s| match Quantity::from_symbol(s) {
        Quantity::Acceleration(k) => Some(a[k]),
        _ => None,
    };
    let columns = inverse_dynamics(model, joints);
    let solve_for_acceleration_derivatives = |column: &Vec<Expr<'g>>| {
        factor.solve_factored(
            substitute_symbols_in_all(column, &acceleration_of_symbol).iter().map(|e| -*e).collect(),
        )
    };
    columns.iter().map(solve_for_acceleration_derivatives).collect()
}
