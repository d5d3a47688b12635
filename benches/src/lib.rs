//! Speed of Linkwork: generated functions next to a generic implementation of the same algorithms, and the time that
//! the compiler takes.
//!
//! - `cargo run --release -p linkwork-benches --bin ratios`: generated and generic side by side, in one table.
//! - `cargo bench -p linkwork-benches`: the same with criterion.
//! - `cargo run -p linkwork-benches --bin expansion`: time and memory of expanding mechanisms.

pub mod chains;
pub mod generic;
pub mod operations;
pub mod pairs;
pub mod random;
pub mod robots;
