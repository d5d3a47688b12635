//! Links: moving frames in a tree, each with one elementary motion, and the configuration space that they span.

use super::inertia::Inertia;
use super::pose::Pose;
use super::speeds::Speeds;
use crate::expr::{Expr, Graph, Vec3};

/// Index of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LinkId(pub usize);

/// A joint coordinate: `ratio × q[index] + offset`, with velocity `ratio × v[index]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Index in `q`.
    pub q: usize,
    /// Index in `v`.
    pub v: usize,
    /// Factor.
    pub ratio: f64,
    /// Offset.
    pub offset: f64,
}

/// The motion of a link in its parent's joint frame.
#[derive(Clone, Debug)]
pub enum Motion<'g> {
    /// Rotation about a unit axis.
    Turn {
        /// Axis, in joint axes.
        axis: Vec3<'g>,
        /// Angle.
        coordinate: Coordinate,
    },
    /// Translation along a unit axis.
    Slide {
        /// Axis, in joint axes.
        axis: Vec3<'g>,
        /// Length.
        coordinate: Coordinate,
    },
    /// Rotation about an axis with a proportional translation along it.
    Helix {
        /// Axis, in joint axes.
        axis: Vec3<'g>,
        /// Advance per radian.
        pitch: Expr<'g>,
        /// Angle.
        coordinate: Coordinate,
    },
    /// All rotations: a quaternion from `q`, three angular velocities in link axes from `v`.
    Ball {
        /// First of four entries of `q`.
        q: usize,
        /// First of three entries of `v`.
        v: usize,
    },
    /// All motions: position and quaternion from `q`, linear and angular velocity in link axes from `v`.
    Free {
        /// First of seven entries of `q`.
        q: usize,
        /// First of six entries of `v`.
        v: usize,
    },
    /// The link's placement is itself an expression of coordinates and time.
    Placed,
}

/// A part of the configuration space: first entries of `q` and `v`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chart {
    /// A plain coordinate.
    Plain(usize, usize),
    /// A ball's quaternion.
    Ball(usize, usize),
    /// A free joint's position and quaternion.
    Free(usize, usize),
}

/// The configuration space, for rates of expressions of the coordinates.
#[derive(Clone, Copy)]
pub struct Space<'a, 'g> {
    /// Owner of the expressions.
    pub graph: &'g Graph,
    /// Its parts.
    pub charts: &'a [Chart],
    /// What the entries of `v` are, where they are not the velocities that the joints have.
    pub speeds: Option<&'a Speeds<'g>>,
}

/// A moving frame of the tree, with everything that is fixed in it.
#[derive(Clone, Debug)]
pub struct Link<'g> {
    /// The link that carries it; the ground if none. Its index is smaller.
    pub parent: Option<LinkId>,
    /// The joint's frame on the parent link.
    pub placement: Pose<'g>,
    /// How the link moves in the joint's frame.
    pub motion: Motion<'g>,
    /// Mass properties of all bodies fixed in it.
    pub inertia: Inertia<'g>,
}

/// A named frame: a body's, a particle's or a point's.
#[derive(Clone, Debug)]
pub struct NamedFrame<'g> {
    /// Name.
    pub name: String,
    /// It may have mass: it is no point.
    pub massive: bool,
    /// The link it is fixed in; the ground if none.
    pub link: Option<LinkId>,
    /// Its placement in the link's frame.
    pub pose: Pose<'g>,
}
