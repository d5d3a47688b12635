//! Applied forces and torques: with a value, or as inputs.

use crate::diag::{Diagnostics, Place};
use crate::expr::diff::DirectionalDerivative;
use crate::expr::replace::substitute_symbols;
use crate::expr::{Expr as Value, Function, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::{AccelerationForce, InputEffect, Load, Pose, Quantity, SumOfLinkVectors};
use crate::resolve::element_forces::ElementForces;
use crate::resolve::scope::{AllowedQuantities, Context, PlacedElement, PlacedElementKind, Scope};
use crate::resolve::target::{ResolvedTarget, resolve_target};
use crate::resolve::terms::{coordinate_stretch, distance_between_points};
use crate::syntax::{Action, Expr, ExprKind, Key, Target};

/// Returns a force or a torque, with a value or as an input.
pub fn force_or_torque_of_action<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let torque = action.kind.row().torque;
    let direction = action.expression_of_key(if torque { Key::About } else { Key::Along });
    match (&action.on, action.expression_of_key(Key::Value)) {
        (Target::On(on), None) => {
            let target = resolve_target(scope, on, cx)?;
            resolve_input_force(scope, action, on, target, direction, torque, cx)
        }
        (Target::On(on), Some(value)) => force_of_expression_value(scope, on, direction, value, torque, cx),
        (Target::Between(first, second), value) => {
            force_between(scope, action, [first, second], direction, value, cx)
        }
    }
}

/// Returns a force or torque element whose value is an expression.
fn force_of_expression_value<'g>(
    scope: &Scope<'_, 'g>,
    on: &Expr,
    direction: Option<&Expr>,
    value: &Expr,
    torque: bool,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    if let Some(direction) = direction {
        cx.report_error(direction.place.clone(), "a value has a direction of its own")
            .add_help("write the direction into the value: `value = magnitude * x`");
        return None;
    }
    let place = match resolve_target(scope, on, cx)? {
        ResolvedTarget::Point(place) => place,
        ResolvedTarget::Coordinate(_, Some(angle)) if angle != torque => {
            report_length_angle_mismatch(on, angle, cx);
            return None;
        }
        ResolvedTarget::Coordinate(c, _) => {
            return load_conjugate_to_rate(scope, coordinate_stretch(scope, &c).rate, value, cx);
        }
        ResolvedTarget::Expression(stretch) => return load_conjugate_to_rate(scope, stretch.rate, value, cx),
    };
    if torque && !can_torque_act_on_element(on, &place, cx) {
        return None;
    }
    let Some(link) = place.link else {
        cx.report_error(on.place.clone(), "this is fixed to the ground: a force on it has no effect");
        return None;
    };
    let context = Context::new(AllowedQuantities::Acceleration, Some((place.link, place.pose.clone())));
    let terms = scope.call_in_context(context, |scope| scope.resolve_vector_terms(value, cx))?;
    let kinematics = &scope.kinematics;
    let force = kinematics.components_in_link_axes(&terms, place.link, Vec3::zero(scope.graph));
    let twist = kinematics.twists[link.0];
    let rate = match torque {
        true => twist.angular,
        false => twist.linear + twist.angular.cross(place.pose.translation),
    };
    let mut all = ElementForces::default();
    for k in (0..3).filter(|k| !force[*k].is_zero()) {
        let component = load_split_by_acceleration(rate[k], force[k], &value.place, cx)?;
        all.loads.extend(component.loads);
        all.acceleration_forces.extend(component.acceleration_forces);
    }
    Some(all)
}

/// Returns the load whose power is `value × rate`. Vectors in the scalar expression `value` are in ground
/// axes.
fn load_conjugate_to_rate<'g>(
    scope: &Scope<'_, 'g>,
    rate: Value<'g>,
    value: &Expr,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let context = Context::new(AllowedQuantities::Acceleration, Some((None, Pose::identity(scope.graph))));
    let force = scope.call_in_context(context, |scope| scope.resolve_scalar(value, cx))?;
    load_split_by_acceleration(rate, force, &value.place, cx)
}

