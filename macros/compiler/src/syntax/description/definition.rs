//! Declared definitions, tables and equilibria.

use super::{Expr, Name};

/// A parameter that is a function, given by a table.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of the interpolation table.
    pub name: Name,
    /// Number of variables of the table, one to three.
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

/// Kind of value that an expression must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    /// The expression is a scalar.
    Scalar,
    /// The expression is a physical vector.
    Vector,
    /// The expression is a physical matrix, which maps vectors to vectors.
    Matrix,
    /// Free-body diagram: all forces on the body that the expression names.
    FreeBody,
}

impl Rank {
    /// Returns the name of the element type for this kind of value.
    pub fn element_type_name(self) -> &'static str {
        match self {
            Rank::Scalar => "Scalar",
            Rank::Vector => "Vector",
            Rank::Matrix => "Matrix",
            Rank::FreeBody => "FreeBody",
        }
    }
}

/// Named expression: a definition or an output.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Name of the definition.
    pub name: Name,
    /// Declared kind of the expression's value.
    pub rank: Rank,
    /// Expression that the name of the definition denotes.
    pub value: Expr,
    /// Axes in which the components of an output are resolved.
    pub resolved_in: Option<Expr>,
}
