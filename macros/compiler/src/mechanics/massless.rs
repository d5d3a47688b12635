//! Coordinates without inertia that constraints determine, such as the parameters of surfaces. The mass
//! matrix `M` is singular, but the system of accelerations and multipliers is not. The rows `J` that
//! determine these coordinates are added to `M` with a weight `w`,
//!
//! ```text
//! (M + w Jᵀ J) v̇ + h = τ − w Jᵀ b + Jᵀ λ,   J v̇ = −b,
//! ```
//!
//! which has the same solution for any `w`, since `J v̇` is known (an augmented Lagrangian: Nocedal and
//! Wright, *Numerical Optimization*, 2006, § 17.3).

use super::crba::Matrix;
use super::{constraints, energy};
use crate::expr::Expr;
use crate::kinematics::Joint;
use crate::mechanism::Model;

/// Returns the indices of the constraints that determine coordinates without inertia.
pub fn constraints_of_massless_coordinates(model: &Model<'_>) -> Vec<usize> {
    (0..model.constraints.len()).filter(|row| model.constraints[*row].determines).collect()
}

/// Returns `w Jᵀ` for these rows, where `w` is the mass of all moving bodies, so that the added terms have
/// the magnitude of the mass matrix.
fn mass_weighted_jacobian_rows<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    jacobian: &Matrix<'g>,
) -> Vec<(usize, Vec<Expr<'g>>)> {
    let (mass, _) = energy::mass_and_moment(model, joints);
    let w = if mass.is_zero() { model.graph.one() } else { mass };
    constraints_of_massless_coordinates(model)
        .into_iter()
        .map(|row| (row, jacobian[row].iter().map(|e| *e * w).collect()))
        .collect()
}

/// Returns the mass matrix with weighted constraints, `M + w Jᵀ J`.
pub fn mass_with_weighted_constraints<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mut mass: Matrix<'g>,
) -> Matrix<'g> {
    if constraints_of_massless_coordinates(model).is_empty() {
        return mass;
    }
    let jacobian = constraints::jacobian(model);
    for (row, heavy) in mass_weighted_jacobian_rows(model, joints, &jacobian) {
        for (entries, heavy) in mass.iter_mut().zip(heavy).filter(|(_, heavy)| !heavy.is_zero()) {
            entries.iter_mut().zip(&jacobian[row]).for_each(|(entry, e)| *entry += heavy * *e);
        }
    }
    mass
}

/// Returns the force with weighted constraints, `f − w Jᵀ b`.
pub fn force_with_weighted_constraints<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    force: &[Expr<'g>],
    bias: &[Expr<'g>],
) -> Vec<Expr<'g>> {
    let mut force = force.to_vec();
    if constraints_of_massless_coordinates(model).is_empty() {
        return force;
    }
    for (row, heavy) in mass_weighted_jacobian_rows(model, joints, &constraints::jacobian(model)) {
        force.iter_mut().zip(heavy).for_each(|(f, heavy)| *f -= heavy * bias[row]);
    }
    force
}
