//! Links: moving frames in a tree, each with one elementary motion, and the configuration space of all these
//! motions.

use super::inertia::Inertia;
use super::motion::{Chart, Motion};
use super::pose::Pose;
use super::speeds::Speeds;
use crate::expr::Graph;

/// Index of a link in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LinkId(pub usize);

/// The configuration space, from which time derivatives of expressions of the coordinates are computed.
#[derive(Clone, Copy)]
pub struct ConfigurationSpace<'a, 'g> {
    /// Graph that owns the expressions of the model.
    pub graph: &'g Graph,
    /// Coordinate charts of the factors of the configuration space.
    pub charts: &'a [Chart],
    /// Generalized speeds that the entries of `v` are; `None` if the entries are joint velocities.
    pub speeds: Option<&'a Speeds<'g>>,
}

/// A moving frame of the tree, with the bodies fixed in it.
#[derive(Clone, Debug)]
pub struct Link<'g> {
    /// Parent link, whose index is smaller; `None` for the ground.
    pub parent: Option<LinkId>,
    /// Pose of the joint's frame on the parent link.
    pub placement: Pose<'g>,
    /// Motion of the link relative to the joint's frame.
    pub motion: Motion<'g>,
    /// Mass properties of all bodies fixed in the link.
    pub inertia: Inertia<'g>,
}

/// A named frame of a body, a particle or a point.
#[derive(Clone, Debug)]
pub struct NamedFrame<'g> {
    /// Name of the named frame.
    pub name: String,
    /// True for a body or particle, which may have mass; false for a point.
    pub massive: bool,
    /// Link in which it is fixed; `None` for the ground.
    pub link: Option<LinkId>,
    /// Pose of the named frame relative to its link.
    pub pose: Pose<'g>,
}
