//! Normal forms of expressions: polynomials over atoms, the addition theorems of trigonometry, vectors on the unit
//! sphere, common factors. What is equal for all values gets the same form as far as these rules tell, which the
//! graph's own simplification does not attempt. Knows no mechanics.

pub mod common;
pub mod factor;
pub mod item;
pub mod normal;
pub mod polynomial;
pub mod trigonometry;
pub mod unit;
