//! C99: a source file and a header of a mechanism, which need nothing but the mathematical library.
//!
//! Vectors are plain arrays, matrices stand column by column. Functions keep nothing between calls and
//! allocate nothing, so that any number of threads may call them.

mod body;
mod casadi;
mod composed;
mod docs;
mod frames;
mod function;
mod in_speeds;
mod manifold;
mod names;
mod pieces;
mod scalar;
mod source;
mod steps;
mod support;
mod tables;

pub(super) use docs::{safe, without_links, wrapped};
pub use names::{capitals, identifier, prefix};
pub use source::{Files, Options, Unfit, write};
