//! Conditions that values must satisfy for every choice of the parameters.

use crate::expr::Expr;

/// A condition on values that depend on parameters. Constant values were checked when they were parsed.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement<'g> {
    /// Condition that the values must satisfy for the parameters to be valid.
    pub rule: Rule,
    /// Description of the values: `` the mass of `cart` ``.
    pub figure: String,
    /// Indices of the parameters that the values depend on.
    pub parameters: Vec<usize>,
    /// Values to which the rule applies; their number depends on the rule.
    pub values: Vec<Expr<'g>>,
}

/// The conditions. Each of them includes that all values are finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The value must be a finite number.
    Finite,
    /// A mass: zero or positive, in the range in which products and reciprocals do not overflow.
    Mass,
    /// A coordinate of a position, in the range of lengths.
    Length,
    /// The value must be zero or positive.
    NotNegative,
    /// The value must be positive.
    Positive,
    /// The value must be an angle between zero and a right angle.
    HalfAngle,
    /// Squared length of a unit vector, which must be one.
    Unit,
    /// The value must be a fraction between zero and one.
    Fraction,
    /// A lower bound, then an upper bound that is not smaller.
    Order,
    /// A physically possible inertia: its entries xx, yy, zz, xy, xz, yz, and the body's mass.
    Inertia,
}

impl Rule {
    /// Returns the name of the validation rule in the runtime.
    pub fn runtime_rule_name(self) -> &'static str {
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

    /// Returns true if this rule implies the other, which then need not be checked.
    pub fn implies_rule(self, other: Rule) -> bool {
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
