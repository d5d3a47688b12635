//! Resolution of force elements and inputs, with their targets and parameters.

mod dashpot;
mod friction;
mod gravity;
mod inerter;
mod load;
mod spring;

pub use friction::dry_friction;
pub use inerter::inertance_force;
pub use load::{input_load, value_load};
pub use spring::{Law, spring_law};

use super::builder::Builder;
use super::element_forces::Forces;
use super::motion::Moving;
use super::power::is_power_used;
use super::target::Target;
use super::terms::{ActedOn, Stretch};
use crate::diag::Diagnostics;
use crate::mechanism::Input;
use crate::syntax::{Action, ExprKind, ForceKind, Key, Name, Target as On};

impl<'g> Builder<'_, 'g> {
    /// Checks force elements on coordinates, which need no positions of bodies.
    pub fn check_actions(&self, cx: &mut Diagnostics) {
        for action in &self.description.actions {
            let on_joint = match &action.on {
                On::On(e) => match &e.kind {
                    ExprKind::Name(name) => self.joint_coordinates(name).is_some(),
                    ExprKind::Field(..) => true,
                    _ => false,
                },
                On::Between(..) => false,
            };
            if on_joint && !needs_motion(action) {
                let _ = self.forces_of(action, cx);
            }
        }
    }

    /// Adds the forces of all force elements and inputs to the model.
    pub fn add_actions(&mut self, _: Moving, cx: &mut Diagnostics) {
        // Inputs without an element of their own appear in expressions. The others are filled in by their
        // elements.
        for input in &self.description.inputs {
            self.model.inputs.push((input.text.clone(), Input::Named));
        }
        for action in &self.description.actions {
            let mut forces = self.forces_of(action, cx).unwrap_or_default();
            // An element without an effect may be zero by its values. An input has an entry of `u` in any
            // case.
            if cx.is_empty() && action.is_input() && forces.is_empty() {
                report_unused_input(&action.name, cx);
            }
            if let Some(input) = forces.input.take()
                && let Some((_, slot)) =
                    self.model.inputs.iter_mut().find(|(known, _)| *known == action.name.text)
            {
                *slot = input;
            }
            if is_power_used(self.description, &action.name) {
                let power = self.power_of(&forces, &action.name.text);
                self.scope.kinematics.powers.insert(action.name.text.clone(), power);
            }
            self.add_forces(&action.name.text, forces);
        }
    }

    /// Adds the forces of an element, and records them for free-body diagrams.
    pub fn add_forces(&mut self, name: &str, forces: Forces<'g>) {
        self.record_applied(&forces, name);
        forces.add_to(&mut self.model);
    }

    /// Returns the forces of an element; `None` after an error.
    fn forces_of(&self, action: &Action, cx: &mut Diagnostics) -> Option<Forces<'g>> {
        let forces = match action.kind {
            ForceKind::Gravity => return gravity::central_gravity_force(self, action, cx),
            ForceKind::Force | ForceKind::Torque => return load::load(self, action, cx),
            ForceKind::Spring => spring::spring_force,
            ForceKind::Dashpot => dashpot::dashpot_force,
            ForceKind::Inerter => inerter::inerter_force,
            ForceKind::Friction => friction::friction_force,
            ForceKind::Attraction => gravity::attraction_force,
        };
        let on = self.acted_on(action, cx)?;
        forces(self, action, on, cx)
    }

    /// Returns the length or the angle on which a force element acts.
    fn acted_on(&self, action: &Action, cx: &mut Diagnostics) -> Option<ActedOn<'g>> {
        match &action.on {
            On::On(e) => match self.resolve_target(e, cx)? {
                Target::Coordinate(c, angle) => Some(ActedOn { stretch: None, angle, coordinate: Some(c) }),
                Target::Expression(stretch) => {
                    Some(ActedOn { stretch: Some(stretch), angle: None, coordinate: None })
                }
                Target::Point(_) => {
                    let phrase = action.kind.name_with_article();
                    cx.report_error(
                        e.place.clone(),
                        format!("{phrase} acts on the coordinate of a joint, but this is a body"),
                    )
                    .add_help("name a joint, as in `on = hinge`, or two points: `between = (first, second)`");
                    None
                }
            },
            On::Between(a, b) => {
                let stretch = Some(self.distance_between_points(a, b, cx)?);
                Some(ActedOn { stretch, angle: Some(false), coordinate: None })
            }
        }
    }

    /// Returns the value and the rate of the length or the angle on which an element acts.
    fn stretch_on(&self, on: ActedOn<'g>) -> Option<Stretch<'g>> {
        on.stretch.or_else(|| on.coordinate.map(|c| self.coordinate_stretch(&c)))
    }
}

/// Whether an element needs positions and velocities: it acts between points or at a point of a body, or it
/// has a force law or a value.
fn needs_motion(action: &Action) -> bool {
    let own = match action.kind {
        ForceKind::Force | ForceKind::Torque => !action.is_input(),
        ForceKind::Gravity | ForceKind::Attraction => true,
        ForceKind::Dashpot => action.get(Key::Force).is_some(),
        ForceKind::Spring | ForceKind::Inerter | ForceKind::Friction => false,
    };
    // A point given by a vector may move on its body.
    own || match &action.on {
        On::Between(..) => true,
        On::On(e) => matches!(e.kind, ExprKind::Method(..)),
    }
}

/// Reports a declared input without any effect, although no error was reported.
pub fn report_unused_input(name: &Name, cx: &mut Diagnostics) {
    cx.report_error(name.place.clone(), format!("internal error: the input `{}` acts nowhere", name.text))
        .add_help("please report this with the mechanism");
}
