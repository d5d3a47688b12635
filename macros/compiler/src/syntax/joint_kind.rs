//! The joints of the language: what they are called, and which arguments they take beside their ends.

/// A kind of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Rotation about an axis (revolute, hinge).
    Pin,
    /// Translation along an axis (prismatic).
    Sleeve,
    /// Rotation about and translation along one axis, coupled by a pitch (helical).
    Screw,
    /// Rotation about and translation along one axis, independent (cylindrical).
    Collar,
    /// Translation along one axis, then rotation about another.
    Slot,
    /// Rotations about two axes in turn.
    Universal,
    /// All rotations (spherical).
    Ball,
    /// Two translations and a rotation about their normal (dual sleeve-pin).
    Planar,
    /// Two or three translations (x-y and x-y-z stage).
    Stage,
    /// All motions (six degrees of freedom).
    Free,
    /// No motion (fixed).
    Weld,
}

/// Every joint by its type's name, with its arguments.
const JOINTS: [(&str, JointKind, &[&str]); 11] = [
    ("Pin", JointKind::Pin, &["about"]),
    ("Sleeve", JointKind::Sleeve, &["along"]),
    ("Screw", JointKind::Screw, &["about", "along", "pitch", "lead"]),
    ("Collar", JointKind::Collar, &["about", "along"]),
    ("Slot", JointKind::Slot, &["about", "along"]),
    ("Universal", JointKind::Universal, &["about"]),
    ("Ball", JointKind::Ball, &[]),
    ("Planar", JointKind::Planar, &["about", "along"]),
    ("Stage", JointKind::Stage, &["along"]),
    ("Free", JointKind::Free, &[]),
    ("Weld", JointKind::Weld, &[]),
];

/// The names of all joints' types.
pub fn names() -> impl Iterator<Item = &'static str> {
    JOINTS.iter().map(|(name, ..)| *name)
}

/// The joint of a type's name.
pub fn of_name(name: &str) -> Option<JointKind> {
    JOINTS.iter().find(|(joint, ..)| *joint == name).map(|(_, kind, _)| *kind)
}

/// The word of the language for a joint.
pub fn kind_word(kind: JointKind) -> &'static str {
    JOINTS.iter().find(|(_, k, _)| *k == kind).map_or("joint", |(word, ..)| word)
}

/// Arguments of a joint beside its ends.
pub fn arguments(kind: JointKind) -> &'static [&'static str] {
    JOINTS.iter().find(|(_, k, _)| *k == kind).map_or(&[], |(.., arguments)| arguments)
}
