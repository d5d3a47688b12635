//! Outputs: expressions that become functions, resolved in their declared axes.

use super::contact;
use super::scope::{AllowedQuantities, Context, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::mechanism::{LinkId, OutputExpression, Pose};
use crate::syntax::{Definition, ExprKind, Rank};

/// Resolves an output that is an expression; `None` after an error.
pub fn resolve_output<'g>(
    scope: &Scope<'_, 'g>,
    output: &Definition,
    cx: &mut Diagnostics,
) -> Option<OutputExpression<'g>> {
    let values = resolve_output_expressions(scope, output, cx)?;
    if !contact::uses_contact_forces_consistently(&values) {
        cx.report_error(
            output.value.place.clone(),
            "a contact force together with a reaction or an acceleration",
        )
        .add_help("reactions and accelerations are computed without contacts: declare a separate output");
        return None;
    }
    Some(OutputExpression { name: output.name.text.clone(), values, diagram: None })
}

fn resolve_output_expressions<'g>(
    scope: &Scope<'_, 'g>,
    output: &Definition,
    cx: &mut Diagnostics,
) -> Option<Vec<Expr<'g>>> {
    let frame = Some((None, Pose::identity(scope.graph)));
    let allowed = if output.rank == Rank::Matrix {
        AllowedQuantities::Acceleration
    } else {
        AllowedQuantities::Reaction
    };
    let context = Context::new(allowed, frame);
    if output.rank == Rank::Scalar {
        return match scope.call_in_context(context, |scope| scope.resolve_value(&output.value, cx))? {
            Value::Scalar(s) => Some(vec![s]),
            other => {
                let what = other.kind_with_article();
                cx.report_error(output.value.place.clone(), format!("expected a scalar, found {what}"))
                    .add_help(match other {
                        Value::Matrix(_) => "declare it as a `Matrix`, or take an entry, `dot(x, M * y)`",
                        _ => "declare it as a `Vector`, or take a component, `dot(v, x)`",
                    });
                None
            }
        };
    }
    if output.rank == Rank::Matrix {
        let found =
            scope.call_in_context(context, |scope| scope.resolve_matrix_expression(&output.value, cx));
        let (link, pose) = output_axes(scope, output, cx)?;
        return Some(scope.kinematics.matrix_entries(found?, link, &pose.rotation));
    }
    let terms = scope.call_in_context(context, |scope| scope.resolve_vector_terms(&output.value, cx));
    let (link, pose) = output_axes(scope, output, cx)?;
    let v = scope.kinematics.components_in_link_axes(&terms?, link, Vec3::zero(scope.graph));
    Some(pose.rotation.vector_in_child_axes(v).0.to_vec())
}

/// Returns the link and the pose of the axes in which the components of an output are resolved.
pub fn output_axes<'g>(
    scope: &Scope<'_, 'g>,
    output: &Definition,
    cx: &mut Diagnostics,
) -> Option<(Option<LinkId>, Pose<'g>)> {
    let ground = Some((None, Pose::identity(scope.graph)));
    let Some(e) = &output.resolved_in else { return ground };
    match &e.kind {
        ExprKind::Name(name) if name == super::tree::GROUND => ground,
        ExprKind::Name(name) => {
            let kinematics = &scope.kinematics;
            let found = kinematics.places.get(name).map(|p| (p.link, p.pose.clone()));
            if found.is_none() {
                let known: Vec<&str> = kinematics.places.keys().map(String::as_str).collect();
                cx.report_error(e.place.clone(), format!("unknown frame `{name}`")).suggest_name(name, known);
            }
            found
        }
        _ => {
            cx.report_error(e.place.clone(), "expected a body or a frame");
            None
        }
    }
}
