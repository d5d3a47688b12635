//! Force elements and inputs: what they act on, and with which parameters.

use super::builder::Builder;
use super::motion::Moving;
use super::power::{Counts, is_asked};
use super::target::Target;
use crate::diag::Diagnostics;
use crate::mechanism::{Coordinate, Dashpot, Input, Rule, Spring};
use crate::syntax::{Action, ActionKind, Expr, ExprKind, Law, Name, Target as On};

impl<'g> Builder<'_, 'g> {
    /// Resolves force elements on coordinates, which need no places.
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
        // Inputs without an element of their own appear in expressions; the others are filled in by their
        // elements.
        for input in &self.description.inputs {
            self.model.inputs.push((input.text.clone(), Input::Named));
        }
        for action in &self.description.actions {
            let before = Counts::of(&self.model);
            self.add_action(action, cx);
            // An element without an effect may be zero by its values; an input has an entry of `u` in any case.
            let is_lost = Counts::of(&self.model) == before && !self.is_input(&action.name.text);
            if cx.is_empty() && is_command(&action.kind) && is_lost {
                report_lost(&action.name, cx);
            }
            self.know_applied(&before, &action.name.text);
            if is_asked(self.description, &action.name) {
                let power = self.power_since(&before, &action.name.text);
                self.scope.kinematics.borrow_mut().powers.insert(action.name.text.clone(), power);
            }
        }
    }

    /// Whether an entry of `u` acts where an element of this name says.
    fn is_input(&self, name: &str) -> bool {
        self.model.inputs.iter().any(|(known, input)| known == name && !matches!(input, Input::Named))
    }

    /// Adds one force element or input to the model.
    fn add_action(&mut self, action: &Action, cx: &mut Diagnostics) {
        match (&action.kind, &action.on) {
            (ActionKind::Force { along, value: None }, On::On(on)) => {
                let target = self.target(on, cx);
                self.add_input(action, on, target, along.as_ref(), false, cx);
            }
            (ActionKind::Torque { about, value: None }, On::On(on)) => {
                let target = self.target(on, cx);
                self.add_input(action, on, target, about.as_ref(), true, cx);
            }
            (ActionKind::Force { along, value: Some(value) }, On::On(on)) => {
                self.add_value(on, along.as_ref(), value, false, cx);
            }
            (ActionKind::Torque { about, value: Some(value) }, On::On(on)) => {
                self.add_value(on, about.as_ref(), value, true, cx);
            }
            (ActionKind::Force { along, value }, On::Between(a, b)) => {
                self.add_force_between(action, [a, b], along.as_ref(), value.as_ref(), cx);
            }
            (ActionKind::Gravity { constant, mu }, on) => {
                self.add_gravity(action, on, constant.as_ref(), mu.as_ref(), cx);
            }
            (_, on) => self.add_element(action, on, cx),
        }
    }

    /// What works on a length or an angle.
    fn add_element(&mut self, action: &Action, on: &On, cx: &mut Diagnostics) {
        let (stretch, angle) = match on {
            On::On(e) => match self.target(e, cx) {
                Some(Target::Coordinate(c, angle)) => {
                    if self.add_plain(action, c, angle, cx) {
                        return;
                    }
                    (self.coordinate_stretch(&c), angle)
                }
                Some(Target::Expression(stretch)) => (stretch, None),
                Some(Target::Point(_)) => {
                    let what = kind_word(&action.kind);
                    cx.error(
                        e.place.clone(),
                        format!("{what} acts on the coordinate of a joint, but this is a body"),
                    )
                    .help("name a joint, as in `on = hinge`, or two points: `between = (first, second)`");
                    return;
                }
                None => return,
            },
            On::Between(a, b) => match self.distance(a, b, cx) {
                Some(stretch) => (stretch, Some(false)),
                None => return,
            },
        };
        match &action.kind {
            ActionKind::Spring { law, free } => {
                if let Some(free) = self.free_length(free, angle, cx) {
                    self.add_spring(stretch, law, free, cx);
                }
            }
            ActionKind::Dashpot { law } => self.add_dashpot(&stretch, law, cx),
            ActionKind::Inerter { inertance } => self.add_inerter(&stretch, inertance, cx),
            ActionKind::Friction { coulomb, stiction, stribeck_speed, viscous, speed } => {
                let all = [
                    Some(coulomb),
                    stiction.as_ref(),
                    stribeck_speed.as_ref(),
                    viscous.as_ref(),
                    speed.as_ref(),
                ];
                self.add_friction(&stretch, all, on.place(), cx);
            }
            ActionKind::Attraction { strength } => {
                if let Some(strength) = self.scope.scalar(strength, cx) {
                    self.add_attraction(&stretch, strength);
                }
            }
            ActionKind::Gravity { .. } | ActionKind::Force { .. } | ActionKind::Torque { .. } => {}
        }
    }

    fn free_length(
        &self,
        given: &Option<(Expr, bool)>,
        angle: Option<bool>,
        cx: &mut Diagnostics,
    ) -> Option<crate::expr::Expr<'g>> {
        let Some((free, is_angle)) = given else { return Some(self.scope.graph.zero()) };
        if let Some(angle) = angle.filter(|angle| angle != is_angle) {
            let (is, key) = if angle { ("an angle", "free_angle") } else { ("a length", "free_length") };
            cx.error(free.place.clone(), format!("the coordinate of this spring is {is}"))
                .help(format!("write `{key} = …`"));
            return None;
        }
        if *is_angle { self.scope.plane_angle(free, cx) } else { self.scope.scalar(free, cx) }
    }

    /// Linear springs and dashpots on a coordinate; false for everything else.
    fn add_plain(
        &mut self,
        action: &Action,
        on: Coordinate,
        angle: Option<bool>,
        cx: &mut Diagnostics,
    ) -> bool {
        match &action.kind {
            ActionKind::Spring { law: Law::Linear(stiffness), free } => {
                let stiffness = self.scope.scalar(stiffness, cx);
                let free = self.free_length(free, angle, cx);
                if let (Some(stiffness), Some(free)) = (stiffness, free) {
                    self.model.springs.push(Spring { on, stiffness, free });
                }
            }
            ActionKind::Dashpot { law: Law::Linear(written) } => {
                let damping = self.scope.scalar(written, cx);
                if let Some(d) = damping.and_then(|d| d.value()).filter(|d| *d < 0.0) {
                    cx.error(written.place.clone(), format!("a damping cannot be negative, but it is {d}"))
                        .help("a dashpot takes energy away by itself; what brings energy in is a `Force` or `Torque` with `value = …`");
                }
                if let Some(damping) = damping {
                    let figure = || format!("the damping of `{}`", action.name.text);
                    self.scope.require(Rule::NotNegative, figure, &[damping]);
                    self.model.dashpots.push(Dashpot { on, damping });
                }
            }
            _ => return false,
        }
        true
    }

    /// Central gravity: between two bodies with a gravitational constant, or towards a point with a
    /// gravitational parameter. It also turns a body with inertia.
    fn add_gravity(
        &mut self,
        action: &Action,
        on: &On,
        constant: Option<&Expr>,
        mu: Option<&Expr>,
        cx: &mut Diagnostics,
    ) {
        let On::Between(a, b) = on else {
            cx.error(on.place().clone(), "gravity acts between two bodies, or a point and a body").help(
                "write `between = (sun, planet), constant = G` or `between = (ground, satellite), mu = mu`",
            );
            return;
        };
        let stretch = self.distance(a, b, cx);
        // What has no place has no mass either, and that was told.
        let is_placed = stretch.is_some();
        let mut mass_of = |e: &Expr| if is_placed { self.mass_of(e, cx) } else { None };
        match (constant, mu) {
            (Some(constant), None) => {
                let masses = [mass_of(a), mass_of(b)];
                let constant = self.scope.scalar(constant, cx);
                if let (Some(g), [Some(m1), Some(m2)], Some(stretch)) = (constant, masses, stretch) {
                    self.add_attraction(&stretch, g * m1 * m2);
                    self.turn_by_gravity(a, b, g * m1, cx);
                    self.turn_by_gravity(b, a, g * m2, cx);
                }
            }
            (None, Some(mu)) => {
                let mass = mass_of(b);
                let mu = self.scope.scalar(mu, cx);
                if let (Some(mu), Some(m), Some(stretch)) = (mu, mass, stretch) {
                    self.add_attraction(&stretch, mu * m);
                    self.turn_by_gravity(a, b, mu, cx);
                }
            }
            _ => {
                cx.error(action.name.place.clone(), "gravity has a `constant` or a `mu`").help(
                    "`constant` is that of two masses, `mu` the gravitational parameter of the first place",
                );
            }
        }
    }

    fn turn_by_gravity(&mut self, a: &Expr, b: &Expr, mu: crate::expr::Expr<'g>, cx: &mut Diagnostics) {
        let ExprKind::Name(name) = &b.kind else { return };
        let Some(index) = self.jointed_index(name).filter(|k| *k < self.description.bodies.len()) else {
            return;
        };
        if let (Some(center), Some(body)) = (self.scope.place(a, cx), self.scope.place(b, cx)) {
            self.add_gravity_gradient(&body, &center, mu, index);
        }
    }

    /// The mass of a body or particle; its centre of mass must be its origin.
    fn mass_of(&self, e: &Expr, cx: &mut Diagnostics) -> Option<crate::expr::Expr<'g>> {
        if let ExprKind::Name(name) = &e.kind {
            if let Some(p) = self.description.particles.iter().find(|p| p.name.text == *name) {
                return self.scope.scalar(&p.mass, cx);
            }
            if let Some(k) = self.description.bodies.iter().position(|b| b.name.text == *name) {
                let (mass, com, _) = self.masses.get(k).copied().flatten()?;
                if !com.is_zero() {
                    cx.error(
                        e.place.clone(),
                        format!("gravity acts at the origin of `{name}`, which is not its centre of mass"),
                    )
                    .help("put the body's origin at its centre of mass");
                    return None;
                }
                return Some(mass);
            }
        }
        cx.error(e.place.clone(), "expected a body or a particle, which has mass")
            .help("name one; of a point without mass, such as `ground`, `mu` says what it attracts with");
        None
    }
}

