//! Symbolic kernel: a hash-consed graph of scalar expressions that simplifies at construction, with
//! differentiation and evaluation. Knows no mechanics.

pub mod air;
pub mod diff;
pub mod eval;
pub mod exact;
pub mod graph;
pub mod handle;
pub mod lanes;
pub mod matrix;
pub mod memo;
pub mod node;
pub mod replace;
pub mod rotation;
pub mod sample;
mod text;

pub use graph::Graph;
pub use handle::Expr;
pub use matrix::{Mat3, Sym3, Vec3};
pub use memo::Memo;
pub use node::{Extreme, Function, Id, Lookup, Node, Symbol};
pub use rotation::Rotation;
