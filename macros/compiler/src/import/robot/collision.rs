//! Collision shapes of links, which contacts refer to.

use super::origin::FileOrigin;
use crate::diag::Place;
use crate::syntax::{CollisionShape, Endpoint, MeshVertices, Name, Shape};

/// Collision shape of a link.
pub(in crate::import) struct FileCollisionShape {
    /// Pose of the collision shape's centre relative to the link.
    pub(in crate::import) origin: FileOrigin,
    /// Shape of the collision geometry with its lengths, m.
    pub(in crate::import) shape: Shape,
    /// Source of the vertices of a mesh; `None` for other shapes.
    pub(in crate::import) mesh: Option<MeshVertices>,
    /// Source position of the geometry in the file.
    pub(in crate::import) place: Place,
}

impl FileCollisionShape {
    /// Converts the shape to collision geometry of the link with this name.
    pub(in crate::import) fn collision_on_link(&self, link: &Name) -> CollisionShape {
        let (at, rotated) = (self.origin.nonzero_position(), self.origin.nonzero_rotations());
        let on = Endpoint { body: link.clone(), at, rotated };
        let (shape, mesh) = (self.shape, self.mesh.clone());
        CollisionShape { on, shape, mesh, hull: Vec::new(), place: self.place.clone() }
    }
}
