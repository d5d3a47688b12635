//! What constraints say of a state, as outputs of programs.

use crate::expr::Expr;
use crate::mechanics::derivatives::symbolic;
use crate::mechanics::{self, constraints};
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
    model.contacts.iter().flat_map(|contact| contact.biases.clone()).collect()
}

/// Friction and restitution of each contact.
pub(super) fn contact_laws<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.contacts.iter().flat_map(|contact| [contact.friction, contact.restitution]).collect()
}

/// What contacts add to the motion to first order, at given accelerations `a` and forces `f`: derivatives of `Gᵀ f` by `q`, of
/// `G a + b` by `q` and by `v`, and of the rates by `q`, each column by column.
pub(super) fn contact_first_order<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let (rows, a) = (contact_rows(model), mechanics::accelerations(model));
    let zero = model.graph.zero();
    let force = |k: usize| {
        let terms = rows.iter().enumerate();
        terms.fold(zero, |sum, (i, row)| sum + row[k] * Quantity::ContactForce(i).expr(model.graph))
    };
    let forces: Vec<Expr<'g>> = (0..model.nv()).map(force).collect();
    let along = |row: &Vec<Expr<'g>>| row.iter().zip(&a).fold(zero, |sum, (g, a)| sum + *g * *a);
    let biases = model.contacts.iter().flat_map(|contact| &contact.biases);
    let accelerations: Vec<Expr<'g>> =
        rows.iter().zip(biases).map(|(row, bias)| along(row) + *bias).collect();
    let accelerations = symbolic::derivatives(model, &accelerations);
    let parts = [
        symbolic::by_configuration(model, &forces),
        accelerations.by_q,
        accelerations.by_v,
        symbolic::by_configuration(model, &model.contact_rates()),
    ];
    parts.iter().flat_map(|rows| by_columns(model, rows)).collect()
}

fn by_columns<'g>(model: &Model<'g>, rows: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
    (0..model.nv()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
}
