//! A robot as its file says.

use super::collision::FileCollision;
use super::joint::FileJoint;
use crate::syntax::Body;

/// What the file says, in its own order.
pub struct Robot {
    /// Its links.
    pub links: Vec<Body>,
    /// Its joints.
    pub joints: Vec<FileJoint>,
    /// Collision geometry: the link's number, what it is.
    pub collisions: Vec<(usize, FileCollision)>,
    /// What was rounded.
    pub snapped: Vec<String>,
}
