//! Contents of a robot file, in the order of the file.

use super::collision::FileCollisionShape;
use super::joint::FileJoint;
use super::origin::FileOrigin;
use super::visual::FileVisual;
use crate::syntax::file_parameters::FileField;
use crate::syntax::{Body, Constraint, Contact, Expr, FileForceElement, Joint, Name};
use std::collections::BTreeSet;

/// Maximum number of links, and of joints, of one file.
pub(in crate::import) const MAX_ELEMENTS: usize = 1024;

/// Contents of a robot file, in the order of the file.
#[derive(Default)]
pub(in crate::import) struct Robot {
    /// Links of the robot file, as bodies.
    pub(in crate::import) links: Vec<Body>,
    /// Joints of the kinematic tree, and joints that close loops before these are separated.
    pub(in crate::import) joints: Vec<FileJoint>,
    /// Pose of the root relative to the ground; `None` for the identity.
    pub(in crate::import) root: Option<FileOrigin>,
    /// Names of the joints that extensions of the format declare to close loops.
    pub(in crate::import) declared_closing: BTreeSet<String>,
    /// Joints that close loops.
    pub(in crate::import) closing: Vec<Joint>,
    /// Constraints on joint coordinates of the robot.
    pub(in crate::import) constraints: Vec<Constraint>,
    /// Contact pairs of the robot file.
    pub(in crate::import) contacts: Vec<Contact>,
    /// Collision geometry, each with the index of its link.
    pub(in crate::import) collisions: Vec<(usize, FileCollisionShape)>,
    /// Visual geometry, each with the index of its link.
    pub(in crate::import) visuals: Vec<(usize, FileVisual)>,
    /// Springs, dampers, rotors and motors on joint coordinates.
    pub(in crate::import) drives: Vec<FileForceElement>,
    /// States of first order, each with its field and its rate.
    pub(in crate::import) states: Vec<(FileField, Expr)>,
    /// Rayleigh dissipation functions: damping of ball and free joints, and drag of the surrounding fluid.
    pub(in crate::import) dissipations: Vec<(Name, Expr)>,
    /// Gravitational acceleration, m/s²; `None` if the format does not specify one.
    pub(in crate::import) gravity: Option<Expr>,
    /// Descriptions of the values of the file that were rounded.
    pub(in crate::import) snapped: Vec<String>,
    /// Descriptions of contents of the file that the mechanism does not represent.
    pub(in crate::import) left_out: Vec<String>,
}

/// Returns the body for a link of the file without mass properties.
pub(in crate::import) fn massless_link(name: Name) -> Body {
    Body { name, mass: None, com: None, inertia: None, about: None, at: None, frame: None }
}
