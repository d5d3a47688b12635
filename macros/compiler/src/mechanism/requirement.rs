//! What figures fulfil in every mechanism that there can be.

use crate::expr::Expr;

/// A condition on figures that follow from parameters; where they are numbers it was checked when they were read.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement<'g> {
    /// The condition.
    pub rule: Rule,
    /// What the figures are: `` the mass of `cart` ``.
    pub figure: String,
    /// The parameters that they follow from, by index.
    pub parameters: Vec<usize>,
    /// As many as the rule takes.
    pub values: Vec<Expr<'g>>,
}

/// The conditions. All of them ask for numbers that are finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Nothing else, of one number.
    Finite,
    /// A mass: zero or more, in the range that leaves room for products and reciprocals.
    Mass,
    /// A coordinate of a place, in the range of lengths.
    Length,
    /// Zero or more.
    NotNegative,
    /// More than zero.
    Positive,
    /// Between zero and a right angle.
    HalfAngle,
    /// One: the square of a length.
    Unit,
    /// Between zero and one.
    Fraction,
    /// A lower bound and an upper one.
    Order,
    /// An inertia that a body can have: its entries xx, yy, zz, xy, xz, yz, and the body's mass.
    Inertia,
}

impl Rule {
    /// Its name in the runtime.
    pub fn name(self) -> &'static str {
        match self {
            Rule::Finite => "Finite",
            Rule::Mass => "Mass",
            Rule::Length => "Length",
            Rule::NotNegative => "NotNegative",
            Rule::Positive => "Positive",
            Rule::HalfAngle => "HalfAngle",
            Rule::Unit => "Unit",
            Rule::Fraction => "Fraction",
            Rule::Order => "Order",
            Rule::Inertia => "Inertia",
        }
    }

    /// True if what fulfils it fulfils the other: then the other need not be checked.
    pub fn includes(self, other: Rule) -> bool {
        self == other
            || match other {
                Rule::Finite => true,
                Rule::NotNegative => {
                    matches!(self, Rule::Mass | Rule::Positive | Rule::HalfAngle | Rule::Fraction)
                }
                _ => false,
            }
    }
}
