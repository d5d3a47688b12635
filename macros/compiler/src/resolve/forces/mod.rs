//! Resolution of force elements and inputs, with their targets and parameters.

mod dashpot;
mod friction;
mod gravity;
mod inerter;
mod load;
mod spring;

pub use friction::dry_friction;
pub use inerter::inertance_force;
pub use load::{load_of_input, load_split_by_acceleration};
pub use spring::{SpringLaw, spring_force_of_law};

use super::element_forces::ElementForces;
use super::scope::Scope;
use super::target::{ResolvedTarget, resolve_target};
use super::terms::{ForceElementCoordinate, distance_between_points};
use crate::diag::Diagnostics;
use crate::syntax::{Action, ExprKind, ForceKind, Key, Name, Target};

/// Resolves force elements on coordinates, which need no positions.
pub fn resolve_coordinate_actions<'g>(scope: &Scope<'_, 'g>, cx: &mut Diagnostics) {
    for action in &scope.description.actions {
        let on_joint = match &action.on {
            Target::On(e) => match &e.kind {
                ExprKind::Name(name) => scope.joint_coordinates(name).is_some(),
                ExprKind::Field(..) => true,
                _ => false,
            },
            Target::Between(..) => false,
        };
        if on_joint && !needs_positions_and_velocities(action) {
            let _ = forces_of_element(scope, action, cx);
        }
    }
}

/// Returns the forces of an element; `None` after an error.
pub fn forces_of_element<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let forces = match action.kind {
        ForceKind::Gravity => return gravity::central_gravity_force(scope, action, cx),
        ForceKind::Force | ForceKind::Torque => return load::force_or_torque_of_action(scope, action, cx),
        ForceKind::Spring => spring::spring_force,
        ForceKind::Dashpot => dashpot::dashpot_force,
        ForceKind::Inerter => inerter::inerter_force,
        ForceKind::Friction => friction::friction_force,
        ForceKind::Attraction => gravity::attraction_force,
    };
    let on = length_or_angle_acted_on(scope, action, cx)?;
    forces(scope, action, on, cx)
}

/// Returns the length or the angle on which a force element acts.
fn length_or_angle_acted_on<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    cx: &mut Diagnostics,
) -> Option<ForceElementCoordinate<'g>> {
    match &action.on {
        Target::On(e) => match resolve_target(scope, e, cx)? {
            ResolvedTarget::Coordinate(c, angle) => {
                Some(ForceElementCoordinate { stretch: None, angle, coordinate: Some(c) })
            }
            ResolvedTarget::Expression(stretch) => {
                Some(ForceElementCoordinate { stretch: Some(stretch), angle: None, coordinate: None })
            }
            ResolvedTarget::Point(_) => {
                let phrase = action.kind.name_with_article();
                cx.report_error(
                    e.place.clone(),
                    format!("{phrase} acts on the coordinate of a joint, but this is a body"),
                )
                .add_help("name a joint, as in `on = hinge`, or two points: `between = (first, second)`");
                None
            }
        },
        Target::Between(a, b) => {
            let stretch = Some(distance_between_points(scope, a, b, cx)?);
            Some(ForceElementCoordinate { stretch, angle: Some(false), coordinate: None })
        }
    }
}

/// Whether an element needs positions and velocities: it acts between points or at a point of a body, or it
/// has a force law or a value.
fn needs_positions_and_velocities(action: &Action) -> bool {
    let own = match action.kind {
        ForceKind::Force | ForceKind::Torque => !action.is_input(),
        ForceKind::Gravity | ForceKind::Attraction => true,
        ForceKind::Dashpot => action.expression_of_key(Key::Force).is_some(),
        ForceKind::Spring | ForceKind::Inerter | ForceKind::Friction => false,
    };
    // A point given by a vector may move on its body.
    own || match &action.on {
        Target::Between(..) => true,
        Target::On(e) => matches!(e.kind, ExprKind::Method(..)),
    }
}

/// Reports a declared input without any effect, although no error was reported.
pub fn report_unused_input(name: &Name, cx: &mut Diagnostics) {
    cx.report_error(name.place.clone(), format!("internal error: the input `{}` acts nowhere", name.text))
        .add_help("please report this with the mechanism");
}