/// Returns a force along the line between two points, with a value or as an input. A positive force
/// separates the points.
fn force_between<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    [first, second]: [&Expr; 2],
    along: Option<&Expr>,
    value: Option<&Expr>,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    if let Some(along) = along {
        cx.report_error(along.place.clone(), "a force between two points acts along their line")
            .add_help("remove this argument, or let a force act on each of two bodies");
    }
    let stretch = distance_between_points(scope, first, second, cx)?;
    let rate = match stretch.signed {
        true => stretch.value.apply_function(Function::Signum) * stretch.rate,
        false => stretch.rate,
    };
    match value {
        Some(value) => load_conjugate_to_rate(scope, rate, value, cx),
        None => Some(load_of_input(scope.input_index(&action.name.text)?, rate)),
    }
}

/// Returns an input on a coordinate, an expression, or a point of a body.
fn resolve_input_force<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    on: &Expr,
    target: ResolvedTarget<'g>,
    direction: Option<&Expr>,
    torque: bool,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let mut refuse_direction = |what: &str| {
        if let Some(direction) = direction {
            cx.report_error(direction.place.clone(), format!("the {what} determines the direction"))
                .add_help("remove this argument, or let it act on a body");
        }
    };
    let input = match target {
        ResolvedTarget::Coordinate(_, Some(angle)) if angle != torque => {
            report_length_angle_mismatch(on, angle, cx);
            return None;
        }
        ResolvedTarget::Coordinate(c, _) => {
            refuse_direction("joint");
            InputEffect::Coordinate(c)
        }
        ResolvedTarget::Expression(stretch) => {
            refuse_direction("expression");
            return Some(load_of_input(scope.input_index(&action.name.text)?, stretch.rate));
        }
        ResolvedTarget::Point(place) => {
            match point_input(scope, action, on, &place, direction, torque, cx)? {
                // The point moves on its body.
                InputEffect::Force { link, point, along } if is_moving_vector(point) => {
                    let kinematics = &scope.kinematics;
                    let twist = &kinematics.twists[link.0];
                    let along =
                        kinematics.components_in_link_axes(&along, Some(link), Vec3::zero(scope.graph));
                    let rate = (twist.linear + twist.angular.cross(point)).dot(along);
                    return Some(load_of_input(scope.input_index(&action.name.text)?, rate));
                }
                InputEffect::Torque { .. } if is_moving_vector(place.pose.translation) => return None,
                input => input,
            }
        }
    };
    Some(ElementForces { input: Some(input), ..ElementForces::default() })
}

/// Returns the input with this index in `u`, as a force on a rate.
pub fn load_of_input<'g>(index: usize, rate: Value<'g>) -> ElementForces<'g> {
    let force = Quantity::Input(index).expr(rate.graph());
    ElementForces { loads: vec![Load { rate, force, dissipative: false }], ..ElementForces::default() }
}

