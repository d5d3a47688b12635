//! Shapes of links that are drawn.

use super::origin::Origin;
use crate::syntax::{Endpoint, Mesh, Name, Shape, Visual};

/// A part of a link's visual geometry.
pub(in crate::import) struct FileVisual {
    /// Where its centre and its axes are.
    pub(in crate::import) origin: Origin,
    /// What it is.
    pub(in crate::import) shape: Shape,
    /// Its triangles, if it is a mesh.
    pub(in crate::import) mesh: Option<Mesh>,
}

impl FileVisual {
    /// The part on a link of this name.
    pub(in crate::import) fn on(&self, link: &Name) -> Visual {
        let on = Endpoint { body: link.clone(), at: self.origin.at(), rotated: self.origin.rotated() };
        Visual { on, shape: self.shape, mesh: self.mesh.clone() }
    }
}
