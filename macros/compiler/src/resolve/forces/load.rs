//! Applied forces and torques: with a value, or as inputs.

use crate::diag::Diagnostics;
use crate::expr::{Function, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::{Direction, Input, Load, Pose, Quantity};
use crate::resolve::builder::Builder;
use crate::resolve::scope::{Allowed, Context, Placed, PlacedKind};
use crate::resolve::target::Target;
use crate::syntax::{Action, Expr, ExprKind, Key, Target as On};

impl<'g> Builder<'_, 'g> {
    /// Adds a force or a torque, with a value or as an input.
    pub(super) fn add_acting(&mut self, action: &Action, cx: &mut Diagnostics) {
        let torque = action.kind.row().torque;
        let direction = action.get(if torque { Key::About } else { Key::Along });
        match (&action.on, action.get(Key::Value)) {
            (On::On(on), None) => {
                let target = self.target(on, cx);
                self.add_input(action, on, target, direction, torque, cx);
            }
            (On::On(on), Some(value)) => self.add_value(on, direction, value, torque, cx),
            (On::Between(a, b), value) => self.add_force_between(action, [a, b], direction, value, cx),
        }
    }

    /// Adds a force or torque with a value.
    fn add_value(
        &mut self,
        on: &Expr,
        direction: Option<&Expr>,
        value: &Expr,
        torque: bool,
        cx: &mut Diagnostics,
    ) {
        if let Some(direction) = direction {
            cx.error(direction.place.clone(), "a value has a direction of its own")
                .help("write the direction into the value: `value = magnitude * x`");
            return;
        }
        let place = match self.target(on, cx) {
            Some(Target::Point(place)) => place,
            Some(Target::Coordinate(c, angle)) => {
                if let Some(angle) = angle.filter(|angle| *angle != torque) {
                    report_wrong_kind(on, angle, cx);
                    return;
                }
                let ground = Some((None, Pose::identity(self.scope.graph)));
                let context = Context::new(Allowed::Acceleration, ground);
                if let Some(force) = self.scope.in_context(context, |scope| scope.scalar(value, cx)) {
                    let rate = self.coordinate_stretch(&c).rate;
                    self.add_value_load(rate, force, &value.place, cx);
                }
                return;
            }
            Some(Target::Expression(stretch)) => {
                let ground = Some((None, Pose::identity(self.scope.graph)));
                let context = Context::new(Allowed::Acceleration, ground);
                if let Some(force) = self.scope.in_context(context, |scope| scope.scalar(value, cx)) {
                    self.add_value_load(stretch.rate, force, &value.place, cx);
                }
                return;
            }
            None => return,
        };
        if torque && !check_torque_target(on, &place, cx) {
            return;
        }
        let Some(link) = place.link else {
            cx.error(on.place.clone(), "this is fixed to the ground: nothing that acts on it has an effect");
            return;
        };
        let context = Context::new(Allowed::Acceleration, Some((place.link, place.pose.clone())));
        let Some(terms) = self.scope.in_context(context, |scope| scope.terms(value, cx)) else { return };
        let kinematics = &self.scope.kinematics;
        let zero = Vec3::zero(self.scope.graph);
        let force = kinematics.resolve(&terms, place.link, zero);
        let twist = kinematics.twists[link.0];
        let rate = match torque {
            true => twist.angular,
            false => twist.linear + twist.angular.cross(place.pose.translation),
        };
        self.add_load(rate, force, &value.place, cx);
    }

    /// Adds a force along the line between two points, with a value or as an input. A positive force
    /// separates the points.
    fn add_force_between(
        &mut self,
        action: &Action,
        [a, b]: [&Expr; 2],
        along: Option<&Expr>,
        value: Option<&Expr>,
        cx: &mut Diagnostics,
    ) {
        if let Some(along) = along {
            cx.error(along.place.clone(), "a force between two points acts along their line")
                .help("remove this argument, or let a force act on each of two bodies");
        }
        let Some(stretch) = self.distance(a, b, cx) else { return };
        let rate = match stretch.signed {
            true => stretch.value.call(Function::Signum) * stretch.rate,
            false => stretch.rate,
        };
        let g = self.scope.graph;
        let Some(value) = value else {
            self.add_input_load(&action.name.text, rate);
            return;
        };
        let context = Context::new(Allowed::Acceleration, Some((None, Pose::identity(g))));
        if let Some(force) = self.scope.in_context(context, |scope| scope.scalar(value, cx)) {
            self.add_value_load(rate, force, &value.place, cx);
        }
    }

    /// Adds an input on a coordinate, an expression, or a point of a body.
    fn add_input(
        &mut self,
        action: &Action,
        on: &Expr,
        target: Option<Target<'g>>,
        direction: Option<&Expr>,
        torque: bool,
        cx: &mut Diagnostics,
    ) {
        let Some(target) = target else { return };
        let input = match target {
            Target::Coordinate(_, Some(angle)) if angle != torque => return report_wrong_kind(on, angle, cx),
            Target::Coordinate(c, _) => {
                if let Some(direction) = direction {
                    cx.error(direction.place.clone(), "the joint itself gives the direction")
                        .help("remove this argument, or let it act on a body");
                }
                Input::Coordinate(c)
            }
            Target::Expression(stretch) => {
                if let Some(direction) = direction {
                    cx.error(direction.place.clone(), "the expression itself gives the direction")
                        .help("remove this argument, or let it act on a body");
                }
                return self.add_input_load(&action.name.text, stretch.rate);
            }
            Target::Point(place) if is_moving(place.pose.translation) => {
                return self.add_moving_input(action, on, &place, direction, torque, cx);
            }
            Target::Point(place) => match self.point_input(action, on, &place, direction, torque, cx) {
                Some(input) => input,
                None => return,
            },
        };
        self.set_input(&action.name.text, input);
    }

    /// Stores an input at its index in the order of declaration.
    fn set_input(&mut self, name: &str, input: Input<'g>) {
        if let Some((_, slot)) = self.model.inputs.iter_mut().find(|(known, _)| known == name) {
            *slot = input;
        }
    }

    /// Adds an input as a force on a rate.
    pub fn add_input_load(&mut self, name: &str, rate: crate::expr::Expr<'g>) {
        let input = self.model.inputs.iter().position(|(known, _)| known == name);
        if let Some(k) = input {
            let force = Quantity::Input(k).expr(self.scope.graph);
            self.model.loads.push(Load { rate, force, dissipative: false });
        }
    }

    /// Adds an input at a point that moves on its body.
    fn add_moving_input(
        &mut self,
        action: &Action,
        on: &Expr,
        place: &Placed<'g>,
        direction: Option<&Expr>,
        torque: bool,
        cx: &mut Diagnostics,
    ) {
        let Some(Input::Force { link, point, along }) =
            self.point_input(action, on, place, direction, torque, cx)
        else {
            return;
        };
        let kinematics = &self.scope.kinematics;
        let twist = &kinematics.twists[link.0];
        let along = kinematics.resolve(&along, Some(link), Vec3::zero(self.scope.graph));
        let rate = (twist.linear + twist.angular.cross(point)).dot(along);
        self.add_input_load(&action.name.text, rate);
    }

    fn point_input(
        &self,
        action: &Action,
        on: &Expr,
        place: &Placed<'g>,
        direction: Option<&Expr>,
        torque: bool,
        cx: &mut Diagnostics,
    ) -> Option<Input<'g>> {
        let Some(direction) = direction else {
            let key = if torque { "about" } else { "along" };
            cx.error(action.name.place.clone(), format!("missing `{key}`"))
                .help(format!("on a body it needs a direction: `{key} = x`, `{key} = ground.z`"));
            return None;
        };
        if torque && !check_torque_target(on, place, cx) {
            return None;
        }
        let context = Context::new(Allowed::Constant, Some((place.link, place.pose.clone())));
        let terms = self.scope.in_context(context, |scope| scope.terms(direction, cx))?;
        let Some(link) = place.link else {
            cx.error(
                on.place.clone(),
                "this body is fixed to the ground: nothing that acts on it has an effect",
            )
            .help("name a body that moves");
            return None;
        };
        let sum: Direction<'g> = terms;
        if sum.iter().all(|(_, v)| v.is_zero()) {
            cx.error(direction.place.clone(), "this direction is zero")
                .help("write `x`, `y`, `z` or another vector of some length");
            return None;
        }
        Some(match torque {
            true => Input::Torque { link, about: sum },
            false => Input::Force { link, point: place.pose.translation, along: sum },
        })
    }
}

/// Whether a vector depends on the configuration or on time.
fn is_moving(v: Vec3<'_>) -> bool {
    let moves = |s| matches!(Quantity::of(s), Quantity::Configuration(_) | Quantity::Time);
    symbols_in(&v.0).into_iter().any(moves)
}

/// Whether a torque can act on an element; reports particles and points, which have no rotation.
fn check_torque_target(on: &Expr, place: &Placed<'_>, cx: &mut Diagnostics) -> bool {
    let ExprKind::Name(name) = &on.kind else { return true };
    if place.kind == PlacedKind::Point {
        cx.error(on.place.clone(), format!("`{name}` is a point, which a torque does not turn"))
            .help("let it act on a body, or write a `Force`");
        return false;
    }
    true
}

fn report_wrong_kind(on: &Expr, angle: bool, cx: &mut Diagnostics) {
    let (is, other) = if angle { ("an angle", "Torque") } else { ("a length", "Force") };
    cx.error(on.place.clone(), format!("this coordinate is {is}"))
        .help(format!("what acts on it is a {other}"));
}
