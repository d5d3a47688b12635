//! Visual shapes of the links of a robot file.

use super::origin::FileOrigin;
use crate::syntax::{Endpoint, Mesh, Name, Shape, VisualShape};

/// Visual shape of a link of a robot file.
pub(in crate::import) struct FileVisual {
    /// Pose of the visual shape's centre relative to the link.
    pub(in crate::import) origin: FileOrigin,
    /// Visual shape with its lengths, m.
    pub(in crate::import) shape: Shape,
    /// Triangles of a mesh; `None` for other shapes.
    pub(in crate::import) mesh: Option<Mesh>,
}

impl FileVisual {
    /// Converts the shape to visual geometry of the link with this name.
    pub(in crate::import) fn visual_on_link(&self, link: &Name) -> VisualShape {
        let on = Endpoint {
            body: link.clone(),
            at: self.origin.nonzero_position(),
            rotated: self.origin.nonzero_rotations(),
        };
        VisualShape { on, shape: self.shape, mesh: self.mesh.clone() }
    }
}
