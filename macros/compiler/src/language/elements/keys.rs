//! Arguments of elements, and conditions on which of them are given together.

use super::super::dimension::{ATTRACTION, Dimension, GRAVITATION, LENGTH, PLAIN, SLOWNESS, STRENGTH};
use ArgumentQuantity::{
    Coordinate, Damping, Direction, Energy, Fixed, Force, HertzStiffness, Inertance, Load, Speed, Stiffness,
};

/// Row of the table of arguments of elements.
#[derive(Debug)]
pub struct KeyRow {
    /// Name of the element's argument.
    pub name: &'static str,
    /// Names of the argument in other tools; the rows of the elements list them.
    pub synonyms: &'static str,
    /// Quantity that the element's argument expects.
    pub quantity: ArgumentQuantity,
}

/// A quantity of an element. Its dimension follows from the coordinate or the distance on which the element
/// acts.
#[derive(Debug)]
pub enum ArgumentQuantity {
    /// The argument is a stiffness: force per displacement.
    Stiffness,
    /// The argument is a Hertz stiffness: force by displacement to the power of 3/2.
    HertzStiffness,
    /// The argument is a damping coefficient: force per velocity.
    Damping,
    /// The argument is an inertance: force per acceleration.
    Inertance,
    /// The argument is a force, or a torque on an angle.
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
        /// Argument `stiffness`: stiffness of a spring.
        Stiffness = key_row("stiffness", Stiffness);
        /// Force, as an expression of the stretch or the speed.
        Force = key_row("force", Force);
        /// Argument `energy`: energy as an expression of the stretch.
        Energy = key_row("energy", Energy);
        /// Length at which the force of a spring is zero.
        FreeLength = key_row("free_length", Coordinate);
        /// Angle at which the torque of a spring is zero.
        FreeAngle = key_row("free_angle", Coordinate);
        /// Argument `damping`: coefficient of a dashpot.
        Damping = key_row("damping", Damping);
        /// Argument `inertance`: inertance of an inerter.
        Inertance = key_row("inertance", Inertance);
        /// Argument `coulomb`: force of sliding friction.
        Coulomb = key_row("coulomb", Force);
        /// Argument `stiction`: force at breakaway.
        Stiction = key_row("stiction", Force);
        /// Speed at which the force has fallen from breakaway to sliding.
        StribeckSpeed = key_row("stribeck_speed", Speed);
        /// Argument `viscous`: coefficient of viscous friction.
        Viscous = key_row("viscous", Damping);
        /// Argument `speed`: speed of the regularisation of friction.
        Speed = key_row("speed", Speed);
        /// Argument `constant`: gravitational constant, for two bodies with mass.
        Constant = key_row("constant", Fixed(GRAVITATION, ""));
        /// Argument `mu`: gravitational parameter of the attracting body.
        Mu = key_row("mu", Fixed(ATTRACTION, ""));
        /// Argument `strength`: force times the square of the distance.
        Strength = key_row("strength", Fixed(STRENGTH, ""));
        /// Argument `friction`: coefficient of friction while surfaces slide.
        Friction = key_row("friction", PLAIN_NUMBER);
        /// Argument `stiction` of contacts: coefficient of friction at rest.
        StaticFriction = key_row("stiction", PLAIN_NUMBER);
        /// Maximum friction moment about the normal per unit normal force.
        TorsionalFriction = key_row("torsional", METERS);
        /// Maximum friction moment about the tangents per unit normal force.
        RollingFriction = key_row("rolling", METERS);
        /// Coefficient of restitution: `e`, a ratio of velocities, or `poisson(e)`, a ratio of impulses.
        Restitution = key_row("restitution", PLAIN_NUMBER);
        /// Argument `hertz`: stiffness of round bodies in contact (Hertz).
        Hertz = key_row("hertz", HertzStiffness);
        /// Argument `dissipation`: dissipation per speed of approach (Hunt and Crossley).
        Dissipation = key_row("dissipation", Fixed(SLOWNESS, "s/m"));
        /// Argument `from`: lower bound of a limit.
        From = key_row("from", Coordinate);
        /// Argument `to`: upper bound of a limit.
        To = key_row("to", Coordinate);
        /// Argument `max_speed`: maximum speed of a coordinate in both directions.
        MaxSpeed = key_row("max_speed", Speed);
        /// Argument `max_effort`: maximum force or torque in both directions.
        MaxEffort = key_row("max_effort", Force);
        /// Argument `along`: direction of a force on a body.
        Along = key_row("along", Direction);
        /// Argument `about`: direction of a torque on a body.
        About = key_row("about", Direction);
        /// Argument `value`: value of a force or a torque.
        Value = key_row("value", Load);
    }
}

const PLAIN_NUMBER: ArgumentQuantity = Fixed(PLAIN, "1");
const METERS: ArgumentQuantity = Fixed(LENGTH, "m");

/// Condition on which arguments of an element may or must occur together.
#[derive(Debug)]
pub struct ArgumentRelation {
    /// Argument at which a violation of the condition is reported.
    pub key: Key,
    /// True if the argument needs one of the other arguments, false if it excludes them.
    pub needs: bool,
    /// Arguments to which the condition refers.
    pub others: &'static [Key],
    /// Error message of a violation; `NAME` is replaced by the name of the element.
    pub message: &'static str,
    /// Help line of the error message.
    pub help: &'static str,
}

impl ArgumentRelation {
    /// Returns the condition that an argument is not given together with others.
    pub const fn exclusion_relation(
        key: Key,
        others: &'static [Key],
        message: &'static str,
        help: &'static str,
    ) -> ArgumentRelation {
        ArgumentRelation { key, needs: false, others, message, help }
    }

    /// Returns the condition that an argument is given together with one of the others.
    pub const fn relation_requiring_one_of(
        key: Key,
        others: &'static [Key],
        message: &'static str,
        help: &'static str,
    ) -> ArgumentRelation {
        ArgumentRelation { key, needs: true, others, message, help }
    }
}
