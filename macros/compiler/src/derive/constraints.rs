//! What constraints say of a state, as outputs of programs.

use crate::expr::diff::gradient;
use crate::expr::{Expr, Symbol};
use crate::kinematics::motion_rates;
use crate::mechanics::constraints;
use crate::mechanics::crba::Matrix;
use crate::mechanics::derivatives::symbolic;
use crate::mechanics::limb_contacts::LimbContacts;
use crate::mechanism::{Model, Quantity};

pub(super) use crate::mechanics::constraints::{biases, rates, residuals};

/// The Jacobian column by column.
pub(super) fn jacobian<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    by_columns(model, &constraints::jacobian(model))
}

/// How the rates of contacts change with the velocities: a row for each.
pub(super) fn contact_rows<'g>(model: &Model<'g>) -> Vec<Vec<Expr<'g>>> {
    constraints::jacobian_of(model, &model.contact_rates())
}

/// The gaps of the contacts.
pub(super) fn contact_gaps<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.contacts.iter().map(|contact| contact.gap).collect()
}

/// What the rates of contacts gain beside what accelerations add to them.
pub(super) fn contact_biases<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    motion_rates(model.space(), &model.contact_rates(), false)
}

/// Friction and restitution of each contact.
pub(super) fn contact_laws<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.contacts.iter().flat_map(|contact| [contact.friction, contact.restitution]).collect()
}

/// What contacts add to the motion to first order, at given accelerations `a` and forces `f`: derivatives of `Gᵀ f` by `q`, of
/// `G a + b` by `q` and by `v`, and of the rates by `q`, each column by column.
pub(super) struct ContactDerivatives<'g> {
    rates: Vec<Expr<'g>>,
    /// Of `G a + b` by `q` and by `v`, and of the rates by `q`.
    by_motion: [Matrix<'g>; 3],
}

impl<'g> ContactDerivatives<'g> {
    pub(super) fn new(model: &Model<'g>) -> ContactDerivatives<'g> {
        let rates = model.contact_rates();
        let accelerations = motion_rates(model.space(), &rates, true);
        let accelerations = symbolic::derivatives(model, &accelerations);
        let of_rates = symbolic::by_configuration(model, &rates);
        ContactDerivatives { by_motion: [accelerations.by_q, accelerations.by_v, of_rates], rates }
    }

    /// The derivatives of `Gᵀ f` by `q` for some of the rates.
    fn forces(&self, model: &Model<'g>, numbers: impl Iterator<Item = usize>) -> Matrix<'g> {
        let g = model.graph;
        // The power of the forces, differentiated backwards: each goes to the axes of what it moves once.
        let powers = numbers.map(|i| self.rates[i] * Quantity::ContactForce(i).expr(g));
        let power = powers.reduce(|sum, power| sum + power).unwrap_or(g.zero());
        let velocities: Vec<Symbol> = (0..model.nv()).map(|k| Quantity::Velocity(k).symbol()).collect();
        symbolic::by_configuration(model, &gradient(power, &velocities))
    }

    pub(super) fn outputs(&self, model: &Model<'g>) -> Vec<Expr<'g>> {
        let forces = self.forces(model, 0..self.rates.len());
        [&forces].into_iter().chain(&self.by_motion).flat_map(|rows| by_columns(model, rows)).collect()
    }

    /// The derivatives of the contacts' forces with alike limbs as lanes; `None` if limbs are built differently.
    pub(super) fn outputs_in_lanes(
        &self,
        model: &Model<'g>,
        contacts: &mut LimbContacts<'_, 'g>,
    ) -> Option<Vec<Expr<'g>>> {
        let of_limb = |numbers: &Vec<usize>| self.forces(model, numbers.iter().copied());
        let of_limbs: Vec<Vec<Matrix<'g>>> =
            contacts.of_limbs().map(|limbs| limbs.iter().map(of_limb).collect()).collect();
        let forces = contacts.sum(&of_limbs)?;
        let mut outputs = by_columns(model, &forces);
        for rows in &self.by_motion {
            outputs.extend(by_columns(model, &contacts.rows(rows)?));
        }
        Some(outputs)
    }
}

/// A matrix with as many columns as there are velocities, column by column.
pub(super) fn by_columns<'g>(model: &Model<'g>, rows: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
    (0..model.nv()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
}
