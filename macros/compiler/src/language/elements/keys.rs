//! Arguments of elements, and conditions on which of them are given together.

use super::super::dimension::{ATTRACTION, Dimension, GRAVITATION, LENGTH, PLAIN, SLOWNESS, STRENGTH};
use ArgumentQuantity::{
    Coordinate, Damping, Direction, Energy, Fixed, Force, HertzStiffness, Inertance, Load, Speed, Stiffness,
};

/// Row of the table of arguments.
#[derive(Debug)]
pub struct KeyRow {
    /// Name of the argument.
    pub name: &'static str,
    /// Names in other tools; the elements list them.
    pub synonyms: &'static str,
    /// Quantity that the argument expects.
    pub quantity: ArgumentQuantity,
}

/// A quantity of an element. Its dimension follows from the coordinate or the distance on which the element
/// acts.
#[derive(Debug)]
pub enum ArgumentQuantity {
    /// Stiffness: force per displacement.
    Stiffness,
    /// Force by displacement to the power of 3/2.
    HertzStiffness,
    /// Damping: force per velocity.
    Damping,
    /// Inertance: force per acceleration.
    Inertance,
    /// A force or a torque.
    Force,
    /// Energy of the element.
    Energy,
    /// Coordinate or distance on which the element acts.
    Coordinate,
    /// Rate of the coordinate or distance on which the element acts.
    Speed,
    /// Quantity of this dimension, with the text of its unit (empty for the default).
    Fixed(Dimension, &'static str),
    /// Direction of a force or a torque on a body.
    Direction,
    /// Value of a force or a torque; without it the element is an input.
    Load,
}

const fn key_row(name: &'static str, quantity: ArgumentQuantity) -> KeyRow {
    KeyRow { name, synonyms: "", quantity }
}

table! {
    /// An argument of a force element, a contact, a limit or a pair of slipping surfaces.
    Key: KeyRow {
        /// Stiffness of a spring.
        Stiffness = key_row("stiffness", Stiffness);
        /// Force, as an expression of the stretch or the speed.
        Force = key_row("force", Force);
        /// Energy, as an expression of the stretch.
        Energy = key_row("energy", Energy);
        /// Length at which the force of a spring is zero.
        FreeLength = key_row("free_length", Coordinate);
        /// Angle at which the torque of a spring is zero.
        FreeAngle = key_row("free_angle", Coordinate);
        /// Coefficient of a dashpot.
        Damping = key_row("damping", Damping);
        /// Inertance of an inerter.
        Inertance = key_row("inertance", Inertance);
        /// Force of sliding friction.
        Coulomb = key_row("coulomb", Force);
        /// Force at breakaway.
        Stiction = key_row("stiction", Force);
        /// Speed at which the force has fallen from breakaway to sliding.
        StribeckSpeed = key_row("stribeck_speed", Speed);
        /// Viscous coefficient.
        Viscous = key_row("viscous", Damping);
        /// Speed of the regularisation.
        Speed = key_row("speed", Speed);
        /// Gravitational constant, for two bodies with mass.
        Constant = key_row("constant", Fixed(GRAVITATION, ""));
        /// Gravitational parameter of the attracting body.
        Mu = key_row("mu", Fixed(ATTRACTION, ""));
        /// Force times the square of the distance.
        Strength = key_row("strength", Fixed(STRENGTH, ""));
        /// Coefficient of friction while surfaces slide.
        Friction = key_row("friction", PLAIN_NUMBER);
        /// Coefficient of friction at rest.
        StaticFriction = key_row("stiction", PLAIN_NUMBER);
        /// Maximum friction moment about the normal per unit normal force.
        TorsionalFriction = key_row("torsional", METERS);
        /// Maximum friction moment about the tangents per unit normal force.
        RollingFriction = key_row("rolling", METERS);
        /// Coefficient of restitution: `e`, a ratio of velocities, or `poisson(e)`, a ratio of impulses.
        Restitution = key_row("restitution", PLAIN_NUMBER);
        /// Stiffness of round bodies (Hertz).
        Hertz = key_row("hertz", HertzStiffness);
        /// Dissipation per speed of approach (Hunt and Crossley).
        Dissipation = key_row("dissipation", Fixed(SLOWNESS, "s/m"));
        /// Lower bound of a limit.
        From = key_row("from", Coordinate);
        /// Upper bound of a limit.
        To = key_row("to", Coordinate);
        /// Maximum speed, in both directions.
        MaxSpeed = key_row("max_speed", Speed);
        /// Maximum force or torque, in both directions.
        MaxEffort = key_row("max_effort", Force);
        /// Direction of a force on a body.
        Along = key_row("along", Direction);
        /// Direction of a torque on a body.
        About = key_row("about", Direction);
        /// Value of a force or a torque.
        Value = key_row("value", Load);
    }
}

const PLAIN_NUMBER: ArgumentQuantity = Fixed(PLAIN, "1");
const METERS: ArgumentQuantity = Fixed(LENGTH, "m");

/// A condition on which arguments are given together.
#[derive(Debug)]
pub struct Relation {
    /// Argument at which a violation is reported.
    pub key: Key,
    /// True if the argument needs one of the others, false if it excludes them.
    pub needs: bool,
    /// Arguments to which the condition refers.
    pub others: &'static [Key],
    /// The error; `NAME` is the name of the element.
    pub message: &'static str,
    /// Help that the error message gives.
    pub help: &'static str,
}

impl Relation {
    /// Returns the condition that an argument is not given together with others.
    pub const fn exclusion_relation(
        key: Key,
        others: &'static [Key],
        message: &'static str,
        help: &'static str,
    ) -> Relation {
        Relation { key, needs: false, others, message, help }
    }

    /// Returns the condition that an argument is given together with one of the others.
    pub const fn requirement_relation(
        key: Key,
        others: &'static [Key],
        message: &'static str,
        help: &'static str,
    ) -> Relation {
        Relation { key, needs: true, others, message, help }
    }
}
