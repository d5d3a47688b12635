//! The types of elements: what they are called, which attributes go with them, and which arguments force
//! elements take. Matches over them have no arm for the rest, so that rustc names every place where a new one
//! is missing.

use super::joint_kind::{self, JointKind};

/// The type of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// A rigid body.
    Body,
    /// A point mass.
    Particle,
    /// A joint.
    Joint(JointKind),
    /// A force element or an input that acts.
    Force(ForceKind),
    /// Any other element.
    Other(OtherKind),
}

/// The types of elements that act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceKind {
    /// A spring.
    Spring,
    /// A dashpot.
    Dashpot,
    /// An inerter.
    Inerter,
    /// Dry friction.
    Friction,
    /// Central gravity.
    Gravity,
    /// Inverse-square attraction.
    Attraction,
    /// A force.
    Force,
    /// A torque.
    Torque,
}

/// The types of elements that neither have mass, nor join, nor act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OtherKind {
    /// A generalized coordinate of its own.
    Coordinate,
    /// An entry of `u` of its own.
    Input,
    /// A frame.
    Frame,
    /// A point.
    Point,
    /// A limit of a coordinate.
    Limit,
    /// A potential energy.
    Potential,
    /// A Rayleigh dissipation function.
    Rayleigh,
    /// A constraint of the configuration.
    Holonomic,
    /// A constraint of the velocity.
    Nonholonomic,
    /// A rolling pair.
    Rolling,
    /// A pair that slips.
    Slipping,
    /// A contact that opens and closes.
    Contact,
    /// A state of first order.
    State,
    /// An equilibrium.
    Equilibrium,
    /// A generalized speed.
    Speed,
    /// A scalar with a name.
    Scalar,
    /// A vector with a name.
    Vector,
    /// A matrix with a name.
    Matrix,
    /// A free-body diagram.
    FreeBody,
}

/// Every force element by its type's name, with its arguments.
const FORCES: [(&str, ForceKind, &[&str]); 8] = [
    (
        "Spring",
        ForceKind::Spring,
        &["on", "between", "stiffness", "force", "energy", "free_length", "free_angle"],
    ),
    ("Dashpot", ForceKind::Dashpot, &["on", "between", "damping", "force"]),
    ("Inerter", ForceKind::Inerter, &["on", "between", "inertance"]),
    ("Friction", ForceKind::Friction, &["on", "coulomb", "stiction", "stribeck_speed", "viscous", "speed"]),
    ("Gravity", ForceKind::Gravity, &["on", "between", "constant", "mu"]),
    ("Attraction", ForceKind::Attraction, &["between", "strength"]),
    ("Force", ForceKind::Force, &["on", "between", "along", "value"]),
    ("Torque", ForceKind::Torque, &["on", "about", "value"]),
];

/// Every other element by its type's name, with the attributes that belong to it.
const OTHERS: [(&str, OtherKind, &[&str]); 19] = [
    ("Coordinate", OtherKind::Coordinate, &[]),
    ("Input", OtherKind::Input, &[]),
    ("Frame", OtherKind::Frame, &["frame"]),
    ("Point", OtherKind::Point, &["point"]),
    ("Limit", OtherKind::Limit, &["limit"]),
    ("Potential", OtherKind::Potential, &["energy"]),
    ("Rayleigh", OtherKind::Rayleigh, &["dissipation"]),
    ("Holonomic", OtherKind::Holonomic, &["constraint"]),
    ("Nonholonomic", OtherKind::Nonholonomic, &["constraint"]),
    ("Rolling", OtherKind::Rolling, &["constraint"]),
    ("Slipping", OtherKind::Slipping, &["constraint"]),
    ("Contact", OtherKind::Contact, &["contact"]),
    ("State", OtherKind::State, &["state"]),
    ("Equilibrium", OtherKind::Equilibrium, &["equilibrium"]),
    ("Speed", OtherKind::Speed, &["speed"]),
    ("Scalar", OtherKind::Scalar, &["define", "output"]),
    ("Vector", OtherKind::Vector, &["define", "output"]),
    ("Matrix", OtherKind::Matrix, &["define", "output"]),
    ("FreeBody", OtherKind::FreeBody, &["output"]),
];

/// The names of all elements' types.
pub fn names() -> impl Iterator<Item = &'static str> {
    let forces = FORCES.iter().map(|(name, ..)| *name);
    let others = OTHERS.iter().map(|(name, ..)| *name);
    ["Body", "Particle"].into_iter().chain(joint_kind::names()).chain(forces).chain(others)
}

impl ElementKind {
    /// The element of a type's name.
    pub fn of_name(name: &str) -> Option<ElementKind> {
        let joint = || joint_kind::of_name(name).map(ElementKind::Joint);
        let force = || FORCES.iter().find(|(known, ..)| *known == name).map(|f| ElementKind::Force(f.1));
        let other = || OTHERS.iter().find(|(known, ..)| *known == name).map(|o| ElementKind::Other(o.1));
        match name {
            "Body" => Some(ElementKind::Body),
            "Particle" => Some(ElementKind::Particle),
            _ => joint().or_else(force).or_else(other),
        }
    }

    /// The attributes of the language that belong to an element.
    pub fn attributes(self) -> &'static [&'static str] {
        match self {
            ElementKind::Body => &["body"],
            ElementKind::Particle => &["particle"],
            ElementKind::Joint(_) => &["joint"],
            ElementKind::Force(_) => &["acts"],
            ElementKind::Other(other) => {
                OTHERS.iter().find(|(_, kind, _)| *kind == other).map_or(&[], |(.., own)| *own)
            }
        }
    }
}

impl ForceKind {
    /// The arguments of a force element.
    pub fn arguments(self) -> &'static [&'static str] {
        FORCES.iter().find(|(_, kind, _)| *kind == self).map_or(&[], |(.., arguments)| *arguments)
    }
}
