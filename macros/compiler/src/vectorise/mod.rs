//! Expressions side by side, as the lanes of one: alike limbs, and what degrees of freedom propagate to the root through
//! the same joints.

mod find;
mod limbs;
mod merge;
mod paths;
mod velocities;

pub use find::{Group, find};
pub use limbs::{AlikeRows, Limbs, joined};
pub use merge::Merge;
pub use paths::{LaneGroup, Paths, Propagated, Visitor};
