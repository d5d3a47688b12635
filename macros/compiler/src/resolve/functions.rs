//! The functions of the language.

use crate::expr::Function;

/// The quantities that the value of a function depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dependence {
    /// The configuration, and the quantities that its arguments depend on.
    Arguments,
    /// Velocities.
    Motion,
    /// Accelerations.
    Acceleration,
    /// Velocities, and accelerations where an argument is a motion itself.
    Rate,
    /// Velocities, and inputs where an argument is a contact.
    Power,
    /// Velocities and inputs, which determine the forces of joints and contacts.
    Reaction,
}

/// Functions of the language other than the elementary ones, each with the quantities that its value depends
/// on.
pub const FUNCTIONS: [(&str, Dependence); 57] = [
    ("atan2", Dependence::Arguments),
    ("degrees", Dependence::Arguments),
    ("pow", Dependence::Arguments),
    ("min", Dependence::Arguments),
    ("max", Dependence::Arguments),
    ("dot", Dependence::Arguments),
    ("cross", Dependence::Arguments),
    ("norm", Dependence::Arguments),
    ("unit", Dependence::Arguments),
    ("r", Dependence::Arguments),
    ("v", Dependence::Motion),
    ("a", Dependence::Acceleration),
    ("omega", Dependence::Motion),
    ("alpha", Dependence::Acceleration),
    ("rate", Dependence::Rate),
    ("angle", Dependence::Arguments),
    ("project", Dependence::Arguments),
    ("momentum", Dependence::Motion),
    ("angular_momentum", Dependence::Motion),
    ("kinetic_energy", Dependence::Motion),
    ("moment_of_inertia", Dependence::Arguments),
    ("center_of_mass", Dependence::Arguments),
    ("center_of_percussion", Dependence::Arguments),
    ("instant_center", Dependence::Motion),
    ("acceleration_center", Dependence::Acceleration),
    ("screw_axis", Dependence::Motion),
    ("screw_pitch", Dependence::Motion),
    ("projector", Dependence::Arguments),
    ("skew", Dependence::Arguments),
    ("outer", Dependence::Arguments),
    ("rotation", Dependence::Arguments),
    ("inertia", Dependence::Arguments),
    ("identity", Dependence::Arguments),
    ("transpose", Dependence::Arguments),
    ("trace", Dependence::Arguments),
    ("curvature", Dependence::Arguments),
    ("torsion", Dependence::Arguments),
    ("cable", Dependence::Arguments),
    ("gradient", Dependence::Arguments),
    ("power", Dependence::Power),
    ("reaction_force", Dependence::Reaction),
    ("reaction_torque", Dependence::Reaction),
    ("contact_force", Dependence::Reaction),
    ("contact_moment", Dependence::Reaction),
    ("density", Dependence::Arguments),
    ("pressure", Dependence::Arguments),
    ("temperature", Dependence::Arguments),
    ("speed_of_sound", Dependence::Arguments),
    ("angle_of_attack", Dependence::Arguments),
    ("sideslip", Dependence::Arguments),
    ("heading", Dependence::Arguments),
    ("elevation", Dependence::Arguments),
    ("bank", Dependence::Arguments),
    ("course", Dependence::Arguments),
    ("flight_path", Dependence::Arguments),
    ("stability_axes", Dependence::Arguments),
    ("wind_axes", Dependence::Arguments),
];

/// Returns the names of the functions of the language, without the elementary ones.
pub fn names<'a>() -> impl Iterator<Item = &'a str> {
    FUNCTIONS.iter().map(|(name, _)| *name)
}

/// Returns the quantities that the value of a function of this name depends on; those of its arguments for an
/// elementary function or a name that is unknown.
pub fn dependence(name: &str) -> Dependence {
    let known = FUNCTIONS.iter().find(|(known, _)| *known == name);
    known.map_or(Dependence::Arguments, |(_, dependence)| *dependence)
}

/// True for a function of the language that has a value.
pub fn is_function(name: &str) -> bool {
    names().any(|known| known == name) || Function::ALL.iter().any(|(known, _)| *known == name)
}
