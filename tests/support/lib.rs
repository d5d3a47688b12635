//! Shared parts of the tests: reference tables, comparisons, models, random states, and mechanisms that
//! several tests use.

pub mod compare;
pub mod counting;
pub mod differences;
pub mod mechanisms;
pub mod model;
pub mod random;
pub mod robots;
pub mod simulate;
pub mod table;
