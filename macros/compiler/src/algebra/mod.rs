//! Normal forms of expressions: polynomials over atoms, trigonometric addition theorems, relations between
//! the components of unit vectors, and common factors. Expressions that these rules prove equal get the same
//! normal form. The expression graph's own simplification does not attempt this. Knows no mechanics.

pub mod common;
pub mod factor;
pub mod item;
pub mod normal;
pub mod polynomial;
pub mod trigonometry;
pub mod unit;
