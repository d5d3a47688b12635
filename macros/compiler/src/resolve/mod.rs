//! What the user wrote → a checked mechanism: names resolved, the tree of links found, joints reduced to elementary
//! motions, bodies lumped into the links that carry them. All mistakes of the user are found here or before; knows
//! neither algorithms nor generated code.

mod action;
mod axis;
mod build;
mod carriers;
mod closed_form;
mod constraint;
mod contact;
mod expression;
mod figures;
mod inertia;
mod joint;
mod masses;
mod outline;
mod place;
mod reaction;
mod slips;
mod terms;
mod tree;
mod units;
mod world;

pub use build::build_model;
pub use outline::{Outline, outline};
