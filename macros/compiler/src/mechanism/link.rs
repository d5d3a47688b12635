//! Links: moving frames in a tree, each with one elementary motion, and the configuration space that they span.

use super::inertia::Inertia;
use super::motion::{Chart, Motion};
use super::pose::Pose;
use super::speeds::Speeds;
use crate::expr::Graph;

/// Index of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LinkId(pub usize);

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
