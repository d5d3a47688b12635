//! What an expression is as far as units go: a number, a direction or a quantity; and products of them.

use super::ratio::Ratio;
use super::si::PLAIN;
use super::unify::Dimension;

/// What is known of an expression.
#[derive(Clone, Debug)]
pub enum Value {
    /// A number: it has any unit.
    Number {
        /// Its value; NaN if nobody asks for it.
        value: f64,
        /// A number of formulas, which is a plain one beside a named quantity.
        formula: bool,
    },
    /// A direction: it has any unit alone, and none as a factor.
    Direction,
    /// A quantity.
    Quantity {
        /// Its dimension.
        dimension: Dimension,
        /// A parameter or a definition gives it its unit.
        named: bool,
    },
    /// Terms without parameters that are not alike: the index of the mismatch that they are beside a parameter. Alone
    /// they are taken as figures of a problem whose units are one.
    Mixed(usize),
    /// Nothing is known, or a mistake was found.
    Unknown,
}

impl Value {
    /// A number as written.
    pub fn number(value: f64) -> Value {
        let small = |x: f64| (2.0..=6.0).contains(&x) && (x - x.round()).abs() < 1e-12;
        Value::Number { value, formula: small(value.abs()) || small(1.0 / value.abs()) }
    }

    /// A number of formulas.
    pub fn formula(value: f64) -> Value {
        Value::Number { value, formula: true }
    }

    /// A number that may have a unit.
    pub fn other_number(value: f64) -> Value {
        Value::Number { value, formula: false }
    }

    /// A quantity that owes its unit to no parameter.
    pub fn quantity(dimension: Dimension) -> Value {
        Value::Quantity { dimension, named: false }
    }

    /// The same with the other sign.
    pub fn negated(self) -> Value {
        match self {
            Value::Number { value, formula } => Value::Number { value: -value, formula },
            other => other,
        }
    }

    /// A power of it; unknown if the exponent is.
    pub fn power(self, exponent: Option<Ratio>) -> Value {
        match self {
            Value::Quantity { dimension, .. } if dimension.is_plain() => Value::quantity(dimension),
            Value::Quantity { dimension, named } => match exponent.and_then(|e| dimension.power(e)) {
                Some(dimension) => Value::Quantity { dimension, named },
                None => Value::Unknown,
            },
            Value::Mixed(_) => self,
            _ => Value::Unknown,
        }
    }

    /// True for a quantity that owes its unit to a parameter.
    pub fn is_named(&self) -> bool {
        matches!(self, Value::Quantity { named: true, .. })
    }

    /// Of two things that are alike, the one that says more.
    pub fn or(self, other: Value) -> Value {
        match (&self, &other) {
            (Value::Quantity { .. }, _) => self,
            (_, Value::Quantity { .. }) => other,
            (Value::Unknown, _) | (_, Value::Unknown) => Value::Unknown,
            (Value::Mixed(_), _) => self,
            (_, Value::Mixed(_)) => other,
            (Value::Number { .. }, _) => self,
            _ => other,
        }
    }
}

/// The product of factors, of which those marked divide; and whether a number among them may give it another unit.
pub fn product(factors: &[(bool, Value)]) -> (Value, bool) {
    let has = |what: fn(&Value) -> bool| factors.iter().any(|(_, f)| what(f));
    // Nothing has any unit.
    if factors.iter().any(|(below, f)| !below && matches!(f, Value::Number { value: 0.0, .. })) {
        return (Value::number(0.0), false);
    }
    if has(|f| matches!(f, Value::Unknown)) {
        return (Value::Unknown, false);
    }
    if let Some((_, mixed)) = factors.iter().find(|(_, f)| matches!(f, Value::Mixed(_))) {
        let known = if has(Value::is_named) { Value::Unknown } else { mixed.clone() };
        return (known, false);
    }
    let is_number = has(|f| matches!(f, Value::Number { .. }));
    let formula = (0..factors.len()).all(|k| is_plain_factor(factors, k));
    let mut quantities = factors.iter().filter_map(|(below, f)| match f {
        Value::Quantity { dimension, named } => Some((*below, dimension, *named)),
        _ => None,
    });
    let Some((below, first, named)) = quantities.next() else {
        return match (is_number, has(|f| matches!(f, Value::Direction))) {
            (true, false) => (Value::Number { value: number(factors), formula }, false),
            (true, true) => (Value::other_number(f64::NAN), false),
            _ => (Value::Direction, false),
        };
    };
    let sign = |below: bool| Ratio::integer(if below { -1 } else { 1 });
    let mut product = PLAIN.times_power(first, sign(below));
    let mut any_named = named;
    for (below, dimension, named) in quantities {
        product = product.and_then(|p| p.times_power(dimension, sign(below)));
        any_named |= named;
    }
    match product {
        Some(dimension) => {
            (Value::Quantity { dimension, named: any_named }, is_number && !(any_named && formula))
        }
        None => (Value::Unknown, false),
    }
}

/// True for factors that are no numbers, numbers of formulas, integers that divide, and a one over them.
fn is_plain_factor(factors: &[(bool, Value)], k: usize) -> bool {
    let integer = |x: f64| x.fract() == 0.0;
    match factors.get(k) {
        Some((below, Value::Number { value, formula })) => {
            let divided =
                matches!(factors.get(k + 1), Some((true, Value::Number { value, .. })) if integer(*value));
            *formula || (*below && integer(*value)) || (!*below && value.abs() == 1.0 && divided)
        }
        _ => true,
    }
}

/// The product of numbers.
fn number(factors: &[(bool, Value)]) -> f64 {
    let value = |f: &Value| if let Value::Number { value, .. } = f { *value } else { f64::NAN };
    factors.iter().fold(1.0, |p, (below, f)| if *below { p / value(f) } else { p * value(f) })
}
