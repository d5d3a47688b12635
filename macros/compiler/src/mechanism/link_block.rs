//! Division of the links into blocks of successive links, for loops of the runtime.

/// Maximum number of links in a block: one in each lane of a register of the runtime.
pub const BLOCK_LENGTH: usize = 8;

/// Number of quantities of a link that the loops need: motion subspace, rotation matrix, position, joint
/// velocity and acceleration.
pub const LINK_QUANTITIES: usize = 20;
/// Number of mass properties of a link: mass, first moment, inertia tensor.
pub const MASS_PROPERTIES: usize = 10;

/// Chain of at most [`BLOCK_LENGTH`] links, each of which is the parent of the next and has no other child.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkBlock {
    /// Index of the first link.
    pub link: usize,
    /// Index in `v` of the first velocity. The other velocities follow.
    pub first: usize,
    /// Number of velocities: one for each link, or six for a free root link.
    pub count: usize,
    /// Block whose last link is the parent of the first link; `None` if the ground is.
    pub parent: Option<usize>,
    /// Indices of the blocks on the path from this block to the root, in ascending order.
    pub ancestors: Vec<usize>,
    /// Indices of the blocks whose path to the root contains this block, in ascending order.
    pub descendants: Vec<usize>,
}
