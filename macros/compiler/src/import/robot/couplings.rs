//! Substitutes the coordinates of locked joints into constraints.

use super::joint::FileJoint;
use super::motion::{JointMotion, locked_coordinates};
use crate::import::context::{Cx, quote_word};
use crate::syntax::{BinaryOp, Constraint, Expr, ExprKind};
use std::collections::BTreeMap;

/// Tolerance of the residual of a constraint without moving joints, relative to the sum of the magnitudes of
/// its terms.
const ROUNDING: f64 = 1e-9;

/// Returns the constraints on moving joints. A constraint on locked joints alone is dropped if it is
/// satisfied and reported otherwise.
pub(in crate::import) fn constraints_on_moving_joints(
    constraints: Vec<Constraint>,
    joints: &[Option<(FileJoint, JointMotion)>],
    cx: &mut Cx<'_>,
) -> Vec<Constraint> {
    let frozen = locked_coordinates(joints);
    constraints
        .into_iter()
        .filter_map(|constraint| constraint_without_locked_joints(constraint, &frozen, cx))
        .collect()
}

fn constraint_without_locked_joints(
    mut constraint: Constraint,
    frozen: &BTreeMap<&str, f64>,
    cx: &mut Cx<'_>,
) -> Option<Constraint> {
    let sides = std::iter::once(&mut constraint.value).chain(&mut constraint.other);
    sides.for_each(|side| *side = replace_locked_coordinates(side, frozen));
    let other = constraint.other.as_ref().map_or(Some(0.0), evaluate_constant);
    let (Some(value), Some(other)) = (evaluate_constant(&constraint.value), other) else {
        return Some(constraint);
    };
    if (value - other).abs() > ROUNDING * (1.0 + value.abs() + other.abs()) {
        let message = format!(
            "the coupling {} contradicts others: the joints that it couples cannot move, and it is violated \
             by {}",
            quote_word(&constraint.name.text),
            value - other
        );
        cx.report_error(&constraint.name.place, message, |d| {
            d.add_help("remove it, or the constraints that fix these joints")
        });
    }
    None
}

/// Replaces the coordinates of locked joints by numbers.
fn replace_locked_coordinates(e: &Expr, frozen: &BTreeMap<&str, f64>) -> Expr {
    match &e.kind {
        ExprKind::Name(name) => {
            frozen.get(name.as_str()).map_or_else(|| e.clone(), |at| Expr::number_at(*at, &e.place))
        }
        ExprKind::Binary(op, a, b, _) => Expr::binary_operation(
            *op,
            replace_locked_coordinates(a, frozen),
            replace_locked_coordinates(b, frozen),
        ),
        _ => e.clone(),
    }
}

/// Evaluates sums and products of numbers. Returns `None` for other expressions.
fn evaluate_constant(e: &Expr) -> Option<f64> {
    match &e.kind {
        ExprKind::Binary(BinaryOp::Add, a, b, _) => Some(evaluate_constant(a)? + evaluate_constant(b)?),
        ExprKind::Binary(BinaryOp::Mul, a, b, _) => Some(evaluate_constant(a)? * evaluate_constant(b)?),
        _ => e.literal_number(),
    }
}
