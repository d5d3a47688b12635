//! Force elements and inputs.

use super::{BinaryOp, Expr, Name};
use crate::diag::Place;
use crate::language::{ForceKind, Key};

/// A force element or an input.
#[derive(Clone, Debug)]
pub struct Action {
    /// Name of the element; that of an input is its entry in `INPUTS`.
    pub name: Name,
    /// Row in the table of force elements.
    pub kind: ForceKind,
    /// Coordinate, body or points that the element acts on.
    pub on: Target,
    /// The arguments that are given.
    pub arguments: Vec<(Key, Expr)>,
}

/// What a file says of springs, dampers, rotors and motors.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Name of the element; that of an input is its entry in `INPUTS`.
    pub name: Name,
    /// What it acts on.
    pub on: DriveOn,
    /// What it does.
    pub law: DriveLaw,
}

/// What a force element of a file acts on.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there are few of them, and they are not moved")]
pub enum DriveOn {
    /// A weighted sum of coordinates: the joints with their weights; each has one coordinate.
    Sum(Vec<(Name, f64)>),
    /// A length that the coordinates give, such as that of a cable.
    Length(Expr),
    /// What a force at a point and a torque work on; it has a rate, and its value is zero.
    Wrench(Wrench),
}

/// A force at a point of a body and a torque on it, for each newton of what drives them.
#[derive(Clone, Debug)]
pub struct Wrench {
    /// The point, `body.at(vector)`.
    pub on: Expr,
    /// The force, in axes of the body, or of that which the reaction is on.
    pub force: [f64; 3],
    /// The torque, in the same axes.
    pub torque: [f64; 3],
    /// The point of a body that the reaction is on, if that is not the ground.
    pub against: Option<Expr>,
}

impl DriveOn {
    /// What a drive works on, with all weights times a factor.
    pub fn scaled(&self, factor: f64) -> DriveOn {
        match self {
            DriveOn::Sum(terms) => {
                DriveOn::Sum(terms.iter().map(|(joint, weight)| (joint.clone(), weight * factor)).collect())
            }
            DriveOn::Length(e) if factor == 1.0 => DriveOn::Length(e.clone()),
            DriveOn::Length(e) => {
                DriveOn::Length(Expr::binary(BinaryOp::Mul, Expr::number(factor, &e.place), e.clone()))
            }
            DriveOn::Wrench(wrench) => DriveOn::Wrench(Wrench {
                force: wrench.force.map(|x| x * factor),
                torque: wrench.torque.map(|x| x * factor),
                ..wrench.clone()
            }),
        }
    }

    /// The joints of a sum with their weights; none of anything else.
    pub fn terms(&self) -> &[(Name, f64)] {
        match self {
            DriveOn::Sum(terms) => terms,
            DriveOn::Length(_) | DriveOn::Wrench(_) => &[],
        }
    }
}

/// How a force element of a file answers to what it is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveLaw {
    /// With a force in proportion to what the sum differs from a free length.
    Spring {
        /// Stiffness.
        stiffness: f64,
        /// Where the force is zero.
        free: f64,
    },
    /// With a force in proportion to what the sum is outside of a range.
    Slack {
        /// Stiffness.
        stiffness: f64,
        /// The ends of the range.
        range: [f64; 2],
    },
    /// With a force against its rate, in proportion to that.
    Damper(f64),
    /// With a force against its rate, of this size.
    Friction(f64),
    /// With a force against its acceleration, in proportion to that.
    Inerter(f64),
    /// With this force always.
    Push(f64),
    /// With the force that an input says; the input's unit.
    Input(&'static str),
}

/// What a force element acts on.
#[derive(Clone, Debug)]
pub enum Target {
    /// `joint`, `joint.coordinate`, `body`, `body.at(vector)`, `point`.
    On(Expr),
    /// Two points: of bodies, or named ones.
    Between(Expr, Expr),
}

impl Target {
    /// Where it stands.
    pub fn place(&self) -> &Place {
        match self {
            Target::On(e) | Target::Between(_, e) => &e.place,
        }
    }
}

impl Action {
    /// Returns the expression of an argument.
    pub fn get(&self, key: Key) -> Option<&Expr> {
        self.arguments.iter().find(|(known, _)| *known == key).map(|(_, e)| e)
    }

    /// Returns the law that is given, with its argument.
    pub fn law(&self) -> Option<(Key, &Expr)> {
        let laws = self.kind.row().laws;
        self.arguments.iter().find(|(key, _)| laws.contains(key)).map(|(key, e)| (*key, e))
    }

    /// True for a force or a torque without a value: an entry of `u` commands it.
    pub fn is_input(&self) -> bool {
        self.kind.row().arguments.contains(&Key::Value) && self.get(Key::Value).is_none()
    }
}