/// Returns a force on a rate. Terms that are linear in the accelerations are separated from the others.
pub fn load_split_by_acceleration<'g>(
    rate: Value<'g>,
    force: Value<'g>,
    place: &Place,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let graph = force.graph();
    let mut forces = ElementForces::default();
    let acceleration_symbol = |s| match Quantity::from_symbol(s) {
        Quantity::Acceleration(k) => Some((s, k)),
        _ => None,
    };
    let acceleration_symbols: Vec<_> =
        symbols_in(&[force]).into_iter().filter_map(acceleration_symbol).collect();
    if acceleration_symbols.is_empty() {
        forces.loads.push(Load { rate, force, dissipative: false });
        return Some(forces);
    }
    let acceleration_coefficient_of_force =
        |(s, k): &(_, usize)| (*k, DirectionalDerivative::with_respect_to(*s, graph).differentiate(force));
    let factors: Vec<(usize, Value<'g>)> = acceleration_symbols
        .iter()
        .map(acceleration_coefficient_of_force)
        .filter(|(_, f)| !f.is_zero())
        .collect();
    let all: Vec<Value<'g>> = factors
        .iter()
        .map(|(_, acceleration_coefficient_of_force)| *acceleration_coefficient_of_force)
        .collect();
    let quantities: Vec<Quantity> = symbols_in(&all).into_iter().map(Quantity::from_symbol).collect();
    if quantities.iter().any(|q| matches!(q, Quantity::Acceleration(_))) {
        cx.report_error(place.clone(), "a force can depend on accelerations only linearly")
            .add_help("the equations of motion are solved for the accelerations: write the force as a sum of terms with one acceleration each");
        return None;
    }
    if quantities.iter().any(|q| matches!(q, Quantity::Input(_))) {
        cx.report_error(place.clone(), "the factor of an acceleration cannot depend on inputs")
            .add_help("the equations of motion are solved for the accelerations before the inputs are known: let a `State` follow the input");
        return None;
    }
    let remainder = substitute_symbols(force, &|s| acceleration_symbol(s).map(|_| graph.zero()));
    if !remainder.is_zero() {
        forces.loads.push(Load { rate, force: remainder, dissipative: false });
    }
    if !factors.is_empty() {
        forces.acceleration_forces.push(AccelerationForce { rate, factors, place: place.clone() });
    }
    Some(forces)
}

/// Returns an input at a point of a body; `None` after an error.
fn point_input<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    on: &Expr,
    place: &PlacedElement<'g>,
    direction: Option<&Expr>,
    torque: bool,
    cx: &mut Diagnostics,
) -> Option<InputEffect<'g>> {
    let Some(direction) = direction else {
        let key = if torque { "about" } else { "along" };
        cx.report_error(action.name.place.clone(), format!("missing `{key}`"))
            .add_help(format!("on a body it needs a direction: `{key} = x`, `{key} = ground.z`"));
        return None;
    };
    if torque && !can_torque_act_on_element(on, place, cx) {
        return None;
    }
    let context = Context::new(AllowedQuantities::Constant, Some((place.link, place.pose.clone())));
    let terms = scope.call_in_context(context, |scope| scope.resolve_vector_terms(direction, cx))?;
    let Some(link) = place.link else {
        cx.report_error(on.place.clone(), "this body is fixed to the ground: a force on it has no effect")
            .add_help("name a body that moves");
        return None;
    };
    let sum: SumOfLinkVectors<'g> = terms;
    if sum.iter().all(|(_, v)| v.is_zero()) {
        cx.report_error(direction.place.clone(), "this direction is zero")
            .add_help("write `x`, `y`, `z` or another vector of some length");
        return None;
    }
    Some(match torque {
        true => InputEffect::Torque { link, about: sum },
        false => InputEffect::Force { link, point: place.pose.translation, along: sum },
    })
}

/// Whether a vector depends on the configuration or on time.
fn is_moving_vector(v: Vec3<'_>) -> bool {
    let is_moving_symbol =
        |s| matches!(Quantity::from_symbol(s), Quantity::Configuration(_) | Quantity::Time);
    symbols_in(&v.0).into_iter().any(is_moving_symbol)
}

/// Whether a torque can act on an element; reports particles and points, which have no rotation.
fn can_torque_act_on_element(on: &Expr, place: &PlacedElement<'_>, cx: &mut Diagnostics) -> bool {
    let ExprKind::Name(name) = &on.kind else { return true };
    if place.kind == PlacedElementKind::Point {
        cx.report_error(on.place.clone(), format!("`{name}` is a point, on which a torque has no effect"))
            .add_help("let it act on a body, or write a `Force`");
        return false;
    }
    true
}

fn report_length_angle_mismatch(on: &Expr, angle: bool, cx: &mut Diagnostics) {
    let (is, other) = if angle { ("an angle", "Torque") } else { ("a length", "Force") };
    cx.report_error(on.place.clone(), format!("this coordinate is {is}"))
        .add_help(format!("the element that acts on it is a {other}"));
}
