//! What an expression is as far as units go: a number, a direction or a quantity; and products of them.

use crate::language::dimension::{Dimension, PLAIN};
use crate::language::ratio::Ratio;

/// Source of a quantity's unit, in rising order: a product or a sum has the highest source of its factors or
/// terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Anchor {
    /// Coordinates, rates and time: a number that multiplies them is a coefficient with any unit, and by
    /// themselves they may be numbers of another unit.
    Motion,
    /// An input, which has the unit of the quantity that it acts on: a number that multiplies it is a
    /// coefficient with any unit.
    Input,
    /// A parameter: a number that multiplies it is a plain factor.
    Parameter,
}

/// What is known of an expression.
#[derive(Clone, Debug)]
pub enum Value {
    /// A number: it has any unit.
    Number(f64),
    /// A direction: it has any unit alone, and none as a factor.
    Direction,
    /// A quantity.
    Quantity {
        /// Its dimension.
        dimension: Dimension,
        /// Source of the unit.
        anchor: Anchor,
    },
    /// The dimension is unknown, or an error was found.
    Unknown,
}

impl Value {
    /// A quantity whose unit follows from the motion.
    pub fn quantity(dimension: Dimension) -> Value {
        Value::Quantity { dimension, anchor: Anchor::Motion }
    }

    /// The same with the other sign.
    pub fn negated(self) -> Value {
        match self {
            Value::Number(value) => Value::Number(-value),
            other => other,
        }
    }

    /// A power of it; unknown if the exponent is.
    pub fn power(self, exponent: Option<Ratio>) -> Value {
        match self {
            Value::Quantity { dimension, .. } if dimension.is_plain() => Value::quantity(dimension),
            Value::Quantity { dimension, anchor } => match exponent.and_then(|e| dimension.power(e)) {
                Some(dimension) => Value::Quantity { dimension, anchor },
                None => Value::Unknown,
            },
            _ => Value::Unknown,
        }
    }

    /// Returns the source of the unit; `Motion` for a value that is no quantity.
    pub fn anchor(&self) -> Anchor {
        match self {
            Value::Quantity { anchor, .. } => *anchor,
            _ => Anchor::Motion,
        }
    }

    /// Of two things that are alike, the one that says more.
    pub fn or(self, other: Value) -> Value {
        match (&self, &other) {
            (Value::Quantity { .. }, _) => self,
            (_, Value::Quantity { .. }) => other,
            (Value::Unknown, _) | (_, Value::Unknown) => Value::Unknown,
            (Value::Number(_), _) => self,
            _ => other,
        }
    }
}

/// The product of factors, of which those marked divide; and whether a number among them may give it another
/// unit.
pub fn product(factors: &[(bool, Value)]) -> (Value, bool) {
    let has = |what: fn(&Value) -> bool| factors.iter().any(|(_, f)| what(f));
    // Nothing has any unit.
    if factors.iter().any(|(below, f)| !below && matches!(f, Value::Number(0.0))) {
        return (Value::Number(0.0), false);
    }
    if has(|f| matches!(f, Value::Unknown)) {
        return (Value::Unknown, false);
    }
    let (is_number, is_direction) =
        (has(|f| matches!(f, Value::Number(_))), has(|f| matches!(f, Value::Direction)));
    let quantities: Vec<_> = factors
        .iter()
        .filter_map(|(below, f)| match f {
            Value::Quantity { dimension, anchor } => Some((*below, dimension, *anchor)),
            _ => None,
        })
        .collect();
    let Some(anchor) = quantities.iter().map(|(.., anchor)| *anchor).max() else {
        return match (is_number, is_direction) {
            (true, false) => (Value::Number(number(factors)), false),
            (true, true) => (Value::Number(f64::NAN), false),
            _ => (Value::Direction, false),
        };
    };
    let product = quantities.iter().try_fold(PLAIN, |product, (below, dimension, _)| {
        product.times_power(dimension, Ratio::integer(if *below { -1 } else { 1 }))
    });
    match product {
        Some(dimension) => (Value::Quantity { dimension, anchor }, is_number && anchor != Anchor::Parameter),
        None => (Value::Unknown, false),
    }
}

/// The product of numbers.
fn number(factors: &[(bool, Value)]) -> f64 {
    let value = |f: &Value| if let Value::Number(value) = f { *value } else { f64::NAN };
    factors.iter().fold(1.0, |p, (below, f)| if *below { p / value(f) } else { p * value(f) })
}
