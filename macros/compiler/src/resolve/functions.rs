//! The functions of the language.

use crate::expr::Function;

/// Functions of the language beside the elementary ones.
pub const FUNCTIONS: [&str; 19] = [
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
    "reaction_force",
    "reaction_torque",
];

/// True for a function of the language that has a value.
pub fn is_function(name: &str) -> bool {
    FUNCTIONS.contains(&name) || Function::ALL.iter().any(|(known, _)| *known == name)
}
