//! Export to C99: a source file and a header of a mechanism, which need only the mathematical library.
//!
//! Vectors are plain arrays, and matrices are stored by columns. The functions are reentrant: they store
//! nothing between calls and allocate no memory. Code that does not depend on the mechanism is in
//! `templates`; the template engine and the bodies of straight-line functions are shared with other
//! languages.

mod casadi;
mod composed;
mod functions;
mod header;
mod helpers;
mod kinematics;
mod source;

pub(super) use functions::program_of_own_results;
pub(super) use header::{
    c_parameter_type_definitions, frame_index_constants, list_state_entries, size_macros,
};
pub(super) use kinematics::manifold_function_statements;
pub(super) use source::definitions_for_kernels;
pub use source::{CSourceFiles, export_c_source};
