//! Force elements and inputs, with their targets and parameters.

mod dashpot;
mod friction;
mod gravity;
mod inerter;
mod load;
mod spring;

pub use friction::dry_friction;
pub use inerter::inertance;
pub use load::{input_load, value_load};
pub use spring::{Law, spring_law};

use super::builder::Builder;
use super::motion::Moving;
use super::power::is_power_used;
use super::target::Target;
use super::terms::Stretch;
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::mechanism::{
    AccelerationForce, Coordinate, CoulombFriction, Dashpot, Inertance, Input, Load, Model, Spring,
};
use crate::syntax::{Action, ExprKind, ForceKind, Key, Name, Target as On};

/// Forces of an element, which the builder adds to those of the others.
#[derive(Default)]
pub struct Forces<'g> {
    /// Linear springs on coordinates.
    pub springs: Vec<Spring<'g>>,
    /// Linear dashpots on coordinates.
    pub dashpots: Vec<Dashpot<'g>>,
    /// Coulomb friction on coordinates.
    pub frictions: Vec<CoulombFriction<'g>>,
    /// Forces on rates.
    pub loads: Vec<Load<'g>>,
    /// Potential energies.
    pub potentials: Vec<Expr<'g>>,
    /// Dissipation functions.
    pub dissipations: Vec<Expr<'g>>,
    /// Inertances on rates.
    pub inertances: Vec<Inertance<'g>>,
    /// Forces that are linear in accelerations.
    pub acceleration_forces: Vec<AccelerationForce<'g>>,
    /// Effect of the entry of `u` that belongs to the element.
    pub input: Option<Input<'g>>,
}

impl<'g> Forces<'g> {
    /// Returns the forces of potential energies.
    pub fn of_potentials(energies: impl IntoIterator<Item = Expr<'g>>) -> Forces<'g> {
        Forces { potentials: energies.into_iter().collect(), ..Forces::default() }
    }

    /// Returns a force that opposes a rate and dissipates energy.
    pub fn resisting(rate: Expr<'g>, force: Expr<'g>) -> Forces<'g> {
        Forces { loads: vec![Load { rate, force: -force, dissipative: true }], ..Forces::default() }
    }

    /// Whether there is no force and no input.
    fn is_empty(&self) -> bool {
        let linear = self.springs.len() + self.dashpots.len() + self.frictions.len();
        let functions = self.potentials.len() + self.dissipations.len();
        let forces = self.loads.len() + self.inertances.len() + self.acceleration_forces.len();
        linear + functions + forces == 0 && self.input.is_none()
    }

    /// Adds the forces to those of a model.
    pub fn add_to(self, model: &mut Model<'g>) {
        model.springs.extend(self.springs);
        model.dashpots.extend(self.dashpots);
        model.frictions.extend(self.frictions);
        model.loads.extend(self.loads);
        model.potentials.extend(self.potentials);
        model.dissipations.extend(self.dissipations);
        model.inertances.extend(self.inertances);
        model.acceleration_forces.extend(self.acceleration_forces);
    }
}

impl<'g> Builder<'_, 'g> {
    /// Resolves force elements on coordinates, which need no positions.
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

    /// Adds all force elements and inputs.
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
            ForceKind::Gravity => return gravity::gravity(self, action, cx),
            ForceKind::Force | ForceKind::Torque => return load::load(self, action, cx),
            ForceKind::Spring => spring::spring,
            ForceKind::Dashpot => dashpot::dashpot,
            ForceKind::Inerter => inerter::inerter,
            ForceKind::Friction => friction::friction,
            ForceKind::Attraction => gravity::attraction,
        };
        let on = self.acted_on(action, cx)?;
        forces(self, action, on, cx)
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
