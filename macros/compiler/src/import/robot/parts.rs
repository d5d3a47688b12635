//! What a file says, in its own order.

use super::collision::FileCollision;
use super::joint::FileJoint;
use super::origin::Origin;
use super::visual::FileVisual;
use crate::syntax::{Body, Constraint, Contact, Drive, Expr, Joint, Name};

/// Links or joints of one file.
pub(in crate::import) const MAX_ELEMENTS: usize = 1024;

/// What the file says, in its own order.
#[derive(Default)]
pub(in crate::import) struct Robot {
    /// Its links.
    pub(in crate::import) links: Vec<Body>,
    /// Its joints.
    pub(in crate::import) joints: Vec<FileJoint>,
    /// Where the root stands on the ground, if not in its axes.
    pub(in crate::import) root: Option<Origin>,
    /// Joints that close loops.
    pub(in crate::import) closing: Vec<Joint>,
    /// Conditions on coordinates.
    pub(in crate::import) constraints: Vec<Constraint>,
    /// What touches what.
    pub(in crate::import) contacts: Vec<Contact>,
    /// Collision geometry: the link's number, what it is.
    pub(in crate::import) collisions: Vec<(usize, FileCollision)>,
    /// Visual geometry: the link's number, what it is.
    pub(in crate::import) visuals: Vec<(usize, FileVisual)>,
    /// Springs, dampers, rotors and motors on coordinates.
    pub(in crate::import) drives: Vec<Drive>,
    /// Rayleigh's functions of what has no coordinate of its own.
    pub(in crate::import) dissipations: Vec<(Name, Expr)>,
    /// Gravity, m/s²; nothing if the format has none.
    pub(in crate::import) gravity: Option<Expr>,
    /// What was rounded.
    pub(in crate::import) snapped: Vec<String>,
    /// What is in the file and not in the mechanism.
    pub(in crate::import) left_out: Vec<String>,
}

/// A body without mass.
pub(in crate::import) fn bare_link(name: Name) -> Body {
    Body { name, mass: None, com: None, inertia: None, about: None, at: None, frame: None }
}
