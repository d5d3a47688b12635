//! Dynamics of a mechanism with its identical limbs in SIMD lanes: the unmodified algorithms run between
//! gathering the state and scattering the results.

use crate::expr::Expr;
use crate::mechanics::derivatives::{BlockInverseMassMatrix, ForceDerivatives, analytic, symbolic};
use crate::mechanics::{aba, crba, rnea};
use crate::mechanism::{Model, Quantity};
use crate::vectorise::VectorisedMechanism;

/// Returns the mass matrix of the vectorised mechanism by rows, in up to `most` SIMD lanes.
pub fn mass_matrix<'g>(limbs: &VectorisedMechanism<'g>, most: usize) -> Vec<Expr<'g>> {
    limbs.whole_mechanism_matrix(&crba::mass_matrix_in_lanes(&limbs.model, &limbs.joints, most))
}

/// Returns inverse dynamics, or the bias if `accelerations` is false.
pub fn inverse_dynamics<'g>(limbs: &VectorisedMechanism<'g>, accelerations: bool) -> Vec<Expr<'g>> {
    let v = limbs.lane_symbols_per_velocity(Quantity::Velocity);
    let a = accelerations.then(|| limbs.lane_symbols_per_velocity(Quantity::Acceleration));
    let tau = rnea::inverse_dynamics(&limbs.model, &limbs.joints, &v, a.as_deref());
    let whole: Vec<Expr<'g>> = tau.iter().zip(limbs.passive_forces()).map(|(t, h)| *t + *h).collect();
    limbs.scatter_to_velocities(&whole)
}

/// Returns forward dynamics by articulated bodies, with the bias wrenches of another variant; `None` for a
/// mechanism with coupled coordinates.
pub fn forward_dynamics<'g>(
    limbs: &VectorisedMechanism<'g>,
    bias: &VectorisedMechanism<'g>,
) -> Option<Vec<Expr<'g>>> {
    let v = limbs.lane_symbols_per_velocity(Quantity::Velocity);
    let wrenches = rnea::link_wrenches(&bias.model, &bias.joints, &v, None);
    let tau = limbs.lane_symbols_per_velocity(Quantity::Force);
    let r: Vec<Expr<'g>> = tau.iter().zip(limbs.passive_forces()).map(|(t, h)| *t - *h).collect();
    let a = aba::forward_dynamics(&limbs.model, &limbs.joints, wrenches, &r)?;
    Some(limbs.scatter_to_velocities(&a))
}

/// Returns the derivatives of inverse dynamics at the accelerations `a` of the mechanism in lanes, by
/// recursion in up to `most` lanes. The derivatives of passive forces come from the whole mechanism.
pub fn inverse_dynamics_derivatives<'g>(
    limbs: &VectorisedMechanism<'g>,
    whole: &Model<'g>,
    a: &[Expr<'g>],
    most: usize,
) -> ForceDerivatives<'g> {
    let v = limbs.lane_symbols_per_velocity(Quantity::Velocity);
    let found = analytic::inverse_dynamics(&limbs.model, &limbs.joints, &v, a, most);
    let [by_q, by_v] = [found.by_q, found.by_v].map(|m| matrix_rows_of_whole_mechanism(limbs, &m));
    let mut scattered = ForceDerivatives { by_q, by_v };
    symbolic::add_passive_force_derivatives(whole, &mut scattered);
    scattered
}

/// Returns a Coriolis matrix of the vectorised mechanism by rows, in up to `most` SIMD lanes.
pub fn coriolis_matrix<'g>(limbs: &VectorisedMechanism<'g>, most: usize) -> crba::Matrix<'g> {
    let v = limbs.lane_symbols_per_velocity(Quantity::Velocity);
    matrix_rows_of_whole_mechanism(limbs, &analytic::coriolis_matrix(&limbs.model, &limbs.joints, &v, most))
}

/// Returns the accelerations of the vectorised mechanism under forces, given the blocks of its inverse mass
/// matrix.
pub fn accelerations_in_lanes<'g>(
    limbs: &VectorisedMechanism<'g>,
    inverse: &BlockInverseMassMatrix<'_, 'g>,
) -> Vec<Expr<'g>> {
    inverse.solve_by_trunk_and_limbs(&unbalanced_forces(limbs))
}

/// Returns `τ − h` of the vectorised mechanism, whose identical limbs are SIMD lanes.
pub fn unbalanced_forces<'g>(limbs: &VectorisedMechanism<'g>) -> Vec<Expr<'g>> {
    let v = limbs.lane_symbols_per_velocity(Quantity::Velocity);
    let tau = limbs.lane_symbols_per_velocity(Quantity::Force);
    let bias = rnea::inverse_dynamics(&limbs.model, &limbs.joints, &v, None);
    let resisted = tau.iter().zip(limbs.passive_forces()).map(|(t, h)| *t - *h);
    resisted.zip(bias).map(|(r, h)| r - h).collect()
}

/// Scatters the inverse mass matrix of the mechanism in lanes to that of the whole mechanism: a matrix, and
/// the columns of the low-rank term.
pub fn scatter_inverse_to_whole_mechanism<'g>(
    limbs: &VectorisedMechanism<'g>,
    [matrix, trunk_factors]: &[crba::Matrix<'g>; 2],
) -> [crba::Matrix<'g>; 2] {
    let width = trunk_factors.iter().map(Vec::len).max().unwrap_or_default();
    let column =
        |k: usize| limbs.scatter_to_velocities(&trunk_factors.iter().map(|row| row[k]).collect::<Vec<_>>());
    let columns: Vec<Vec<Expr<'g>>> = (0..width).map(column).collect();
    let rows = matrix_rows_of_whole_mechanism(limbs, matrix);
    let trunk_factors = (0..rows.len()).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
    [rows, trunk_factors]
}

fn matrix_rows_of_whole_mechanism<'g>(
    limbs: &VectorisedMechanism<'g>,
    matrix: &crba::Matrix<'g>,
) -> crba::Matrix<'g> {
    let whole = limbs.whole_mechanism_matrix(matrix);
    let n = whole.len().isqrt();
    whole.chunks(n.max(1)).map(<[Expr<'g>]>::to_vec).collect()
}
