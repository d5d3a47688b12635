//! Export of programs to languages other than Rust. Like emission, export prints the same straight-line
//! programs and never simplifies.

mod body;
pub mod c;
mod comments;
pub mod cuda;
pub mod fmu;
mod handwritten;
mod mechanism;
mod names;
mod pieces;
mod signatures;
mod template;
mod tokens;
pub mod wgsl;

pub use comments::{comment_safe_text, without_doc_links, wrap_paragraph};
pub use mechanism::{ExportObstacle, Options};
pub use names::{c_name_prefix, identifier_from_name, to_snake_case, unique_constant_suffixes};
