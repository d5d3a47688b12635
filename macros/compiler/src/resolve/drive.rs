//! Force elements and inputs of a file: on a weighted sum of coordinates, on a length, or at a point of a
//! body.

use super::element_forces::ElementForces;
use super::forces::{
    SpringLaw, dry_friction, inertance_force, load_of_input, load_split_by_acceleration, report_unused_input,
    spring_force_of_law,
};
use super::scope::{AllowedQuantities, Context, Scope};
use super::terms::{StretchWithRate, coordinate_stretch, value_and_rate_of_expression};
use crate::diag::Diagnostics;
use crate::expr::{Expr as Value, Extreme, Function, Vec3};
use crate::kinematics::{time_derivative, velocity_gradient};
use crate::mechanism::{Coordinate, CoulombFriction, Dashpot, Pose, Quantity, Spring};
use crate::syntax::{
    Description, Expr, FileForceElement, FileForceLaw, FileForceQuantity, FileForceTarget, Wrench,
};

/// Returns the inputs among the force elements of a file, in the order of their entries in `u`. These entries
/// follow those of the driven joints and precede all others.
pub fn drives_that_are_inputs(d: &Description) -> impl Iterator<Item = &FileForceElement> {
    d.drives.iter().filter(|drive| matches!(drive.law, FileForceLaw::Input(_)))
}

/// Returns the coordinates of the joints on which an element of a file acts, each multiplied by its weight.
pub fn weighted_coordinates(
    scope: &Scope<'_, '_>,
    drive: &FileForceElement,
    cx: &mut Diagnostics,
) -> Vec<Coordinate> {
    let mut terms: Vec<Coordinate> = Vec::new();
    for (joint, weight) in drive.on.weighted_joints() {
        match weighted_coordinate(scope, &joint.text, *weight) {
            Some(coordinate) => terms.push(coordinate),
            None => report_unused_input(&drive.name, cx),
        }
    }
    terms
}

/// Returns the quantities of an element to which expressions of the file refer. `input` is the index in `u`
/// of an element that is an input.
pub fn file_element_quantities<'g>(
    scope: &Scope<'_, 'g>,
    drive: &FileForceElement,
    (input, terms): (usize, &[Coordinate]),
    cx: &mut Diagnostics,
) -> Vec<(FileForceQuantity, Value<'g>)> {
    let g = scope.graph;
    match drive.law {
        FileForceLaw::Input(_) => vec![(FileForceQuantity::Input, Quantity::Input(input).expr(g))],
        FileForceLaw::Expression { offset, .. } => {
            let stretch = length_or_wrench_of_drive(scope, &drive.on, terms, cx);
            let [length, rate] = stretch.map_or([g.zero(); 2], |stretch| [stretch.value, stretch.rate]);
            vec![(FileForceQuantity::Length, length + g.num(offset)), (FileForceQuantity::Rate, rate)]
        }
        _ => Vec::new(),
    }
}

/// Returns the length on which an element acts, with its rate; for a wrench the conjugate rate, and zero for
/// the length.
fn length_or_wrench_of_drive<'g>(
    scope: &Scope<'_, 'g>,
    on: &FileForceTarget,
    terms: &[Coordinate],
    cx: &mut Diagnostics,
) -> Option<StretchWithRate<'g>> {
    match on {
        FileForceTarget::Sum(_) => Some(stretch_of_coordinate_sum(scope, terms)),
        FileForceTarget::Length(e) => value_and_rate_of_expression(scope, e, cx),
        FileForceTarget::Wrench(wrench) => rate_conjugate_to_wrench(scope, wrench, cx),
    }
}