/// Returns true for a force or torque without a value: an entry of `u` commands it.
fn is_command(kind: &ActionKind) -> bool {
    matches!(kind, ActionKind::Force { value: None, .. } | ActionKind::Torque { value: None, .. })
}

/// Reports an input that is declared and acts nowhere, although no error was reported.
pub fn report_lost(name: &Name, cx: &mut Diagnostics) {
    cx.error(name.place.clone(), format!("internal error: the input `{}` acts nowhere", name.text))
        .help("please report this with the mechanism");
}

/// True for force elements that are not on a coordinate or a body as a whole, or have a law or a value.
fn needs_motion(action: &Action) -> bool {
    let own = match &action.kind {
        ActionKind::Force { value, .. } | ActionKind::Torque { value, .. } => value.is_some(),
        ActionKind::Gravity { .. } | ActionKind::Attraction { .. } => true,
        ActionKind::Dashpot { law } => !matches!(law, Law::Linear(_)),
        _ => false,
    };
    // A point that a vector says may move on its body.
    own || matches!(&action.on, On::Between(..))
        || matches!(&action.on, On::On(e) if matches!(e.kind, ExprKind::Method(..)))
}

/// The word of an element with its article.
fn kind_word(kind: &ActionKind) -> &'static str {
    match kind {
        ActionKind::Spring { .. } => "a Spring",
        ActionKind::Dashpot { .. } => "a Dashpot",
        ActionKind::Inerter { .. } => "an Inerter",
        ActionKind::Friction { .. } => "a Friction",
        ActionKind::Gravity { .. } => "a Gravity",
        ActionKind::Attraction { .. } => "an Attraction",
        ActionKind::Force { .. } => "a Force",
        ActionKind::Torque { .. } => "a Torque",
    }
}
