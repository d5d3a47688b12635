//! Placements of frames relative to other frames, as expressions.

use crate::expr::{Expr, Graph, Rotation, Vec3};

/// The placement of a child frame in a parent frame.
#[derive(Clone, Debug)]
pub struct Pose<'g> {
    /// Orientation of the child's axes relative to the parent's axes.
    pub rotation: Rotation<'g>,
    /// Position of the child's origin, in parent axes.
    pub translation: Vec3<'g>,
}

impl<'g> Pose<'g> {
    /// Returns the pose of a child frame that coincides with the parent frame.
    pub fn identity(graph: &'g Graph) -> Pose<'g> {
        Pose { rotation: Rotation::identity(graph), translation: Vec3::zero(graph) }
    }

    /// Returns the composition of this pose with the pose `next` relative to the child frame.
    pub fn compose_with(&self, next: &Pose<'g>) -> Pose<'g> {
        Pose {
            rotation: self.rotation.clone().compose_with(&next.rotation),
            translation: self.transform_point(next.translation),
        }
    }

    /// Returns the pose of the parent frame relative to the child frame.
    pub fn inverse(&self) -> Pose<'g> {
        let rotation = self.rotation.inverse();
        Pose { translation: -rotation.vector_in_parent_axes(self.translation), rotation }
    }

    /// Returns the position of a point of the child frame, from the parent's origin in parent axes.
    pub fn transform_point(&self, p: Vec3<'g>) -> Vec3<'g> {
        self.translation + self.rotation.vector_in_parent_axes(p)
    }

    /// Returns all expressions that rotation and translation consist of.
    pub fn all_expressions(&self) -> Vec<Expr<'g>> {
        self.rotation.rotation_matrix().0.iter().flatten().chain(&self.translation.0).copied().collect()
    }
}
