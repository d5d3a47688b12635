//! What constraints say of a state, as outputs of programs.

use crate::expr::Expr;
use crate::mechanics::constraints;
use crate::mechanism::Model;

pub(super) use crate::mechanics::constraints::{biases, rates, residuals};

/// The Jacobian column by column.
pub(super) fn jacobian<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let rows = constraints::jacobian(model);
    (0..model.nv()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
}
