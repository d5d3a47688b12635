//! Visual shapes of the links of a robot file.

use super::origin::Origin;
use crate::syntax::{Endpoint, Mesh, Name, Shape, Visual};

/// Visual shape of a link.
pub(in crate::import) struct FileVisual {
    /// Pose of the shape's centre relative to the link.
    pub(in crate::import) origin: Origin,
    /// Shape of the geometry with its lengths, m.
    pub(in crate::import) shape: Shape,
    /// Triangles of a mesh; `None` for other shapes.
    pub(in crate::import) mesh: Option<Mesh>,
}

impl FileVisual {
    /// Attaches the shape to the link with this name.
    pub(in crate::import) fn attached_to(&self, link: &Name) -> Visual {
        let on = Endpoint {
            body: link.clone(),
            at: self.origin.nonzero_position(),
            rotated: self.origin.nonzero_rotations(),
        };
        Visual { on, shape: self.shape, mesh: self.mesh.clone() }
    }
}
