//! Targets of force elements and limits: coordinates, points, and lengths given by expressions.

use super::scope::{PlacedElement, Scope};
use super::terms::{StretchWithRate, stretch_from_expression};
use crate::diag::{Diagnostics, Place, join_with_or};
use crate::language::BodyOrInertiaMethod;
use crate::mechanism::Coordinate;
use crate::syntax::{Expr, ExprKind, GROUND, Name};

/// Target on which a force element acts.
pub enum ResolvedTarget<'g> {
    /// Coordinate. The flag is true for an angle, `None` if it may be an angle or a length.
    Coordinate(Coordinate, Option<bool>),
    /// Point of a body, a particle, or a named point.
    Point(PlacedElement<'g>),
    /// Target that is a length or angle given by an expression.
    Expression(StretchWithRate<'g>),
}

/// Returns the coordinate of a limit, and whether it is an angle, if that is known.
pub fn resolve_limited_coordinate<'g>(
    scope: &Scope<'_, 'g>,
    on: &Expr,
    cx: &mut Diagnostics,
) -> Option<(Coordinate, Option<bool>)> {
    let joint = on.as_name().and_then(|name| scope.joint_coordinates(name));
    if joint.is_some_and(|coordinates| coordinates.is_empty()) {
        cx.report_error(
            on.place.clone(),
            format!("`{}` has no coordinate to be limited", on.short_source_text()),
        )
        .add_help(
            "limits apply to joints with plain coordinates: not to a Ball, Free or Weld, and not to a \
             joint that closes a loop",
        );
        return None;
    }
    match resolve_target(scope, on, cx)? {
        ResolvedTarget::Coordinate(coordinate, angle) => Some((coordinate, angle)),
        ResolvedTarget::Point(_) | ResolvedTarget::Expression(_) => {
            cx.report_error(
                on.place.clone(),
                "a Limit applies to the coordinate of a joint, but this is a point",
            )
            .add_help("name a joint, as in `on = hinge`");
            None
        }
    }
}

/// Resolves a target written as `joint`, `joint.coordinate`, `body` or `body.at(vector)`.
pub fn resolve_target<'g>(
    scope: &Scope<'_, 'g>,
    on: &Expr,
    cx: &mut Diagnostics,
) -> Option<ResolvedTarget<'g>> {
    match &on.kind {
        ExprKind::Name(name) => resolve_named_target(scope, on, name, cx),
        ExprKind::Field(joint, coordinate) => resolve_joint_coordinate(scope, on, joint, coordinate, cx),
        ExprKind::Method(inner, method, arguments)
            if method.id == Some(BodyOrInertiaMethod::At) && arguments.len() == 1 =>
        {
            let ExprKind::Name(name) = &inner.kind else {
                cx.report_error(on.place.clone(), "expected a body");
                return None;
            };
            if !scope.is_placeable(name) {
                report_invalid_target(scope, name, &inner.place, cx);
                return None;
            }
            scope.placement_of_moving_point(on, cx).map(ResolvedTarget::Point)
        }
        ExprKind::Call(..) | ExprKind::Binary(..) | ExprKind::Neg(..) => {
            stretch_from_expression(scope, on, cx).map(ResolvedTarget::Expression)
        }
        _ => {
            cx.report_error(on.place.clone(), "expected a joint, a coordinate of a joint, or a body")
                .add_help("write `on = hinge`, `on = slot.slide`, `on = arm` or `on = arm.at(length * x)`");
            None
        }
    }
}

/// Resolves a declared coordinate, a joint with one coordinate, a definition, or a placed element.
fn resolve_named_target<'g>(
    scope: &Scope<'_, 'g>,
    on: &Expr,
    name: &str,
    cx: &mut Diagnostics,
) -> Option<ResolvedTarget<'g>> {
    if scope.description.coordinates.iter().any(|c| c.name.text == name) {
        let kinematics = &scope.kinematics;
        let found = kinematics.coordinates.iter().find(|(known, ..)| known == name);
        return found.map(|(_, c, _)| ResolvedTarget::Coordinate(*c, None));
    }
    if let Some(joint) = scope.joint_coordinates(name) {
        if let [(_, c, angle)] = joint {
            return Some(ResolvedTarget::Coordinate(*c, Some(*angle)));
        }
        let list: Vec<String> = joint.iter().map(|(n, ..)| format!("`on = {n}`")).collect();
        if list.is_empty() {
            cx.report_error(on.place.clone(), format!("`{name}` has no coordinate to act on"))
                .add_help("a force or a torque can act on one of its bodies, with a direction");
        } else {
            cx.report_error(on.place.clone(), format!("`{name}` has {} coordinates", list.len()))
                .add_help(format!("write {}", join_with_or(&list)));
        }
        return None;
    }
    if let Some(c) = find_declared_coordinate(scope, name) {
        return Some(ResolvedTarget::Coordinate(c, None));
    }
    if scope.description.definitions.iter().any(|definition| definition.name.text == name) {
        return stretch_from_expression(scope, on, cx).map(ResolvedTarget::Expression);
    }
    if !scope.is_placeable(name) {
        report_invalid_target(scope, name, &on.place, cx);
        return None;
    }
    scope.resolve_placement(on, cx).map(ResolvedTarget::Point)
}

