//! The functions of the language.

use crate::expr::Function;

/// Functions of the language beside the elementary ones.
pub const FUNCTIONS: [&str; 36] = [
    "atan2",
    "degrees",
    "pow",
    "min",
    "max",
    "dot",
    "cross",
    "norm",
    "unit",
    "r",
    "v",
    "a",
    "omega",
    "alpha",
    "rate",
    "angle",
    "project",
    "momentum",
    "angular_momentum",
    "kinetic_energy",
    "moment_of_inertia",
    "power",
    "reaction_force",
    "reaction_torque",
    "contact_force",
    "density",
    "pressure",
    "temperature",
    "speed_of_sound",
    "angle_of_attack",
    "sideslip",
    "heading",
    "elevation",
    "bank",
    "course",
    "flight_path",
];

/// True for a function of the language that has a value.
pub fn is_function(name: &str) -> bool {
    FUNCTIONS.contains(&name) || Function::ALL.iter().any(|(known, _)| *known == name)
}
