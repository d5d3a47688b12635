//! Functions of mechanisms with constraints.

use super::signatures::{self, Sizes};
use crate::emit::Function;
use crate::expr::Expr;
use crate::mechanics::{constraints, friction};
use crate::model::Model;

/// Takes away what a mechanism with constraints solves otherwise, and adds what it has besides.
pub(super) fn replace(functions: &mut Vec<Function>, model: &Model<'_>) {
    if !model.constraints.is_empty() {
        functions.retain(|f| f.name != "forward_dynamics");
        let (nh, nc) = (model.holonomic(), model.constraints.len());
        let slipping = friction::slipping(model).len();
        let spread = model.is_overdetermined();
        functions.extend(signatures::constrained(&Sizes::of(model), nh, nc, slipping, spread));
    }
}

/// The outputs of one of the functions that need no algorithm.
pub(super) fn outputs<'g>(name: &str, model: &Model<'g>) -> Option<Vec<Expr<'g>>> {
    Some(match name {
        "constraint_residuals" => constraints::residuals(model),
        "constraint_rates" => constraints::rates(model),
        "constraint_bias" => constraints::biases(model),
        "constraint_jacobian" => {
            let rows = constraints::jacobian(model);
            (0..model.nv()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
        }
        _ => return None,
    })
}
