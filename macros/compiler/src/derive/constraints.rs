//! Outputs of the functions of constraints and contacts.

use crate::expr::diff::gradient;
use crate::expr::{Expr, Symbol};
use crate::kinematics::time_derivatives_along_motion;
use crate::mechanics::constraints;
use crate::mechanics::crba::Matrix;
use crate::mechanics::derivatives::{parameters, symbolic};
use crate::mechanics::limb_contacts::LimbContacts;
use crate::mechanism::{Model, Quantity};

pub(super) use crate::mechanics::constraints::{constraint_biases, constraint_velocities, residuals};

/// Returns the constraint Jacobian column by column.
pub(super) fn constraint_jacobian<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    matrix_by_columns(model, &constraints::jacobian(model))
}

/// Returns the derivatives of the contact velocities with respect to the velocities: a row for each contact
/// velocity.
pub(super) fn contact_jacobian_rows<'g>(model: &Model<'g>) -> Vec<Vec<Expr<'g>>> {
    constraints::jacobian_of_rates(model, &model.contact_rates())
}

/// Returns the gap functions of the contacts.
pub(super) fn contact_gaps<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.contacts.iter().map(|contact| contact.gap).collect()
}

/// Returns the time derivatives of the contact velocities at zero accelerations.
pub(super) fn contact_biases<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    time_derivatives_along_motion(model.configuration_space(), &model.contact_rates(), false)
}

/// Returns the coefficients of friction, restitution and static friction of each contact.
pub(super) fn contact_coefficients<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.contacts.iter().flat_map(|c| [c.friction, c.restitution, c.stiction]).collect()
}

/// Returns the generalized forces `Gᵀ f` of the contact forces of some of the contact velocities `rates`.
fn contact_joint_forces<'g>(
    model: &Model<'g>,
    rates: &[Expr<'g>],
    numbers: impl Iterator<Item = usize>,
) -> Vec<Expr<'g>> {
    let g = model.graph;
    // Reverse differentiation of the power of the forces transforms each force only once to the axes of the
    // links that it acts on.
    let powers = numbers.map(|i| rates[i] * Quantity::ContactForce(i).expr(g));
    let power = powers.reduce(|sum, power| sum + power).unwrap_or(g.zero());
    let velocities: Vec<Symbol> = (0..model.nv()).map(|k| Quantity::Velocity(k).symbol()).collect();
    gradient(power, &velocities)
}

/// Returns the derivatives of contacts with respect to each parameter, one parameter after another: of the
/// generalized forces `Gᵀ f` at constant contact forces `f`, the contact velocities, the gaps, the
/// coefficients of friction, and those of restitution.
pub(super) fn contact_parameter_derivatives<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let rates = model.contact_rates();
    let mut values = contact_joint_forces(model, &rates, 0..rates.len());
    values.extend(rates);
    values.extend(contact_gaps(model));
    values.extend(model.contacts.iter().map(|contact| contact.friction));
    values.extend(model.contacts.iter().map(|contact| contact.restitution));
    parameters::parameter_derivatives(model, &values).concat()
}

/// First derivatives of the contributions of contacts to the equations of motion, at constant accelerations
/// `a` and contact forces `f`: of `Gᵀ f` with respect to `q`, of `G a + b` with respect to `q` and `v`, and
/// of the contact velocities with respect to `q`, each column by column.
pub(super) struct ContactDerivatives<'g> {
    rates: Vec<Expr<'g>>,
    /// Derivatives of `G a + b` with respect to `q` and `v`, and of the contact velocities with respect to
    /// `q`.
    by_motion: [Matrix<'g>; 3],
}

impl<'g> ContactDerivatives<'g> {
    pub(super) fn new(model: &Model<'g>) -> ContactDerivatives<'g> {
        let rates = model.contact_rates();
        let accelerations = time_derivatives_along_motion(model.configuration_space(), &rates, true);
        let accelerations = symbolic::configuration_and_velocity_derivatives(model, &accelerations);
        let of_rates = symbolic::configuration_derivatives(model, &rates);
        ContactDerivatives { by_motion: [accelerations.by_q, accelerations.by_v, of_rates], rates }
    }

    /// Returns the derivatives of `Gᵀ f` with respect to `q` for some of the contact velocities.
    fn contact_joint_force_derivatives(
        &self,
        model: &Model<'g>,
        numbers: impl Iterator<Item = usize>,
    ) -> Matrix<'g> {
        symbolic::configuration_derivatives(model, &contact_joint_forces(model, &self.rates, numbers))
    }

    pub(super) fn contact_derivative_outputs(&self, model: &Model<'g>) -> Vec<Expr<'g>> {
        let forces = self.contact_joint_force_derivatives(model, 0..self.rates.len());
        [&forces].into_iter().chain(&self.by_motion).flat_map(|rows| matrix_by_columns(model, rows)).collect()
    }

    /// Returns the derivatives of the contact forces with identical limbs in SIMD lanes; `None` if the
    /// expressions of the limbs differ in structure.
    pub(super) fn contact_derivatives_in_lanes(
        &self,
        model: &Model<'g>,
        contacts: &mut LimbContacts<'_, 'g>,
    ) -> Option<Vec<Expr<'g>>> {
        let forces_of_limb =
            |numbers: &Vec<usize>| self.contact_joint_force_derivatives(model, numbers.iter().copied());
        let of_limbs: Vec<Vec<Matrix<'g>>> = contacts
            .limb_contact_velocity_indices()
            .map(|limbs| limbs.iter().map(forces_of_limb).collect())
            .collect();
        let forces = contacts.sum_limb_matrices(&of_limbs)?;
        let mut outputs = matrix_by_columns(model, &forces);
        for rows in &self.by_motion {
            outputs.extend(matrix_by_columns(model, &contacts.merge_jacobian_rows_into_lanes(rows)?));
        }
        Some(outputs)
    }
}

/// Returns the entries of a matrix with a column for each velocity, column by column.
pub(super) fn matrix_by_columns<'g>(model: &Model<'g>, rows: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
    (0..model.nv()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
}
