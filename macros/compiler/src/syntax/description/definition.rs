//! Declared definitions, tables and equilibria.

use super::{Expr, Name};

/// A parameter that is a function, given by a table.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of the table.
    pub name: Name,
    /// Number of variables, one to three.
    pub variables: usize,
}

/// A configuration at rest. Unspecified values are zero; unspecified orientations are the identity.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Name of the equilibrium.
    pub name: Name,
    /// Coordinates, inputs and states at the equilibrium, each with its value.
    pub values: Vec<(Expr, Expr)>,
}

/// Kind of value that an expression has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    /// Scalar.
    Scalar,
    /// Physical vector.
    Vector,
    /// Physical matrix, which maps vectors to vectors.
    Matrix,
    /// Free-body diagram: all forces on the body that the expression names.
    FreeBody,
}

impl Rank {
    /// Returns the type of the element.
    pub fn element_type_name(self) -> &'static str {
        match self {
            Rank::Scalar => "Scalar",
            Rank::Vector => "Vector",
            Rank::Matrix => "Matrix",
            Rank::FreeBody => "FreeBody",
        }
    }
}

/// Named expression.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Name of the definition.
    pub name: Name,
    /// Declared kind of value.
    pub rank: Rank,
    /// Expression that the name denotes.
    pub value: Expr,
    /// Axes in which the components of an output are resolved.
    pub resolved_in: Option<Expr>,
}
