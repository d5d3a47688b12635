//! Surfaces that touch and slip, with Coulomb friction: `slips(surface, surface), friction = μ, speed = v₀`.
//! The normal force `λ` keeps the surfaces in contact. The force in the tangent plane is
//! `−μ |λ| s / √(|s|² + v₀²)` for the slip velocity `s`: Coulomb's law, regularised around zero slip.

use super::{contact_rows, read_surface_pair};
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::language::Key;
use crate::mechanism::{Constraint, FrictionTerm, Model, Pose, Rule};
use crate::resolve::rows::ConstraintRows;
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::syntax;

/// Returns the row of a slipping pair; `None` after an error.
pub fn slipping_rows<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    constraint: &syntax::Constraint,
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    let found = (
        read_surface_pair(scope, model, constraint, cx),
        friction_and_regularisation_speed(scope, model, constraint, cx),
    );
    let (Some(pair), Some((coefficient, speed))) = found else { return None };
    let Some(contact) = pair.contact_of_pair() else {
        cx.report_error(constraint.value.place.clone(), "these surfaces touch along a line").add_help(
            "the point on it where friction acts is not determined: use a surface that touches at a \
             point",
        );
        return None;
    };
    let slip = pair.slip(contact.point);
    let [_, tangents @ ..] = contact.axes;
    let rates: Vec<Expr<'g>> = tangents.iter().map(|(_, e)| e.dot(slip)).collect();
    let size = rates.iter().fold(speed.square(), |sum, rate| sum + rate.square()).sqrt();
    let moving = rates.iter().filter(|rate| !rate.is_zero() && !coefficient.is_zero());
    let friction =
        moving.map(|rate| FrictionTerm { rate: *rate, share: -(coefficient * *rate / size) }).collect();
    let rows = contact_rows(scope, constraint, &contact, slip, friction);
    let contact_point = Some(pair.contact_position(contact.point));
    let surfaces = pair.written_surfaces();
    Some(ConstraintRows { rows, contact_point, surfaces, redundant: Vec::new() })
}

/// Returns the coefficient of friction and the speed of the regularisation.
fn friction_and_regularisation_speed<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    constraint: &syntax::Constraint,
    cx: &mut Diagnostics,
) -> Option<(Expr<'g>, Expr<'g>)> {
    let written = constraint.arguments.expression_of_key(Key::Friction)?;
    let ground = Some((None, Pose::identity(scope.graph)));
    let coefficient = scope.call_in_context(Context::new(AllowedQuantities::Placement, ground), |s| {
        s.resolve_scalar(written, cx)
    })?;
    if let Some(n) = coefficient.constant_value().filter(|n| *n < 0.0) {
        cx.report_error(
            written.place.clone(),
            format!("a coefficient of friction cannot be negative, but it is {n}"),
        )
        .add_help("friction opposes the motion by definition: give its magnitude");
    }
    let name = &constraint.name.text;
    scope.record_parameter_condition(
        Rule::NotNegative,
        || format!("the friction of `{name}`"),
        &[coefficient],
    );
    let Some(written) = constraint.arguments.expression_of_key(Key::Speed) else {
        return Some((coefficient, model.friction_speed));
    };
    let speed = scope.call_in_context(Context::new(AllowedQuantities::Constant, None), |s| {
        s.resolve_scalar(written, cx)
    })?;
    if let Some(n) = speed.constant_value().filter(|n| *n <= 0.0) {
        let message = format!("this speed must be positive, but it is {n}");
        cx.report_error(written.place.clone(), message).add_help(
            "Coulomb's law is smoothed below this speed; a smaller value makes the equations stiffer at \
             rest",
        );
    }
    scope.record_parameter_condition(Rule::Positive, || format!("the speed of `{name}`"), &[speed]);
    Some((coefficient, speed))
}

/// Reports slipping contacts whose row is redundant: the normal force, and therefore the friction, is
/// undetermined.
pub fn report_undetermined_normal_forces(
    rows: &[Constraint<'_>],
    redundant: &[String],
    cx: &mut Diagnostics,
) {
    for row in rows.iter().filter(|c| !c.friction.is_empty() && redundant.contains(&c.name)) {
        cx.report_error(
            row.place.clone(),
            "the normal force of this contact is not determined by the motion",
        )
        .add_help(
            "other constraints already determine the distance of these bodies; friction needs the normal \
             force",
        );
    }
}
