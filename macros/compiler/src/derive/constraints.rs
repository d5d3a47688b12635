//! What constraints say of a state, as outputs of programs.

use crate::expr::diff::gradient;
use crate::expr::{Expr, Symbol};
use crate::kinematics::motion_rates;
use crate::mechanics::constraints;
use crate::mechanics::derivatives::symbolic;
use crate::mechanism::{Model, Quantity};

pub(super) use crate::mechanics::constraints::{biases, rates, residuals};

/// The Jacobian column by column.
pub(super) fn jacobian<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    by_columns(model, &constraints::jacobian(model))
}

/// That of the contacts.
pub(super) fn contact_jacobian<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    by_columns(model, &contact_rows(model))
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
pub(super) fn contact_first_order<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let (g, rates) = (model.graph, model.contact_rates());
    // The power of the forces, differentiated backwards: each goes to the axes of what it moves once.
    let powers = rates.iter().enumerate().map(|(i, rate)| *rate * Quantity::ContactForce(i).expr(g));
    let power = powers.reduce(|sum, power| sum + power).unwrap_or(g.zero());
    let velocities: Vec<Symbol> = (0..model.nv()).map(|k| Quantity::Velocity(k).symbol()).collect();
    let forces = gradient(power, &velocities);
    let accelerations = motion_rates(model.space(), &rates, true);
    let accelerations = symbolic::derivatives(model, &accelerations);
    let parts = [
        symbolic::by_configuration(model, &forces),
        accelerations.by_q,
        accelerations.by_v,
        symbolic::by_configuration(model, &rates),
    ];
    parts.iter().flat_map(|rows| by_columns(model, rows)).collect()
}

fn by_columns<'g>(model: &Model<'g>, rows: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
    (0..model.nv()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
}
