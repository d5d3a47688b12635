//! Programs → languages other than Rust: the same straight lines, printed once more. Like emission it never simplifies.

pub mod c;
