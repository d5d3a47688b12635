//! Export to C99: a source file and a header of a mechanism, which need only the mathematical library.
//!
//! Vectors are plain arrays, and matrices are stored by columns. The functions are reentrant: they store
//! nothing between calls and allocate no memory.

mod batch;
mod body;
mod casadi;
mod composed;
mod docs;
mod frames;
mod function;
mod header;
mod in_speeds;
mod manifold;
mod names;
mod own_functions;
mod pieces;
mod scalar;
mod signatures;
mod source;
mod steps;
mod support;
mod tables;

pub(super) use batch::{Array, Batch};
pub(super) use docs::{comment_safe_text, without_links, wrap_paragraph};
pub(super) use function::contains_word;
pub(super) use names::replace_invalid_characters;
pub use names::{identifier_from_name, prefix_identifier, preprocessor_names, snake_case_prefix};
pub(super) use scalar::{in_single_precision, number_length};
pub(super) use signatures::{CodeParts, Signatures, code_parts};
pub(super) use source::bodies_without_calls;
pub use source::{Files, Options, Unfit, export_c_source};
