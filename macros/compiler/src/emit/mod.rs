//! Rust code from lowered programs: the struct without its elements, the generated functions with their
//! documentation, and the trait implementations. This stage performs no simplification.

mod absent;
mod angles;
mod block_loops;
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

pub use absent::items_that_mechanism_lacks;
pub use constraints::Constraints;
pub use contacts::UnilateralContact;
pub use derived::struct_alias_with_error;
pub use interface::{AbsentFunctions, Interface};
pub use item::{GeneratedCode, emit_error_stubs, emit_mechanism};
pub use limits::CoordinateLimitIndices;
pub use polytopes::ContactPolytopes;
pub use validate::ParameterCondition;
