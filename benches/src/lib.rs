//! Speed of Linkwork: generated functions next to a generic implementation of the same algorithms and next to
//! other libraries, and the time that the compiler takes. The README beside this package says how to run
//! what.

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
