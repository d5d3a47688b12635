//! What the user wrote → a checked mechanism: names resolved, the tree of links found, joints reduced to
//! elementary motions, bodies lumped into the links that carry them. All mistakes of the user are found here
//! or before; knows neither algorithms nor generated code.

mod accelerations;
mod axis;
mod build;
mod builder;
mod cables;
mod carriers;
mod centers;
mod chain;
mod closed_form;
mod closure;
mod constraint;
mod contact;
mod curves;
mod drawing;
mod drive;
mod elementary;
mod equilibria;
mod expression;
mod figures;
mod flight;
mod forces;
mod free_body;
mod freedom;
mod functions;
mod holders;
mod inertia;
mod joint;
mod limit;
mod masses;
mod matrices;
mod momenta;
mod motion;
mod names;
mod numbering;
mod outline;
mod output;
mod pieces;
mod place;
mod power;
mod quantities;
mod reaction;
mod requirements;
mod resolved;
mod rotation;
mod rows;
mod scope;
mod slips;
mod speeds;
mod target;
mod terms;
mod tree;
mod units;

pub use build::build_model;
pub use outline::{Outline, outline};
