//! Force elements and inputs of a file: each on a weighted sum of coordinates.

use super::builder::Builder;
use super::motion::Moving;
use super::terms::Stretch;
use crate::diag::Diagnostics;
use crate::mechanism::{Coordinate, CoulombFriction, Dashpot, Input, Spring};
use crate::syntax::{Description, Drive, DriveLaw, Expr, Law};

/// Those that are inputs, in their order in `u`: after the driven joints, before all others.
pub fn inputs(d: &Description) -> impl Iterator<Item = &Drive> {
    d.drives.iter().filter(|drive| matches!(drive.law, DriveLaw::Input(_)))
}

impl<'g> Builder<'_, 'g> {
    /// Adds them all.
    pub fn add_drives(&mut self, _: Moving, cx: &mut Diagnostics) {
        for drive in &self.description.drives {
            self.add_drive(drive, cx);
        }
    }

    fn add_drive(&mut self, drive: &Drive, cx: &mut Diagnostics) {
        let terms: Vec<Coordinate> =
            drive.terms.iter().filter_map(|(joint, weight)| self.weighted(&joint.text, *weight)).collect();
        if let DriveLaw::Input(unit) = drive.law {
            self.model.inputs.push((drive.name.text.clone(), Input::Sum(terms, unit)));
            return;
        }
        if let [on] = terms.as_slice()
            && self.add_to_coordinate(*on, drive.law)
        {
            return;
        }
        let stretch = self.sum_stretch(&terms);
        let place = &drive.name.place;
        let number = |value| Expr::number(value, place);
        match drive.law {
            DriveLaw::Spring { stiffness, free } => {
                let free = self.scope.graph.num(free);
                self.add_spring(stretch, &Law::Linear(number(stiffness)), free, cx);
            }
            DriveLaw::Damper(damping) => self.add_dashpot(&stretch, &Law::Linear(number(damping)), cx),
            DriveLaw::Friction(force) => {
                self.add_friction(&stretch, [Some(&number(force)), None, None, None, None], place, cx);
            }
            DriveLaw::Inerter(inertance) => self.add_inerter(&stretch, &number(inertance), cx),
            DriveLaw::Push(force) => {
                let force = self.scope.graph.num(force);
                self.add_value_load(stretch.rate, force, place, cx);
            }
            DriveLaw::Input(_) => {}
        }
    }

    /// The coordinate of a joint with one, times a weight.
    fn weighted(&self, joint: &str, weight: f64) -> Option<Coordinate> {
        match self.joint_coordinates(joint)?.as_slice() {
            [(_, c, _)] => Some(Coordinate { ratio: weight * c.ratio, offset: weight * c.offset, ..*c }),
            _ => None,
        }
    }

    /// What the model has for single coordinates; false for everything else. A [`Coordinate`] with its ratio is the sum itself.
    fn add_to_coordinate(&mut self, on: Coordinate, law: DriveLaw) -> bool {
        let g = self.scope.graph;
        match law {
            DriveLaw::Spring { stiffness, free } => {
                self.model.springs.push(Spring { on, stiffness: g.num(stiffness), free: g.num(free) });
            }
            DriveLaw::Damper(damping) => self.model.dashpots.push(Dashpot { on, damping: g.num(damping) }),
            DriveLaw::Friction(force) => {
                self.model.frictions.push(CoulombFriction { on, friction: g.num(force) });
            }
            _ => return false,
        }
        true
    }

    /// The stretch of a sum of coordinates.
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
