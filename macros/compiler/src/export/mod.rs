//! Export of programs to languages other than Rust. Like emission, export prints the same straight-line
//! programs and never simplifies.

pub mod c;
pub mod cuda;
pub mod fmu;
pub mod wgsl;

pub use c::preprocessor_names;

/// Returns a text that is valid inside a comment of C.
pub fn in_comment(text: &str) -> String {
    c::comment_safe_text(text)
}

/// Wraps a paragraph to lines of a C comment that begin with `first` and `others`.
pub fn in_comment_lines(text: &str, first: &str, others: &str) -> String {
    c::wrap_paragraph(text, first, others)
}

/// Replaces the links in a documentation text by their words.
pub fn without_links(text: &str) -> String {
    c::without_links(text)
}
