//! Benchmarks of Linkwork: generated functions against a generic implementation of the same algorithms and
//! against other libraries, and the time of the compiler. The README of this package documents the commands.

pub mod assembly;
pub mod chains;
pub mod checked;
pub mod elements;
pub mod generic;
pub mod operations;
pub mod pairs;
pub mod peers;
pub mod precision;
pub mod random;
pub mod robots;
pub mod states;
