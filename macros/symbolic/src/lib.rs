//! Scalar expressions, and the straight-line programs that compute them: the part of Linkwork's compiler that
//! knows no mechanics, in a crate of its own because most of the compiler's run time is spent here. Builds of
//! the workspace optimise this crate, and compile the rest of the compiler, twelve times as much code,
//! without optimisation.

pub mod expr;
pub mod lower;
pub mod machine;
