//! What constraints say of a state, as outputs of programs.

use crate::expr::Expr;
use crate::mechanics::constraints;
use crate::mechanism::Model;

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

fn by_columns<'g>(model: &Model<'g>, rows: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
    (0..model.nv()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
}
