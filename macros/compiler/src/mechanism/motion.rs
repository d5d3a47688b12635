//! Elementary motions of links, with their indices in `q` and `v`.

use super::index::{InQ, InV};
use crate::expr::{Expr, Vec3};
use std::ops::Range;

/// A joint coordinate: `ratio × q[index] + offset`, with velocity `ratio × v[index]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Index of the joint coordinate in `q`.
    pub q: InQ,
    /// Index of the joint coordinate's velocity in `v`.
    pub v: InV,
    /// Ratio of the joint coordinate to the entry of `q`, and of the joint velocity to the entry of `v`.
    pub ratio: f64,
    /// Joint coordinate at the zero of the entry of `q`.
    pub offset: f64,
}

/// The motion of a link in its parent's joint frame.
#[derive(Clone, Debug)]
pub enum Motion<'g> {
    /// Rotation of a link about a fixed unit axis.
    Turn {
        /// Axis of the rotation, in joint axes.
        axis: Vec3<'g>,
        /// Coordinate that is the angle of the rotation, rad.
        coordinate: Coordinate,
    },
    /// Translation of a link along a fixed unit axis.
    Slide {
        /// Axis of the translation, in joint axes.
        axis: Vec3<'g>,
        /// Coordinate that is the displacement, m.
        coordinate: Coordinate,
    },
    /// Rotation about an axis with a proportional translation along it.
    Helix {
        /// Axis of the screw, in joint axes.
        axis: Vec3<'g>,
        /// Advance of the screw per radian, m/rad.
        pitch: Expr<'g>,
        /// Coordinate that is the angle of the screw, rad.
        coordinate: Coordinate,
    },
    /// Rotation by a unit quaternion in `q`, with three angular velocities in link axes in `v`.
    Ball {
        /// Index in `q` of the first of the four quaternion components.
        q: InQ,
        /// Index in `v` of the first of the three angular velocity components.
        v: InV,
    },
    /// Rigid motion in space: position and quaternion in `q`, linear and angular velocity in link axes in
    /// `v`.
    Free {
        /// Index in `q` of the first of the seven components of position and quaternion.
        q: InQ,
        /// Index in `v` of the first of the six velocity components.
        v: InV,
    },
    /// Arbitrary: the link's placement is itself an expression of coordinates and time.
    Placed,
}

impl Motion<'_> {
    /// Returns the coordinate of a motion with one plain coordinate.
    pub fn single_coordinate(&self) -> Option<&Coordinate> {
        match self {
            Motion::Turn { coordinate, .. }
            | Motion::Slide { coordinate, .. }
            | Motion::Helix { coordinate, .. } => Some(coordinate),
            Motion::Ball { .. } | Motion::Free { .. } | Motion::Placed => None,
        }
    }

    /// Returns the range of indices in `q` on which the motion of the link relative to its parent depends.
    pub fn configuration_range(&self) -> Range<usize> {
        match self {
            Motion::Turn { coordinate, .. }
            | Motion::Slide { coordinate, .. }
            | Motion::Helix { coordinate, .. } => coordinate.q.range_of_entries(1),
            Motion::Ball { q, .. } => q.range_of_entries(4),
            Motion::Free { q, .. } => q.range_of_entries(7),
            Motion::Placed => 0..0,
        }
    }

    /// Returns the first of the entries of `q` that are a unit quaternion, if the motion has one.
    pub fn first_quaternion_index(&self) -> Option<InQ> {
        match self {
            Motion::Ball { q, .. } => Some(*q),
            Motion::Free { q, .. } => Some(*q + 3),
            Motion::Turn { .. } | Motion::Slide { .. } | Motion::Helix { .. } | Motion::Placed => None,
        }
    }

    /// Renumbers the entries of `v`: `place` maps the first index of the motion to its new value.
    pub fn renumber_velocities(&mut self, place: impl Fn(InV) -> InV) {
        match self {
            Motion::Turn { coordinate, .. }
            | Motion::Slide { coordinate, .. }
            | Motion::Helix { coordinate, .. } => coordinate.v = place(coordinate.v),
            Motion::Ball { v, .. } | Motion::Free { v, .. } => *v = place(*v),
            Motion::Placed => {}
        }
    }

    /// Returns true if the motion subspace is constant in link axes.
    pub fn has_constant_subspace(&self) -> bool {
        match self {
            Motion::Turn { .. }
            | Motion::Slide { .. }
            | Motion::Helix { .. }
            | Motion::Ball { .. }
            | Motion::Free { .. } => true,
            Motion::Placed => false,
        }
    }

    /// Returns an identifier of each kind of motion that identical limbs may have. Motions of one kind have
    /// the same number of degrees of freedom, and a constant subspace.
    pub fn limb_motion_kind(&self) -> Option<usize> {
        match self {
            Motion::Turn { .. } => Some(1),
            Motion::Slide { .. } => Some(2),
            Motion::Helix { .. } => Some(3),
            Motion::Ball { .. } => Some(4),
            Motion::Free { .. } | Motion::Placed => None,
        }
    }
}

/// Coordinate chart of a factor of the configuration space, with its first indices in `q` and `v`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chart {
    /// Chart of a plain coordinate, whose rate is its velocity.
    Plain(InQ, InV),
    /// Chart of a ball joint: a unit quaternion with three angular velocities.
    Ball(InQ, InV),
    /// Chart of a free joint: position and unit quaternion with six velocities.
    Free(InQ, InV),
}

impl Chart {
    /// Returns the first of the entries of `q` that are a unit quaternion, if the chart has one.
    pub fn first_quaternion_index(&self) -> Option<InQ> {
        match self {
            Chart::Plain(..) => None,
            Chart::Ball(q, _) => Some(*q),
            Chart::Free(q, _) => Some(*q + 3),
        }
    }
}
