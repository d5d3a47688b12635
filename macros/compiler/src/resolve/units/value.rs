//! Values of expressions in the inference of units: a number, a direction or a quantity; and their products.

use crate::language::dimension::{Dimension, PLAIN};
use crate::language::ratio::Ratio;

/// Source of a quantity's unit, in rising order: a product or a sum has the highest source of its factors or
/// terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum UnitSource {
    /// Coordinates, velocities and time. A number that multiplies them is a coefficient with any unit; by
    /// themselves they may be numbers of another unit.
    Motion,
    /// An input, which has the unit of the quantity on which it acts. A number that multiplies it is a
    /// coefficient with any unit.
    Input,
    /// A parameter. A number that multiplies it is a plain factor.
    Parameter,
}

/// Information about the unit of an expression.
#[derive(Clone, Debug)]
pub enum InferredUnit {
    /// Number, with any unit.
    Number(f64),
    /// Direction, with any unit by itself and none as a factor.
    Direction,
    /// Quantity with a dimension, and the source of its unit.
    Quantity {
        /// Dimension of the expression's value.
        dimension: Dimension,
        /// Source from which the unit is known.
        anchor: UnitSource,
    },
    /// Value of unknown dimension, or after an error.
    Unknown,
}

impl InferredUnit {
    /// Returns a quantity whose unit follows from the motion.
    pub fn known_from_motion(dimension: Dimension) -> InferredUnit {
        InferredUnit::Quantity { dimension, anchor: UnitSource::Motion }
    }

    /// Returns the inferred unit of the negated expression.
    pub fn unit_of_negation(self) -> InferredUnit {
        match self {
            InferredUnit::Number(value) => InferredUnit::Number(-value),
            other => other,
        }
    }

    /// Returns a power of the value; unknown if the exponent is unknown.
    pub fn unit_of_power(self, exponent: Option<Ratio>) -> InferredUnit {
        match self {
            InferredUnit::Quantity { dimension, .. } if dimension.is_plain() => {
                InferredUnit::known_from_motion(dimension)
            }
            InferredUnit::Quantity { dimension, anchor } => {
                match exponent.and_then(|e| dimension.dimension_of_power(e)) {
                    Some(dimension) => InferredUnit::Quantity { dimension, anchor },
                    None => InferredUnit::Unknown,
                }
            }
            _ => InferredUnit::Unknown,
        }
    }

    /// Returns the source of the unit; `Motion` for a value that is not a quantity.
    pub fn source_of_unit(&self) -> UnitSource {
        match self {
            InferredUnit::Quantity { anchor, .. } => *anchor,
            _ => UnitSource::Motion,
        }
    }

    /// Returns the more specific of two values with equal dimensions.
    pub fn more_specific_unit(self, other: InferredUnit) -> InferredUnit {
        match (&self, &other) {
            (InferredUnit::Quantity { .. }, _) => self,
            (_, InferredUnit::Quantity { .. }) => other,
            (InferredUnit::Unknown, _) | (_, InferredUnit::Unknown) => InferredUnit::Unknown,
            (InferredUnit::Number(_), _) => self,
            _ => other,
        }
    }
}

/// Returns the product of factors, and whether a number among them may have a unit. Marked factors are
/// divisors.
pub fn unit_of_product(factors: &[(bool, InferredUnit)]) -> (InferredUnit, bool) {
    let has_factor_of_kind = |what: fn(&InferredUnit) -> bool| factors.iter().any(|(_, f)| what(f));
    // Zero has any unit.
    if factors.iter().any(|(below, f)| !below && matches!(f, InferredUnit::Number(0.0))) {
        return (InferredUnit::Number(0.0), false);
    }
    if has_factor_of_kind(|f| matches!(f, InferredUnit::Unknown)) {
        return (InferredUnit::Unknown, false);
    }
    let (is_number, is_direction) = (
        has_factor_of_kind(|f| matches!(f, InferredUnit::Number(_))),
        has_factor_of_kind(|f| matches!(f, InferredUnit::Direction)),
    );
    let quantities: Vec<_> = factors
        .iter()
        .filter_map(|(below, f)| match f {
            InferredUnit::Quantity { dimension, anchor } => Some((*below, dimension, *anchor)),
            _ => None,
        })
        .collect();
    let Some(anchor) = quantities.iter().map(|(.., anchor)| *anchor).max() else {
        return match (is_number, is_direction) {
            (true, false) => (InferredUnit::Number(numeric_product_or_nan(factors)), false),
            (true, true) => (InferredUnit::Number(f64::NAN), false),
            _ => (InferredUnit::Direction, false),
        };
    };
    let product = quantities.iter().try_fold(PLAIN, |product, (below, dimension, _)| {
        product.times_power(dimension, Ratio::from_integer(if *below { -1 } else { 1 }))
    });
    match product {
        Some(dimension) => {
            (InferredUnit::Quantity { dimension, anchor }, is_number && anchor != UnitSource::Parameter)
        }
        None => (InferredUnit::Unknown, false),
    }
}

/// Returns the product of numbers; NaN if another factor is present.
fn numeric_product_or_nan(factors: &[(bool, InferredUnit)]) -> f64 {
    let numeric_value_of_factor =
        |f: &InferredUnit| if let InferredUnit::Number(value) = f { *value } else { f64::NAN };
    factors.iter().fold(1.0, |p, (below, f)| {
        if *below { p / numeric_value_of_factor(f) } else { p * numeric_value_of_factor(f) }
    })
}
