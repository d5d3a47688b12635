//! Result of the import of a robot file: bodies, joints and elements.

use crate::diag::Place;
use crate::syntax::file_parameters::FileField;
use crate::syntax::{
    Body, CollisionShape, Constraint, Contact, Expr, FileForceElement, Joint, Limit, Name, VisualShape,
};
use std::path::PathBuf;

/// Mechanism that a robot file describes.
#[derive(Clone, Debug)]
pub struct ImportedMechanism {
    /// Bodies of the links, each after its parent.
    pub bodies: Vec<Body>,
    /// Joints in coordinate order: first the root's joint, then depth first, with the joints of one parent
    /// sorted by name.
    pub joints: Vec<Joint>,
    /// Springs, dampers, rotors and motors on joint coordinates.
    pub drives: Vec<FileForceElement>,
    /// Rayleigh dissipation functions: damping of ball and free joints, and drag of the surrounding fluid.
    pub dissipations: Vec<(Name, Expr)>,
    /// Constraints on joint coordinates of the file.
    pub constraints: Vec<Constraint>,
    /// Gravitational acceleration, m/s²; `None` if the format does not specify one.
    pub gravity: Option<Expr>,
    /// Limits of the joints of the file.
    pub limits: Vec<Limit>,
    /// Fields of the mechanism that hold values of the file.
    pub fields: Vec<FileField>,
    /// Rates of the fields that are states of first order, by the names of the fields.
    pub rates: Vec<(String, Expr)>,
    /// True if the root of the file is the ground.
    pub is_ground: bool,
    /// Contact pairs, if the options request them.
    pub contacts: Vec<Contact>,
    /// Collision geometry of the links, if the options request it.
    pub collisions: Vec<CollisionShape>,
    /// Visual geometry of the links, if the options request it.
    pub visuals: Vec<VisualShape>,
    /// Descriptions of the values that were rounded on request: joint, entry, value before and after.
    pub snapped: Vec<String>,
    /// Descriptions of contents of the file that the mechanism does not represent.
    pub left_out: Vec<String>,
    /// Paths of the files that the robot file includes.
    pub files: Vec<PathBuf>,
}

/// Value read from a file, with its source position.
#[derive(Clone, Debug)]
pub struct Located<T> {
    /// Value as written in the file, in the file's units.
    pub value: T,
    /// Source position of the value in the file.
    pub place: Place,
}
