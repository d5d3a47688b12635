//! Programs → languages other than Rust: the same straight lines, printed once more. Like emission it never
//! simplifies.

pub mod c;

pub use c::capitals;

/// A text that stands in a comment of C and does not end it.
pub fn in_comment(text: &str) -> String {
    c::safe(text)
}

/// A paragraph of a comment of C in lines that begin with these characters: the first one, and the others.
pub fn in_comment_lines(text: &str, first: &str, others: &str) -> String {
    c::wrapped(text, first, others)
}

/// Documentation whose links are words.
pub fn without_links(text: &str) -> String {
    c::without_links(text)
}
