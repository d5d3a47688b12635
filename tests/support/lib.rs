//! What the tests share: reference tables, comparisons, random states, and the mechanisms that several of them look at.

pub mod compare;
pub mod mechanisms;
pub mod random;
pub mod robots;
pub mod simulate;
pub mod table;
