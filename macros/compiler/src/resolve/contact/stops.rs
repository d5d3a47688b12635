//! Stops: contacts of coordinates and expressions at the bounds of limits.

use super::coefficients::{ContactCoefficients, read_restitution};
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::kinematics::{time_derivative, velocity_gradient};
use crate::language::Key;
use crate::mechanism::Contact;
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::resolve::target::resolve_limited_coordinate;
use crate::syntax;

/// Returns the stops at the bounds of a limit.
pub fn resolve_stops<'g>(
    scope: &Scope<'_, 'g>,
    limit: &syntax::Limit,
    cx: &mut Diagnostics,
) -> Vec<Contact<'g>> {
    let (restitution, of_impulses) = read_restitution(scope, &limit.arguments, &limit.name.text, cx);
    let (Some(restitution), Some((limited, rate, turns))) =
        (restitution, limited_value_and_rate(scope, limit, cx))
    else {
        return Vec::new();
    };
    let g = scope.graph;
    let resolve_bound_value = |e: &syntax::Expr| match turns && e.place.file.is_none() {
        // Errors are reported by the pass that reads the limit.
        true => scope.resolve_angle_in_radians(e, &mut Diagnostics::silent_diagnostics()),
        false => scope.resolve_scalar(e, &mut Diagnostics::silent_diagnostics()),
    };
    let stop_at_bound = |(key, side): (Key, f64)| {
        let bound = resolve_bound_value(limit.arguments.expression_of_key(key)?)?;
        let gap = (limited - bound) * g.num(side);
        let name = format!("{}.{}", limit.name.text, key.name());
        let coefficients = ContactCoefficients {
            friction: g.zero(),
            stiction: g.zero(),
            torsional: g.zero(),
            rolling: g.zero(),
            restitution,
            of_impulses,
        };
        Some(coefficients.contact_with_coefficients(name, (gap, turns), None, vec![rate * g.num(side)]))
    };
    [(Key::From, 1.0), (Key::To, -1.0)].into_iter().filter_map(stop_at_bound).collect()
}

/// Returns the limited value, its rate, and whether it is an angle.
fn limited_value_and_rate<'g>(
    scope: &Scope<'_, 'g>,
    limit: &syntax::Limit,
    cx: &mut Diagnostics,
) -> Option<(Expr<'g>, Expr<'g>, bool)> {
    let g = scope.graph;
    if !scope.is_moving_expression(&limit.on) {
        let (c, angle) = resolve_limited_coordinate(scope, &limit.on, cx)?;
        let (q, v) = (c.q.expr(g), c.v.expr(g));
        let ratio = g.num(c.ratio);
        return Some((q * ratio + g.num(c.offset), v * ratio, angle == Some(true)));
    }
    let value = scope.call_in_context(Context::new(AllowedQuantities::Placement, None), |scope| {
        scope.resolve_scalar(&limit.on, cx)
    })?;
    let rate = time_derivative(scope.configuration_space(), value);
    if velocity_gradient(rate).is_empty() {
        cx.report_error(limit.on.place.clone(), "the limited quantity is constant").add_help(
            "a limit bounds an expression of coordinates, such as a distance `norm(r(ball / anchor))`",
        );
        return None;
    }
    Some((value, rate, false))
}
