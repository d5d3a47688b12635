//! Rust code from lowered programs: the struct without its elements, the generated functions with their
//! documentation, and the trait implementations. This stage performs no simplification.

mod absent;
mod angles;
mod body;
mod constants;
mod constraint_data;
mod constraints;
mod contacts;
mod derived;
mod differentiable;
mod dispatch;
mod docs;
mod file;
mod frames;
mod function;
mod implementations;
mod instruction;
mod interface;
mod item;
mod lanes;
mod limits;
mod manifold;
mod matrices;
mod measurements;
mod pieces;
mod polytopes;
mod prepared;
mod reactions;
mod scalar;
mod sensitivities;
mod signature;
mod speeds;
mod statements;
mod states;
mod stores;
mod validate;

pub use absent::absent_items;
pub use constraints::Constraints;
pub use contacts::UnilateralContact;
pub use derived::error_type;
pub use interface::{Absent, Interface};
pub use item::{Emitted, emit_failed, emit_mechanism};
pub use limits::CoordinateLimits;
pub use polytopes::ContactPolytopes;
pub use validate::ParameterCondition;
