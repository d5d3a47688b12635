//! Force elements and inputs.

use super::{Expr, Name};
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

/// What a file says of springs, dampers, rotors and motors: a force element on a weighted sum of coordinates.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Its name; an input's name is its entry in `INPUTS`.
    pub name: Name,
    /// The joints with their weights; each has one coordinate.
    pub terms: Vec<(Name, f64)>,
    /// What it does.
    pub law: DriveLaw,
}

/// How a force element of a file answers to the sum of coordinates that it is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveLaw {
    /// With a force in proportion to what the sum differs from a free length.
    Spring {
        /// Stiffness.
        stiffness: f64,
        /// Where the force is zero.
        free: f64,
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
