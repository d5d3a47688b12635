//! The elementary motions that joints are made of, before they have coordinates.

use super::axis::align;
use crate::expr::{Expr, Graph, Rotation, Vec3};
use crate::mechanism::{Coordinate, InQ, InV, Motion};

/// One motion of a joint.
pub enum Elementary<'g> {
    /// Rotation about an axis.
    Turn(Vec3<'g>),
    /// Translation along an axis.
    Slide(Vec3<'g>),
    /// Rotation about an axis with the given advance per radian.
    Helix(Vec3<'g>, Expr<'g>),
    /// All rotations.
    Ball,
    /// All motions.
    Free,
}

impl<'g> Elementary<'g> {
    /// The axis that it slides along.
    pub fn slide(&self) -> Option<Vec3<'g>> {
        match self {
            Elementary::Slide(axis) | Elementary::Helix(axis, _) => Some(*axis),
            Elementary::Turn(_) | Elementary::Ball | Elementary::Free => None,
        }
    }

    /// The axis that it turns about.
    pub fn turn(&self) -> Option<Vec3<'g>> {
        match self {
            Elementary::Turn(axis) | Elementary::Helix(axis, _) => Some(*axis),
            Elementary::Slide(_) | Elementary::Ball | Elementary::Free => None,
        }
    }

    /// The motion of a link with its coordinate, or with its first entries of `q` and `v`; and the axes that
    /// the link has in those of the joint: axes of rotation become coordinate axes.
    pub fn motion(
        &self,
        graph: &'g Graph,
        coordinate: Coordinate,
        (q, v): (InQ, InV),
    ) -> (Motion<'g>, Rotation<'g>) {
        let none = Rotation::identity(graph);
        match self {
            Elementary::Turn(axis) => {
                let (axis, aligned) = align(graph, *axis);
                (Motion::Turn { axis, coordinate }, aligned)
            }
            Elementary::Helix(axis, pitch) => {
                let (axis, aligned) = align(graph, *axis);
                (Motion::Helix { axis, pitch: *pitch, coordinate }, aligned)
            }
            Elementary::Slide(axis) => (Motion::Slide { axis: *axis, coordinate }, none),
            Elementary::Ball => (Motion::Ball { q, v }, none),
            Elementary::Free => (Motion::Free { q, v }, none),
        }
    }
}
