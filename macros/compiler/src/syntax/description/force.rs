//! Force elements and inputs.

use super::{BinaryOp, Expr, Name};
use crate::diag::Place;

/// A force element or an input.
#[derive(Clone, Debug)]
pub struct Action {
    /// Its name; an input's name is its entry in `INPUTS`.
    pub name: Name,
    /// What it is, with its parameters.
    pub kind: ActionKind,
    /// What it acts on.
    pub on: Target,
}

/// What a file says of springs, dampers, rotors and motors.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Its name; an input's name is its entry in `INPUTS`.
    pub name: Name,
    /// What it acts on.
    pub on: DriveOn,
    /// What it does.
    pub law: DriveLaw,
}

/// What a force element of a file acts on.
#[derive(Clone, Debug)]
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

/// How a spring or a dashpot answers.
#[derive(Clone, Debug)]
pub enum Law {
    /// In proportion, with this coefficient.
    Linear(Expr),
    /// With this force, an expression of `stretch` (spring) or `speed` (dashpot).
    Force(Expr),
    /// With the force that follows from this energy, an expression of `stretch`.
    Energy(Expr),
}

/// The force elements of the language.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there are few of them, and they are not moved")]
pub enum ActionKind {
    /// A spring: on a coordinate, or between two points.
    Spring {
        /// Stiffness, force or energy.
        law: Law,
        /// Coordinate or length at which the force is zero; true if it is given as an angle.
        free: Option<(Expr, bool)>,
    },
    /// A dashpot: on a coordinate, or between two points.
    Dashpot {
        /// Damping coefficient or force.
        law: Law,
    },
    /// An inerter: a force in proportion to the relative acceleration.
    Inerter {
        /// Inertance.
        inertance: Expr,
    },
    /// Dry and viscous friction on a coordinate.
    Friction {
        /// Force of sliding friction.
        coulomb: Expr,
        /// Force at breakaway.
        stiction: Option<Expr>,
        /// Speed at which the force has fallen from breakaway to sliding.
        stribeck_speed: Option<Expr>,
        /// Viscous coefficient.
        viscous: Option<Expr>,
        /// Speed of the regularisation.
        speed: Option<Expr>,
    },
    /// Central gravity between two bodies, or towards a fixed point.
    Gravity {
        /// Gravitational constant, for two bodies with mass.
        constant: Option<Expr>,
        /// Gravitational parameter of the attracting one.
        mu: Option<Expr>,
    },
    /// Inverse-square attraction of the given strength (repulsion if negative).
    Attraction {
        /// Force times distance squared.
        strength: Expr,
    },
    /// A force: on a sliding coordinate, or on a body; without a value an input.
    Force {
        /// Direction of an input on a body.
        along: Option<Expr>,
        /// Its value.
        value: Option<Expr>,
    },
    /// A torque: on a turning coordinate, or on a body; without a value an input.
    Torque {
        /// Direction of an input on a body.
        about: Option<Expr>,
        /// Its value.
        value: Option<Expr>,
    },
}

impl ActionKind {
    /// The expressions of a force element, with the names of their arguments.
    pub fn expressions(&self) -> Vec<(&'static str, &Expr)> {
        let law = |law: &Law, linear: &'static str| match law {
            Law::Linear(_) => linear,
            Law::Force(_) => "force",
            Law::Energy(_) => "energy",
        };
        match self {
            ActionKind::Spring { law: given, free } => {
                let (Law::Linear(e) | Law::Force(e) | Law::Energy(e)) = given;
                let free =
                    free.iter().map(|(e, angle)| (if *angle { "free_angle" } else { "free_length" }, e));
                [(law(given, "stiffness"), e)].into_iter().chain(free).collect()
            }
            ActionKind::Dashpot { law: given } => {
                let (Law::Linear(e) | Law::Force(e) | Law::Energy(e)) = given;
                vec![(law(given, "damping"), e)]
            }
            ActionKind::Inerter { inertance } => vec![("inertance", inertance)],
            ActionKind::Friction { coulomb, stiction, stribeck_speed, viscous, speed } => {
                let others = [
                    ("stiction", stiction),
                    ("stribeck_speed", stribeck_speed),
                    ("viscous", viscous),
                    ("speed", speed),
                ];
                let others = others.into_iter().filter_map(|(word, e)| Some((word, e.as_ref()?)));
                [("coulomb", coulomb)].into_iter().chain(others).collect()
            }
            ActionKind::Gravity { constant, mu } => {
                let both = [("constant", constant), ("mu", mu)];
                both.into_iter().filter_map(|(word, e)| Some((word, e.as_ref()?))).collect()
            }
            ActionKind::Attraction { strength } => vec![("strength", strength)],
            ActionKind::Force { along: direction, value } => {
                let both = [("along", direction), ("value", value)];
                both.into_iter().filter_map(|(word, e)| Some((word, e.as_ref()?))).collect()
            }
            ActionKind::Torque { about: direction, value } => {
                let both = [("about", direction), ("value", value)];
                both.into_iter().filter_map(|(word, e)| Some((word, e.as_ref()?))).collect()
            }
        }
    }
}