/// Resolves a target written as `joint.coordinate`.
fn resolve_joint_coordinate<'g>(
    scope: &Scope<'_, 'g>,
    on: &Expr,
    inner: &Expr,
    member: &Name,
    cx: &mut Diagnostics,
) -> Option<ResolvedTarget<'g>> {
    let ExprKind::Name(joint) = &inner.kind else {
        cx.report_error(on.place.clone(), "expected a joint, a coordinate of a joint, or a body");
        return None;
    };
    let Some(coordinates) = scope.joint_coordinates(joint) else {
        if scope.can_be_joint_child(joint) {
            cx.report_error(member.place.clone(), format!("`{joint}` is a body and has no coordinates"))
                .add_help(format!("write `on = {joint}` and give a direction, or name a joint"));
            return None;
        }
        if scope.record_first_report(joint, cx) {
            let known = scope.joint_names();
            let error = cx.report_error(inner.place.clone(), format!("unknown joint `{joint}`"));
            error.suggest_name(joint, known.iter().map(String::as_str));
            if error.has_no_help() {
                error.add_help("name a joint and one of its coordinates, as in `on = slot.slide`");
            }
        }
        return None;
    };
    let full = format!("{joint}.{}", member.text);
    if let Some((_, c, angle)) = coordinates.iter().find(|(n, ..)| *n == full) {
        return Some(ResolvedTarget::Coordinate(*c, Some(*angle)));
    }
    let own: Vec<&str> = coordinates.iter().map(|(n, ..)| n.as_str()).collect();
    cx.report_error(member.place.clone(), format!("`{joint}` has no coordinate `{}` to act on", member.text))
        .suggest_name(&full, own);
    None
}

/// Returns the declared coordinate with this name.
fn find_declared_coordinate<'g>(scope: &Scope<'_, 'g>, name: &str) -> Option<Coordinate> {
    let free = scope.description.coordinates.iter().any(|c| c.name.text == name);
    let kinematics = &scope.kinematics;
    let known = kinematics.coordinates.iter().find(|(known, ..)| free && known == name);
    known.map(|(_, c, _)| *c)
}

/// Reports a name that cannot be a target, with the reason.
fn report_invalid_target<'g>(scope: &Scope<'_, 'g>, name: &str, place: &Place, cx: &mut Diagnostics) {
    if name == GROUND {
        cx.report_error(place.clone(), "a force on the ground has no effect")
            .add_help("name a body that moves, or one of its points: `on = body.at(length * x)`");
    } else if scope.kind_of_name(name) == Some("a joint") {
        cx.report_error(place.clone(), format!("`{name}` is a joint and has no points"))
            .add_help(format!("write `on = {name}`, or name a point of a body"));
    } else if let Some(what) = scope.kind_of_name(name) {
        cx.report_error(place.clone(), format!("`{name}` is {what}: nothing can act on it"))
            .add_help("write `on = hinge`, `on = slot.slide`, `on = arm` or `on = arm.at(length * x)`");
    } else {
        let mut known = scope.joint_names();
        known.extend(scope.placeable_names().map(str::to_string));
        known.extend(scope.description.coordinates.iter().map(|c| c.name.text.clone()));
        if !scope.record_first_report(name, cx) {
            return;
        }
        let error = cx.report_error(place.clone(), format!("unknown joint or body `{name}`"));
        error.suggest_name(name, known.iter().map(String::as_str));
        if error.has_no_help() {
            error.add_help("write `on = hinge`, `on = slot.slide`, `on = arm` or `on = arm.at(length * x)`");
        }
    }
}
