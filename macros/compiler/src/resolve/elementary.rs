//! Elementary motions of joints, before coordinates are assigned.

use super::axis::nearest_axis_and_rotation;
use crate::expr::{Expr, Graph, Rotation, Vec3};
use crate::mechanism::{Coordinate, InQ, InV, Motion};

/// Elementary motion of a joint.
pub enum ElementaryMotion<'g> {
    /// Rotation of a joint about an axis.
    Turn(Vec3<'g>),
    /// Translation of a joint along an axis.
    Slide(Vec3<'g>),
    /// Rotation about an axis with the given advance per radian.
    Helix(Vec3<'g>, Expr<'g>),
    /// Rotation of a joint about all axes (spherical).
    Ball,
    /// Rigid motion in space with six degrees of freedom.
    Free,
}

impl<'g> ElementaryMotion<'g> {
    /// Returns the axis of translation, if the motion is a translation or a screw.
    pub fn translation_axis(&self) -> Option<Vec3<'g>> {
        match self {
            ElementaryMotion::Slide(axis) | ElementaryMotion::Helix(axis, _) => Some(*axis),
            ElementaryMotion::Turn(_) | ElementaryMotion::Ball | ElementaryMotion::Free => None,
        }
    }

    /// Returns the axis of rotation, if the motion is a rotation or a screw.
    pub fn rotation_axis(&self) -> Option<Vec3<'g>> {
        match self {
            ElementaryMotion::Turn(axis) | ElementaryMotion::Helix(axis, _) => Some(*axis),
            ElementaryMotion::Slide(_) | ElementaryMotion::Ball | ElementaryMotion::Free => None,
        }
    }

    /// Returns the motion of a link, and the orientation of the link in the axes of the joint. The motion has
    /// the given coordinate, or the given first entries of `q` and `v`. Constant axes of rotation become
    /// coordinate axes of the link.
    pub fn motion_of_link(
        &self,
        graph: &'g Graph,
        coordinate: Coordinate,
        (q, v): (InQ, InV),
    ) -> (Motion<'g>, Rotation<'g>) {
        let none = Rotation::identity(graph);
        match self {
            ElementaryMotion::Turn(axis) => {
                let (axis, aligned) = nearest_axis_and_rotation(graph, *axis);
                (Motion::Turn { axis, coordinate }, aligned)
            }
            ElementaryMotion::Helix(axis, pitch) => {
                let (axis, aligned) = nearest_axis_and_rotation(graph, *axis);
                (Motion::Helix { axis, pitch: *pitch, coordinate }, aligned)
            }
            ElementaryMotion::Slide(axis) => (Motion::Slide { axis: *axis, coordinate }, none),
            ElementaryMotion::Ball => (Motion::Ball { q, v }, none),
            ElementaryMotion::Free => (Motion::Free { q, v }, none),
        }
    }
}
