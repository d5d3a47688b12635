//! What the tests share: reference tables, comparisons, models, random states, mechanisms that several of
//! them look at.

pub mod compare;
pub mod mechanisms;
pub mod model;
pub mod random;
pub mod robots;
pub mod simulate;
pub mod table;
