//! Types of elements: their names, their arguments, and how they are declared.

#[macro_use]
mod joints;
mod forces;
mod keys;
mod others;
pub mod words;

pub use forces::{ForceKind, ForceLawVariables};
pub use joints::{DrawnAxis, JointKind, JointTypeCoordinates};
pub use keys::{ArgumentQuantity, ArgumentRelation, Key};
pub use others::OtherKind;

use super::WordsWithMeanings;
use joints::JOINT_WORDS;
use words::{ENDS, MATRIX, PLACED};

/// Type of an element of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// Element type `Body`: a rigid body.
    Body,
    /// Element type `Particle`: a point mass.
    Particle,
    /// Element type of a joint.
    Joint(JointKind),
    /// Element type of a force element, or of an input that acts as a force.
    Force(ForceKind),
    /// Any other element type, such as a frame or a constraint.
    Other(OtherKind),
}

const BODY: &str = "Body";
const PARTICLE: &str = "Particle";

/// Names of other tools for the types of bodies and particles.
const MASSIVE: WordsWithMeanings = &[
    ("link rigidbody body3d part segment solid linkage inertial multibody", BODY),
    ("pointmass masspoint bob bead", PARTICLE),
];

/// Names of other tools for the arguments of a body.
const BODY_WORDS: WordsWithMeanings = &[
    ("m weight masse", "mass"),
    ("cog cm cg centre center centerofmass centreofmass massoffset cofm comoffset", "com"),
    ("i j ic icm moi momentofinertia inertiatensor inertiamatrix geometry shape solid", "inertia"),
    ("ixx iyy izz ixy ixz iyz jxx jyy jzz", MATRIX),
    ("length size l height width", "a size belongs to a solid, as in `inertia = rod(m, l, y)`"),
    ("radius diameter r", "a size belongs to a solid, as in `inertia = sphere(m, r)`"),
    ("density rho", "the mass is given directly: `mass = density * volume`"),
    ("position pos origin xyz translation location", PLACED),
    ("parent child joint on base", ENDS),
    ("color colour visual name", "colours and visuals are not used: remove it"),
    (
        "rotation axes rpy orientation",
        "rotate an end of the joint or an inertia: `body.rotated(z(angle))`, `rod(m, l, x).rotated(z(angle))`",
    ),
];

/// Names of other tools for the arguments of a particle.
const PARTICLE_WORDS: WordsWithMeanings = &[
    ("m weight", "mass"),
    ("position pos xyz r where point location place", "at"),
    ("on body parent", "the body is written before the vector: `at = body.at(length * x)`"),
    ("com inertia", "a particle is a point; a `Body` has a centre of mass and an inertia"),
];

impl ElementKind {
    /// Returns the element type with this name.
    pub fn find_by_name(name: &str) -> Option<ElementKind> {
        match name {
            BODY => Some(ElementKind::Body),
            PARTICLE => Some(ElementKind::Particle),
            _ => JointKind::find_by_name(name)
                .map(ElementKind::Joint)
                .or_else(|| ForceKind::find_by_name(name).map(ElementKind::Force))
                .or_else(|| OtherKind::find_by_name(name).map(ElementKind::Other)),
        }
    }

    /// Returns the names of all types of elements.
    pub fn element_names() -> impl Iterator<Item = &'static str> {
        [BODY, PARTICLE]
            .into_iter()
            .chain(JointKind::names())
            .chain(ForceKind::names())
            .chain(OtherKind::names())
    }

    /// Returns the name of the element type.
    pub fn element_name(self) -> &'static str {
        match self {
            ElementKind::Body => BODY,
            ElementKind::Particle => PARTICLE,
            ElementKind::Joint(joint) => joint.name(),
            ElementKind::Force(force) => force.name(),
            ElementKind::Other(other) => other.name(),
        }
    }

    /// Returns the type name with its indefinite article: `an Inerter`.
    pub fn name_with_article(self) -> String {
        word_with_article(self.element_name())
    }

    /// Returns the attributes of the language that belong to an element.
    pub fn element_attributes(self) -> &'static [&'static str] {
        match self {
            ElementKind::Body => &["body"],
            ElementKind::Particle => &["particle"],
            ElementKind::Joint(_) => &["joint"],
            ElementKind::Force(_) => &["acts"],
            ElementKind::Other(other) => other.row().attributes,
        }
    }

    /// Returns the words of other tools for the types of elements, each with the type's name.
    pub fn element_synonyms() -> impl Iterator<Item = (&'static str, &'static str)> {
        let massive = MASSIVE.iter().copied();
        massive.chain(JointKind::synonyms()).chain(ForceKind::synonyms()).chain(OtherKind::synonyms())
    }

    /// Returns the names of other tools for the arguments of an element.
    pub fn argument_synonyms(self) -> WordsWithMeanings {
        match self {
            ElementKind::Body => BODY_WORDS,
            ElementKind::Particle => PARTICLE_WORDS,
            ElementKind::Joint(_) => JOINT_WORDS,
            ElementKind::Force(force) => force.row().words,
            ElementKind::Other(other) => other.row().words,
        }
    }

    /// Returns an example of the element's declaration.
    pub fn declaration_example(self) -> &'static str {
        match self {
            ElementKind::Body => "#[body(mass = m, com = l / 2 * y, inertia = rod(m, l, y))]",
            ElementKind::Particle => "#[particle(mass = m, at = body.at(l * x))]",
            ElementKind::Joint(joint) => joint.row().example,
            ElementKind::Force(force) => force.row().example,
            ElementKind::Other(other) => other.row().example,
        }
    }
}

/// Returns the indefinite article of a word.
pub fn indefinite_article(word: &str) -> &'static str {
    if word.starts_with(['A', 'I']) { "an" } else { "a" }
}

fn word_with_article(word: &str) -> String {
    format!("{} {word}", indefinite_article(word))
}
