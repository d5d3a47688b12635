//! Names for expressions, tables, and configurations at rest.

use super::{Expr, Name};

/// A function that is a parameter, given by a table.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its name.
    pub name: Name,
    /// How many variables it has, one to three.
    pub variables: usize,
}

/// A configuration at rest: what is not named is zero, and orientations are those of the axes beside them.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Its name.
    pub name: Name,
    /// Coordinates, inputs and states, each with its value.
    pub values: Vec<(Expr, Expr)>,
}

/// What an expression stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    /// A number.
    Scalar,
    /// A physical vector.
    Vector,
    /// A physical matrix, which takes vectors to vectors.
    Matrix,
    /// All that acts on a body, which the expression names.
    FreeBody,
}

impl Rank {
    /// The element's type.
    pub fn kind(self) -> &'static str {
        match self {
            Rank::Scalar => "Scalar",
            Rank::Vector => "Vector",
            Rank::Matrix => "Matrix",
            Rank::FreeBody => "FreeBody",
        }
    }
}

/// A name for an expression.
#[derive(Clone, Debug)]
pub struct Definition {
    /// The name.
    pub name: Name,
    /// What it stands for.
    pub rank: Rank,
    /// The expression.
    pub value: Expr,
    /// The axes of an output's components.
    pub resolved_in: Option<Expr>,
}
