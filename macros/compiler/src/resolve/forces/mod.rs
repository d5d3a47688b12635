//! Force elements and inputs, with their targets and parameters.

mod dashpot;
mod friction;
mod gravity;
mod inerter;
mod load;
mod spring;

pub use spring::Law;

use super::builder::Builder;
use super::motion::Moving;
use super::power::{ForceCounts, is_power_used};
use super::target::Target;
use super::terms::Stretch;
use crate::diag::Diagnostics;
use crate::mechanism::{Coordinate, Input};
use crate::syntax::{Action, ExprKind, ForceKind, Key, Name, Target as On};

impl<'g> Builder<'_, 'g> {
    /// Resolves force elements on coordinates, which need no positions.
    pub fn check_actions(&mut self, cx: &mut Diagnostics) {
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
                self.add_action(action, cx);
            }
        }
    }

    /// Adds all force elements and inputs.
    pub fn add_actions(&mut self, _: Moving, cx: &mut Diagnostics) {
        // Inputs without an element of their own appear in expressions. The others are filled in by their
        // elements.
        for input in &self.description.inputs {
            self.model.inputs.push((input.text.clone(), Input::Named));
        }
        for action in &self.description.actions {
            let before = ForceCounts::of_model(&self.model);
            self.add_action(action, cx);
            // An element without an effect may be zero by its values. An input has an entry of `u` in any
            // case.
            let has_no_effect =
                ForceCounts::of_model(&self.model) == before && !self.is_input(&action.name.text);
            if cx.is_empty() && action.is_input() && has_no_effect {
                report_unused_input(&action.name, cx);
            }
            self.record_applied(&before, &action.name.text);
            if is_power_used(self.description, &action.name) {
                let power = self.power_since(&before, &action.name.text);
                self.scope.kinematics.powers.insert(action.name.text.clone(), power);
            }
        }
    }

    /// Whether an input with this name has its own entry of `u` on a coordinate or a body.
    fn is_input(&self, name: &str) -> bool {
        self.model.inputs.iter().any(|(known, input)| known == name && !matches!(input, Input::Named))
    }

    /// Adds one force element or input to the model.
    fn add_action(&mut self, action: &Action, cx: &mut Diagnostics) {
        let add = match action.kind {
            ForceKind::Gravity => return self.add_gravity(action, cx),
            ForceKind::Force | ForceKind::Torque => return self.add_acting(action, cx),
            ForceKind::Spring => Self::add_spring,
            ForceKind::Dashpot => Self::add_dashpot,
            ForceKind::Inerter => Self::add_inerter,
            ForceKind::Friction => Self::add_friction,
            ForceKind::Attraction => Self::add_attraction,
        };
        if let Some(on) = self.acted_on(action, cx) {
            add(self, action, on, cx);
        }
    }

    /// Returns the length or the angle on which a force element acts.
    fn acted_on(&self, action: &Action, cx: &mut Diagnostics) -> Option<ActedOn<'g>> {
        match &action.on {
            On::On(e) => match self.target(e, cx)? {
                Target::Coordinate(c, angle) => Some(ActedOn { stretch: None, angle, coordinate: Some(c) }),
                Target::Expression(stretch) => {
                    Some(ActedOn { stretch: Some(stretch), angle: None, coordinate: None })
                }
                Target::Point(_) => {
                    let phrase = action.kind.phrase();
                    cx.error(
                        e.place.clone(),
                        format!("{phrase} acts on the coordinate of a joint, but this is a body"),
                    )
                    .help("name a joint, as in `on = hinge`, or two points: `between = (first, second)`");
                    None
                }
            },
            On::Between(a, b) => {
                let stretch = Some(self.distance(a, b, cx)?);
                Some(ActedOn { stretch, angle: Some(false), coordinate: None })
            }
        }
    }

    /// Returns the value and the rate of the length or the angle on which an element acts.
    fn stretch_on(&self, on: ActedOn<'g>) -> Option<Stretch<'g>> {
        on.stretch.or_else(|| on.coordinate.map(|c| self.coordinate_stretch(&c)))
    }
}

/// The length or the angle on which a force element acts.
pub struct ActedOn<'g> {
    /// Value and rate of the length or the angle; `None` for a coordinate.
    pub stretch: Option<Stretch<'g>>,
    /// Whether it is an angle; `None` if it may also be a length.
    pub angle: Option<bool>,
    /// Coordinate, if the element acts on one.
    pub coordinate: Option<Coordinate>,
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
    cx.error(name.place.clone(), format!("internal error: the input `{}` acts nowhere", name.text))
        .help("please report this with the mechanism");
}
