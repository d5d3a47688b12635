//! Force elements and inputs of a file: on a weighted sum of coordinates, on a length, or at a point of a
//! body.

use super::builder::Builder;
use super::element_forces::Forces;
use super::forces::{
    Law, dry_friction, inertance_force, input_load, report_unused_input, spring_law, value_load,
};
use super::motion::Moving;
use super::scope::{Allowed, Context};
use super::terms::Stretch;
use crate::diag::Diagnostics;
use crate::expr::{Expr as Value, Extreme, Function, Vec3};
use crate::kinematics::{time_derivative, velocity_gradient};
use crate::mechanism::{Coordinate, CoulombFriction, Dashpot, Input, Pose, Quantity, Spring};
use crate::syntax::{Description, Drive, DriveLaw, DriveOn, DriveQuantity, Expr, Wrench};

/// Returns the inputs among the force elements of a file, in the order of their entries in `u`. These entries
/// follow those of the driven joints and precede all others.
pub fn input_drives(d: &Description) -> impl Iterator<Item = &Drive> {
    d.drives.iter().filter(|drive| matches!(drive.law, DriveLaw::Input(_)))
}

impl<'g> Builder<'_, 'g> {
    /// Adds all force elements and inputs of a robot file to the model.
    pub fn add_drives(&mut self, _: Moving, cx: &mut Diagnostics) {
        for drive in &self.description.drives {
            self.add_drive(drive, cx);
        }
    }

    fn add_drive(&mut self, drive: &Drive, cx: &mut Diagnostics) {
        let mut terms: Vec<Coordinate> = Vec::new();
        for (joint, weight) in drive.on.weighted_joints() {
            match self.weighted_coordinate(&joint.text, *weight) {
                Some(coordinate) => terms.push(coordinate),
                None => report_unused_input(&drive.name, cx),
            }
        }
        if let DriveLaw::Input(unit) = drive.law {
            let input = Quantity::Input(self.model.inputs.len()).expr(self.scope.graph);
            self.name_quantity(DriveQuantity::Input, drive, input);
            self.model.inputs.push((drive.name.text.clone(), Input::Sum(terms.clone(), unit)));
        }
        if let DriveLaw::Expression { offset, .. } = drive.law {
            let stretch = self.stretch_of_drive(&drive.on, &terms, cx);
            let zero = self.scope.graph.zero();
            let [length, rate] = stretch.map_or([zero; 2], |stretch| [stretch.value, stretch.rate]);
            self.name_quantity(DriveQuantity::Length, drive, length + self.scope.graph.num(offset));
            self.name_quantity(DriveQuantity::Rate, drive, rate);
        }
        let forces = self.drive_forces(drive, &terms, cx);
        forces.into_iter().for_each(|forces| forces.add_to(&mut self.model));
    }

    /// Gives a quantity of an element its name in expressions of the file.
    fn name_quantity(&mut self, quantity: DriveQuantity, drive: &Drive, value: Value<'g>) {
        self.scope.kinematics.drive_quantities.insert(quantity.name_for(&drive.name.text), value);
    }

    /// Returns the length or wrench on which an element acts.
    fn stretch_of_drive(
        &self,
        on: &DriveOn,
        terms: &[Coordinate],
        cx: &mut Diagnostics,
    ) -> Option<Stretch<'g>> {
        match on {
            DriveOn::Sum(_) => Some(self.sum_stretch(terms)),
            DriveOn::Length(e) => self.stretch_of(e, cx),
            DriveOn::Wrench(wrench) => self.wrench_stretch(wrench, cx),
        }
    }

    /// Returns the forces of an element; `None` without an effect.
    fn drive_forces(&self, drive: &Drive, terms: &[Coordinate], cx: &mut Diagnostics) -> Option<Forces<'g>> {
        let (place, g) = (&drive.name.place, self.scope.graph);
        let on = if let [on] = terms { Some(*on) } else { None };
        // The ratio of the coordinate is the weight.
        match (on, &drive.law) {
            (Some(on), &DriveLaw::Spring { stiffness, free }) => {
                let springs = vec![Spring { on, stiffness: g.num(stiffness), free: g.num(free) }];
                return Some(Forces { springs, ..Forces::default() });
            }
            (Some(on), &DriveLaw::Damper(damping)) => {
                let dashpots = vec![Dashpot { on, damping: g.num(damping) }];
                return Some(Forces { dashpots, ..Forces::default() });
            }
            (Some(on), &DriveLaw::Friction(force)) => {
                let frictions = vec![CoulombFriction { on, friction: g.num(force) }];
                return Some(Forces { frictions, ..Forces::default() });
            }
            _ => {}
        }
        // A force on a constant length has no effect.
        if let (DriveOn::Sum(_), DriveLaw::Input(_)) = (&drive.on, &drive.law) {
            return None;
        }
        let stretch = self.stretch_of_drive(&drive.on, terms, cx)?;
        if velocity_gradient(stretch.rate).is_empty() {
            return None;
        }
        let number_expression = |value| Expr::number_at(value, place);
        match drive.law {
            DriveLaw::Spring { stiffness, free } => {
                spring_law(self, stretch, &Law::Linear(&number_expression(stiffness)), g.num(free), cx)
            }
            DriveLaw::Slack { stiffness, range: [low, high] } => {
                let short = (stretch.value - g.num(low)).minimum_or_maximum(Extreme::Min, g.zero());
                let long = (stretch.value - g.num(high)).minimum_or_maximum(Extreme::Max, g.zero());
                let excess = if low == high { stretch.value - g.num(low) } else { short + long };
                let [first, second, third] = stiffness.map(|k| g.num(k));
                let cubic = second * (1.0 / 3.0) + third * 0.25 * excess;
                Some(Forces::of_potentials([excess.square() * (first * 0.5 + cubic * excess)]))
            }
            DriveLaw::PolynomialDamper(damping) => {
                let [first, second, third] = damping.map(|c| g.num(c));
                let speed = stretch.rate.apply_function(Function::Abs);
                let factor = first + (second + third * speed) * speed;
                Some(Forces::resisting_force(stretch.rate, factor * stretch.rate))
            }
            DriveLaw::Damper(damping) => {
                let damping = self.scope.resolve_scalar(&number_expression(damping), cx)?;
                Some(Forces::resisting_force(stretch.rate, damping * stretch.rate))
            }
            DriveLaw::Friction(force) => dry_friction(
                self,
                stretch.rate,
                [Some(&number_expression(force)), None, None, None, None],
                place,
                cx,
            ),
            DriveLaw::Inerter(value) => inertance_force(self, stretch.rate, &number_expression(value), cx),
            DriveLaw::Push(force) => value_load(self, stretch.rate, g.num(force), place, cx),
            DriveLaw::Input(_) => input_load(self, &drive.name.text, stretch.rate),
            DriveLaw::Expression { ref force, .. } => {
                let context = Context::new(Allowed::Motion, Some((None, Pose::identity(g))));
                let force = self.scope.in_context(context, |scope| scope.resolve_scalar(force, cx))?;
                value_load(self, stretch.rate, force, place, cx)
            }
        }
    }

    /// Returns the rate on which a force and a torque at a point do work, `f · v + t · ω`. The velocities are
    /// relative to the body on which the reaction acts, if there is one.
    fn wrench_stretch(&self, wrench: &Wrench, cx: &mut Diagnostics) -> Option<Stretch<'g>> {
        let g = self.scope.graph;
        let on = self.scope.resolve_placement(&wrench.on, cx)?;
        let against = match &wrench.against {
            Some(against) => Some(self.scope.resolve_placement(against, cx)?),
            None => None,
        };
        let axes = against.as_ref().unwrap_or(&on);
        let [force, torque] = [wrench.force, wrench.torque]
            .map(|vector| axes.pose.rotation.to_parent(Vec3::from_numbers(g, vector)));
        let kinematics = &self.scope.kinematics;
        let rate = match &against {
            None => on.link.map_or(g.zero(), |link| {
                let twist = &kinematics.twists[link.0];
                let at = twist.linear + twist.angular.cross(on.pose.translation);
                at.dot(force) + twist.angular.dot(torque)
            }),
            Some(against) => {
                let zero = Vec3::zero(g);
                let between = kinematics.position_between(&on, against);
                let path = kinematics.resolve(&between, against.link, zero).dot(force);
                let turning = kinematics.angular_velocity_in(on.link, against.link, g);
                let turning = kinematics.resolve(&turning, against.link, zero).dot(torque);
                time_derivative(self.model.configuration_space(), path) + turning
            }
        };
        Some(Stretch { value: g.zero(), rate, square: g.zero(), signed: false })
    }

    /// Returns the coordinate of a joint with one degree of freedom, multiplied by a weight.
    fn weighted_coordinate(&self, joint: &str, weight: f64) -> Option<Coordinate> {
        match self.joint_coordinates(joint)?.as_slice() {
            [(_, c, _)] => Some(Coordinate { ratio: weight * c.ratio, offset: weight * c.offset, ..*c }),
            _ => None,
        }
    }

    /// Returns the stretch of a weighted sum of coordinates.
    fn sum_stretch(&self, terms: &[Coordinate]) -> Stretch<'g> {
        let zero = self.scope.graph.zero();
        let mut sum = Stretch { value: zero, rate: zero, square: zero, signed: false };
        for c in terms {
            let one = self.coordinate_stretch(c);
            (sum.value, sum.rate) = (sum.value + one.value, sum.rate + one.rate);
        }
        sum.square = sum.value.square();
        sum
    }
}
