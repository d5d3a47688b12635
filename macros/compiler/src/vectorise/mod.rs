//! Vectorisation over SIMD lanes: identical limbs become the lanes of one limb, and quantities that several
//! degrees of freedom propagate to the root through the same joints become the lanes of one expression.

mod find;
mod limbs;
mod merge;
mod paths;
mod velocities;

pub use find::{LimbGroup, find_limb_groups};
pub use limbs::{LimbRows, VectorisedMechanism, join_lanes};
pub use merge::LaneMerger;
pub use paths::{LaneGroup, PathsToRoot, PropagatedQuantity, RootPropagationVisitor};