/// Returns the forces of an element; `None` without an effect. `input` is the index in `u` of an element that
/// is an input.
pub fn resolve_file_element_forces<'g>(
    scope: &Scope<'_, 'g>,
    drive: &FileForceElement,
    (input, terms): (usize, &[Coordinate]),
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let (place, g) = (&drive.name.place, scope.graph);
    let on = if let [on] = terms { Some(*on) } else { None };
    // The ratio of the coordinate is the weight.
    match (on, &drive.law) {
        (Some(on), &FileForceLaw::Spring { stiffness, free }) => {
            let springs = vec![Spring { on, stiffness: g.num(stiffness), free: g.num(free) }];
            return Some(ElementForces { springs, ..ElementForces::default() });
        }
        (Some(on), &FileForceLaw::Damper(damping)) => {
            let dashpots = vec![Dashpot { on, damping: g.num(damping) }];
            return Some(ElementForces { dashpots, ..ElementForces::default() });
        }
        (Some(on), &FileForceLaw::Friction(force)) => {
            let frictions = vec![CoulombFriction { on, friction: g.num(force) }];
            return Some(ElementForces { frictions, ..ElementForces::default() });
        }
        _ => {}
    }
    // A force on a constant length has no effect.
    if let (FileForceTarget::Sum(_), FileForceLaw::Input(_)) = (&drive.on, &drive.law) {
        return None;
    }
    let stretch = length_or_wrench_of_drive(scope, &drive.on, terms, cx)?;
    if velocity_gradient(stretch.rate).is_empty() {
        return None;
    }
    let syntax_number = |value| Expr::number_at(value, place);
    match drive.law {
        FileForceLaw::Spring { stiffness, free } => spring_force_of_law(
            scope,
            stretch,
            &SpringLaw::Linear(&syntax_number(stiffness)),
            g.num(free),
            cx,
        ),
        FileForceLaw::Slack { stiffness, range: [low, high] } => {
            let short = (stretch.value - g.num(low)).minimum_or_maximum(Extreme::Min, g.zero());
            let long = (stretch.value - g.num(high)).minimum_or_maximum(Extreme::Max, g.zero());
            let excess = if low == high { stretch.value - g.num(low) } else { short + long };
            let [first, second, third] = stiffness.map(|k| g.num(k));
            let cubic = second * (1.0 / 3.0) + third * 0.25 * excess;
            Some(ElementForces::forces_of_potentials([excess.square() * (first * 0.5 + cubic * excess)]))
        }
        FileForceLaw::PolynomialDamper(damping) => {
            let [first, second, third] = damping.map(|c| g.num(c));
            let speed = stretch.rate.apply_function(Function::Abs);
            let factor = first + (second + third * speed) * speed;
            Some(ElementForces::resisting_force(stretch.rate, factor * stretch.rate))
        }
        FileForceLaw::Damper(damping) => {
            let damping = scope.resolve_scalar(&syntax_number(damping), cx)?;
            Some(ElementForces::resisting_force(stretch.rate, damping * stretch.rate))
        }
        FileForceLaw::Friction(force) => dry_friction(
            scope,
            stretch.rate,
            [Some(&syntax_number(force)), None, None, None, None],
            place,
            cx,
        ),
        FileForceLaw::Inerter(value) => inertance_force(scope, stretch.rate, &syntax_number(value), cx),
        FileForceLaw::Push(force) => load_split_by_acceleration(stretch.rate, g.num(force), place, cx),
        FileForceLaw::Input(_) => Some(load_of_input(input, stretch.rate)),
        FileForceLaw::Expression { ref force, .. } => {
            let context = Context::new(AllowedQuantities::Motion, Some((None, Pose::identity(g))));
            let force = scope.call_in_context(context, |scope| scope.resolve_scalar(force, cx))?;
            load_split_by_acceleration(stretch.rate, force, place, cx)
        }
    }
}

/// Returns the rate on which a force and a torque at a point do work, `f · v + t · ω`. The velocities are
/// relative to the body on which the reaction acts, if there is one.
fn rate_conjugate_to_wrench<'g>(
    scope: &Scope<'_, 'g>,
    wrench: &Wrench,
    cx: &mut Diagnostics,
) -> Option<StretchWithRate<'g>> {
    let g = scope.graph;
    let on = scope.resolve_placement(&wrench.on, cx)?;
    let against = match &wrench.against {
        Some(against) => Some(scope.resolve_placement(against, cx)?),
        None => None,
    };
    let axes = against.as_ref().unwrap_or(&on);
    let [force, torque] = [wrench.force, wrench.torque]
        .map(|vector| axes.pose.rotation.vector_in_parent_axes(Vec3::vector_from_constants(g, vector)));
    let kinematics = &scope.kinematics;
    let rate = match &against {
        None => on.link.map_or(g.zero(), |link| {
            let twist = &kinematics.twists[link.0];
            let at = twist.linear + twist.angular.cross(on.pose.translation);
            at.dot(force) + twist.angular.dot(torque)
        }),
        Some(against) => {
            let zero = Vec3::zero(g);
            let between = kinematics.position_between(&on, against);
            let path = kinematics.components_in_link_axes(&between, against.link, zero).dot(force);
            let turning = kinematics.angular_velocity_in_frame(on.link, against.link, g);
            let turning = kinematics.components_in_link_axes(&turning, against.link, zero).dot(torque);
            time_derivative(scope.configuration_space(), path) + turning
        }
    };
    Some(StretchWithRate { value: g.zero(), rate, square: g.zero(), signed: false })
}

/// Returns the coordinate of a joint with one degree of freedom, multiplied by a weight.
fn weighted_coordinate<'g>(scope: &Scope<'_, 'g>, joint: &str, weight: f64) -> Option<Coordinate> {
    match scope.joint_coordinates(joint)? {
        [(_, c, _)] => Some(Coordinate { ratio: weight * c.ratio, offset: weight * c.offset, ..*c }),
        _ => None,
    }
}

/// Returns the stretch of a sum of coordinates.
fn stretch_of_coordinate_sum<'g>(scope: &Scope<'_, 'g>, terms: &[Coordinate]) -> StretchWithRate<'g> {
    let zero = scope.graph.zero();
    let mut sum = StretchWithRate { value: zero, rate: zero, square: zero, signed: false };
    for c in terms {
        let one = coordinate_stretch(scope, c);
        (sum.value, sum.rate) = (sum.value + one.value, sum.rate + one.rate);
    }
    sum.square = sum.value.square();
    sum
}
