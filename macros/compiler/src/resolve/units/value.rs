//! Values of expressions in the inference of units: a number, a direction or a quantity; and their products.

use crate::language::dimension::{Dimension, PLAIN};
use crate::language::ratio::Ratio;

/// Source of a quantity's unit, in rising order: a product or a sum has the highest source of its factors or
/// terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Anchor {
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
pub enum UnitValue {
    /// Number, with any unit.
    Number(f64),
    /// Direction, with any unit by itself and none as a factor.
    Direction,
    /// Quantity with a dimension, and the source of its unit.
    Quantity {
        /// Dimension of the expression's value.
        dimension: Dimension,
        /// Source from which the unit is known.
        anchor: Anchor,
    },
    /// Value of unknown dimension, or after an error.
    Unknown,
}

impl UnitValue {
    /// Returns a quantity whose unit follows from the motion.
    pub fn quantity_of_dimension(dimension: Dimension) -> UnitValue {
        UnitValue::Quantity { dimension, anchor: Anchor::Motion }
    }

    /// Returns the value of the negated expression.
    pub fn negated_value(self) -> UnitValue {
        match self {
            UnitValue::Number(value) => UnitValue::Number(-value),
            other => other,
        }
    }

    /// Returns a power of the value; unknown if the exponent is unknown.
    pub fn power_of_value(self, exponent: Option<Ratio>) -> UnitValue {
        match self {
            UnitValue::Quantity { dimension, .. } if dimension.is_plain() => {
                UnitValue::quantity_of_dimension(dimension)
            }
            UnitValue::Quantity { dimension, anchor } => {
                match exponent.and_then(|e| dimension.dimension_of_power(e)) {
                    Some(dimension) => UnitValue::Quantity { dimension, anchor },
                    None => UnitValue::Unknown,
                }
            }
            _ => UnitValue::Unknown,
        }
    }

    /// Returns the source of the unit; `Motion` for a value that is not a quantity.
    pub fn source_of_unit(&self) -> Anchor {
        match self {
            UnitValue::Quantity { anchor, .. } => *anchor,
            _ => Anchor::Motion,
        }
    }

    /// Returns the more specific of two values with equal dimensions.
    pub fn more_specific(self, other: UnitValue) -> UnitValue {
        match (&self, &other) {
            (UnitValue::Quantity { .. }, _) => self,
            (_, UnitValue::Quantity { .. }) => other,
            (UnitValue::Unknown, _) | (_, UnitValue::Unknown) => UnitValue::Unknown,
            (UnitValue::Number(_), _) => self,
            _ => other,
        }
    }
}

/// Returns the product of factors, and whether a number among them may have a unit. Marked factors are
/// divisors.
pub fn product_of_values(factors: &[(bool, UnitValue)]) -> (UnitValue, bool) {
    let has_factor_of_kind = |what: fn(&UnitValue) -> bool| factors.iter().any(|(_, f)| what(f));
    // Zero has any unit.
    if factors.iter().any(|(below, f)| !below && matches!(f, UnitValue::Number(0.0))) {
        return (UnitValue::Number(0.0), false);
    }
    if has_factor_of_kind(|f| matches!(f, UnitValue::Unknown)) {
        return (UnitValue::Unknown, false);
    }
    let (is_number, is_direction) = (
        has_factor_of_kind(|f| matches!(f, UnitValue::Number(_))),
        has_factor_of_kind(|f| matches!(f, UnitValue::Direction)),
    );
    let quantities: Vec<_> = factors
        .iter()
        .filter_map(|(below, f)| match f {
            UnitValue::Quantity { dimension, anchor } => Some((*below, dimension, *anchor)),
            _ => None,
        })
        .collect();
    let Some(anchor) = quantities.iter().map(|(.., anchor)| *anchor).max() else {
        return match (is_number, is_direction) {
            (true, false) => (UnitValue::Number(product_of_numbers(factors)), false),
            (true, true) => (UnitValue::Number(f64::NAN), false),
            _ => (UnitValue::Direction, false),
        };
    };
    let product = quantities.iter().try_fold(PLAIN, |product, (below, dimension, _)| {
        product.times_power(dimension, Ratio::from_integer(if *below { -1 } else { 1 }))
    });
    match product {
        Some(dimension) => {
            (UnitValue::Quantity { dimension, anchor }, is_number && anchor != Anchor::Parameter)
        }
        None => (UnitValue::Unknown, false),
    }
}

/// Returns the product of numbers; NaN if another factor is present.
fn product_of_numbers(factors: &[(bool, UnitValue)]) -> f64 {
    let number_of_factor = |f: &UnitValue| if let UnitValue::Number(value) = f { *value } else { f64::NAN };
    factors
        .iter()
        .fold(1.0, |p, (below, f)| if *below { p / number_of_factor(f) } else { p * number_of_factor(f) })
}
