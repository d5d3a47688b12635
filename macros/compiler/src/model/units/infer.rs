//! Expressions → dimensions: every expression is walked once, and what must be alike is equated.
//!
//! A number stands for a quantity of any unit, and so does a direction that stands alone (it means one metre where a
//! length is expected). As a factor beside a named quantity, a number of formulas (2, ½, ¹⁄₁₂, π) is a plain number;
//! others take a unit where nothing else fits, and are plain numbers otherwise. An expression without any parameter may
//! mean figures of a problem whose units are one: it is held to nothing.

use super::ratio::Ratio;
use super::si::{ACCELERATION, LENGTH, PLAIN, RATE, RATE_OF_RATE, SPEED, TIME};
use super::unify::{Dimension, Outcome, System, Variable};
use super::value::{Value, product};
use crate::expr::Function;
use crate::syntax::{BinaryOp, Description, Expr, ExprKind, Name};
use std::collections::BTreeMap;

/// What an equation between dimensions comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason<'a> {
    /// `#[unit(…)]`.
    Unit,
    /// The place that the expression stands at.
    Place,
    /// The argument of a function that takes plain numbers.
    Argument,
    /// The terms of a sum.
    Sum(BinaryOp),
    /// The components of a vector.
    Components,
    /// The arguments of a function that are compared.
    Alike(&'a str),
}

/// Where an equation stands.
#[derive(Clone, Copy, Debug)]
pub struct Origin<'a> {
    /// What it comes from.
    pub reason: Reason<'a>,
    /// The expression where it shows: an operator's whole, an argument, a component.
    pub at: &'a Expr,
    /// The expression that it is like.
    pub like: Option<&'a Expr>,
}

/// An equation that contradicts others.
#[derive(Clone, Debug)]
pub struct Mismatch<'a> {
    /// Where it stands.
    pub origin: Origin<'a>,
    /// The dimension of `origin.at`, or of the second of two things.
    pub found: Dimension,
    /// What it should be, or the dimension of the first of two things.
    pub expected: Dimension,
}

/// What a name stands for.
#[derive(Clone, Debug)]
pub enum Meaning {
    /// A parameter or a definition; true if it owes its unit to a parameter.
    Named(Variable, bool),
    /// A coordinate or an input.
    Moving(Dimension),
}

/// Most contradictions that are kept.
const MOST_MISMATCHES: usize = 32;

/// The inference in progress.
pub struct Inference<'a> {
    /// The equations so far.
    pub system: System,
    /// Names of parameters, coordinates, inputs and definitions. The first unknowns are those of the parameters.
    pub names: BTreeMap<String, Meaning>,
    /// Names of the place at hand, such as `stretch`.
    pub locals: Vec<(&'static str, Dimension)>,
    /// By unknown: what made it known.
    pub origins: BTreeMap<Variable, Origin<'a>>,
    /// By unknown: how its unit is written where it stands alone.
    pub hints: BTreeMap<Variable, String>,
    /// What is a plain number unless something else demands a unit; the second one if the first is.
    wishes: Vec<(Dimension, Option<Dimension>)>,
    /// Terms that are not alike, in expressions without parameters.
    unlike: Vec<Mismatch<'a>>,
    /// Contradictions.
    pub mismatches: Vec<Mismatch<'a>>,
    /// There was too much to do.
    pub gave_up: bool,
}

impl<'a> Inference<'a> {
    /// Begins with the parameters.
    pub fn new(description: &Description) -> Inference<'a> {
        let mut new = Inference {
            system: System::default(),
            names: BTreeMap::new(),
            locals: Vec::new(),
            origins: BTreeMap::new(),
            hints: BTreeMap::new(),
            wishes: Vec::new(),
            unlike: Vec::new(),
            mismatches: Vec::new(),
            gave_up: false,
        };
        for parameter in &description.parameters {
            new.name_unknown(&parameter.text, true);
        }
        new
    }

    /// Gives a name an unknown dimension.
    pub fn name_unknown(&mut self, name: &str, named: bool) -> Variable {
        let v = self.system.variable();
        self.names.insert(name.to_string(), Meaning::Named(v, named));
        v
    }

    /// Demands that two dimensions are the same; false if they cannot be.
    pub fn equate(&mut self, found: &Dimension, expected: &Dimension, origin: Origin<'a>) -> bool {
        if self.gave_up {
            return true;
        }
        match self.system.equate(found, expected) {
            Outcome::Holds(known) => {
                for v in known {
                    self.origins.entry(v).or_insert(origin);
                }
                true
            }
            Outcome::Contradicts => {
                if self.mismatches.len() < MOST_MISMATCHES {
                    self.mismatches.push(Mismatch {
                        origin,
                        found: found.clone(),
                        expected: expected.clone(),
                    });
                }
                false
            }
            Outcome::GaveUp => {
                self.gave_up = true;
                true
            }
        }
    }

    /// Lets something be a plain number if nothing else demands a unit of it.
    pub fn wish(&mut self, dimension: Dimension) {
        self.wishes.push((dimension, None));
    }

    /// Grants the wishes that contradict nothing, in order.
    pub fn grant(&mut self) {
        for (wish, then) in std::mem::take(&mut self.wishes) {
            if self.system.equate(&wish, &PLAIN) != Outcome::Contradicts
                && let Some(then) = then
            {
                self.system.equate(&then, &PLAIN);
            }
        }
    }

    /// True if two dimensions are known to be different.
    fn differ(&mut self, a: &Dimension, b: &Dimension) -> bool {
        let quotient = a.over(b).and_then(|quotient| self.system.resolve(&quotient));
        quotient.is_some_and(|quotient| quotient.is_known() && !quotient.is_plain())
    }

    /// Demands a dimension of an expression. `unit` is how it is written at this place.
    pub fn expect(&mut self, e: &'a Expr, dimension: &Dimension, unit: &str, reason: Reason<'a>) -> Value {
        let value = self.value(e);
        let Value::Quantity { dimension: found, named } = value else { return value };
        // What no parameter gives a unit may have a number in front that is one.
        if !named && self.differ(&found, dimension) {
            return Value::Unknown;
        }
        if !self.equate(&found, dimension, Origin { reason, at: e, like: None }) {
            return Value::Unknown;
        }
        if let (Some(v), false) = (self.alone(e), unit.is_empty()) {
            self.hints.entry(v).or_insert_with(|| unit.to_string());
        }
        Value::Quantity { dimension: found, named }
    }

    /// The unknown of a name that stands alone.
    fn alone(&self, e: &Expr) -> Option<Variable> {
        let dimension = match &e.kind {
            ExprKind::Neg(inner) => return self.alone(inner),
            ExprKind::Name(name) => match self.names.get(name)? {
                Meaning::Named(v, _) => return Some(*v),
                Meaning::Moving(dimension) => dimension,
            },
            _ => return None,
        };
        match dimension.unknown.as_slice() {
            [(v, Ratio::ONE)] if dimension.base == PLAIN.base => Some(*v),
            _ => None,
        }
    }

    /// The dimension of an expression.
    pub fn value(&mut self, e: &'a Expr) -> Value {
        match &e.kind {
            ExprKind::Number(n) => Value::number(*n),
            ExprKind::Name(name) => self.name(name),
            ExprKind::Field(inner, member) => self.member(inner, member),
            ExprKind::Neg(inner) => self.value(inner).negated(),
            ExprKind::Binary(BinaryOp::Mul | BinaryOp::Div, ..) => self.product(e),
            ExprKind::Binary(op, left, right, _) => {
                let (a, b) = (self.value(left), self.value(right));
                let origin = Origin { reason: Reason::Sum(*op), at: e, like: None };
                match self.alike(a, b, origin) {
                    Value::Number { .. } => Value::other_number(f64::NAN),
                    other => other,
                }
            }
            ExprKind::Call(function, arguments) => self.call(function, arguments),
            ExprKind::Array(items) => self.all_alike(items, Reason::Components),
            ExprKind::Method(..) | ExprKind::Tuple(_) => Value::Unknown,
        }
    }

    fn name(&self, name: &str) -> Value {
        if let Some(Meaning::Named(v, named)) = self.names.get(name)
            && !self.locals.iter().any(|(local, _)| *local == name)
        {
            return Value::Quantity { dimension: Dimension::variable(*v), named: *named };
        }
        let moving = match name {
            "x" | "y" | "z" => return Value::Direction,
            "pi" => return Value::formula(std::f64::consts::PI),
            _ => self.locals.iter().find(|(local, _)| *local == name).map(|(_, d)| d.clone()),
        };
        match (moving, name, self.names.get(name)) {
            (Some(dimension), ..) => Value::quantity(dimension),
            (None, "t", _) => Value::quantity(TIME),
            (None, _, Some(Meaning::Moving(dimension))) => Value::quantity(dimension.clone()),
            _ => Value::Unknown,
        }
    }

    /// A coordinate of a joint, or the axis of a frame.
    fn member(&self, inner: &Expr, member: &Name) -> Value {
        let ExprKind::Name(joint) = &inner.kind else { return Value::Unknown };
        match self.names.get(&format!("{joint}.{}", member.text)) {
            Some(Meaning::Moving(dimension)) => Value::quantity(dimension.clone()),
            _ => Value::Direction,
        }
    }

    /// Demands that two values are alike; returns what they are.
    fn alike(&mut self, a: Value, b: Value, origin: Origin<'a>) -> Value {
        let (Value::Quantity { dimension, named }, Value::Quantity { dimension: other, named: too }) =
            (&a, &b)
        else {
            self.check_mixed(&[&a, &b]);
            return a.or(b);
        };
        if !named && !too && self.differ(dimension, other) {
            self.unlike.push(Mismatch { origin, found: other.clone(), expected: dimension.clone() });
            return Value::Mixed(self.unlike.len() - 1);
        }
        match self.equate(other, dimension, origin) {
            true => Value::Quantity { dimension: dimension.clone(), named: *named || *too },
            false => Value::Unknown,
        }
    }

    /// Beside a parameter, terms that are not alike are a mistake.
    fn check_mixed(&mut self, values: &[&Value]) {
        if !values.iter().any(|value| value.is_named()) {
            return;
        }
        for value in values {
            if let Value::Mixed(k) = value
                && let Some(mismatch) = self.unlike.get(*k)
                && self.mismatches.len() < MOST_MISMATCHES
            {
                self.mismatches.push(mismatch.clone());
            }
        }
    }

    /// The common dimension of several expressions.
    fn all_alike(&mut self, items: &'a [Expr], reason: Reason<'a>) -> Value {
        let mut first: Option<&Expr> = None;
        let mut common = Value::number(0.0);
        for item in items {
            let value = self.value(item);
            let is_quantity = matches!(value, Value::Quantity { .. });
            common = self.alike(common, value, Origin { reason, at: item, like: first });
            first = first.or(is_quantity.then_some(item));
        }
        match common {
            Value::Number { .. } => Value::other_number(f64::NAN),
            other => other,
        }
    }

    /// A product or quotient of any number of factors.
    fn product(&mut self, e: &'a Expr) -> Value {
        let mut written = Vec::new();
        let mut at = e;
        while let ExprKind::Binary(op @ (BinaryOp::Mul | BinaryOp::Div), left, right, _) = &at.kind {
            written.push((*op == BinaryOp::Div, &**right));
            at = left;
        }
        written.push((false, at));
        let factors: Vec<(bool, Value)> =
            written.into_iter().rev().map(|(below, factor)| (below, self.value(factor))).collect();
        self.multiply(&factors)
    }

    /// The product of factors; those marked divide.
    fn multiply(&mut self, factors: &[(bool, Value)]) -> Value {
        self.check_mixed(&factors.iter().map(|(_, f)| f).collect::<Vec<_>>());
        let (value, free) = product(factors);
        let (Value::Quantity { dimension, named }, true) = (&value, free) else { return value };
        let number = Dimension::variable(self.system.variable());
        self.wish(number.clone());
        match dimension.times(&number) {
            Some(dimension) => Value::Quantity { dimension, named: *named },
            None => Value::Unknown,
        }
    }

    fn call(&mut self, function: &'a Name, arguments: &'a [Expr]) -> Value {
        let text = function.text.as_str();
        match (text, arguments) {
            ("abs", [a]) => self.value(a),
            ("signum", [a]) => {
                self.value(a);
                Value::quantity(PLAIN)
            }
            ("sqrt", [a]) => match self.value(a) {
                Value::Number { value, .. } => Value::other_number(value.sqrt()),
                other => other.power(Ratio::new(1, 2)),
            },
            ("pow", [a, n]) => self.power(a, n),
            ("min" | "max", _) => self.all_alike(arguments, Reason::Alike(text)),
            ("atan2", _) => match self.all_alike(arguments, Reason::Alike(text)) {
                Value::Quantity { .. } => Value::quantity(PLAIN),
                _ => Value::formula(f64::NAN),
            },
            ("dot" | "cross", _) => {
                let factors: Vec<_> = arguments.iter().map(|a| (false, self.value(a))).collect();
                self.multiply(&factors)
            }
            ("norm", [a]) => match self.value(a) {
                Value::Direction => Value::quantity(PLAIN),
                other => other,
            },
            ("project", [a, n]) => {
                self.value(n);
                self.value(a)
            }
            ("unit", [a]) => {
                self.value(a);
                Value::Direction
            }
            ("angle", _) => {
                arguments.iter().for_each(|a| drop(self.value(a)));
                Value::quantity(PLAIN)
            }
            ("rate", [a]) => match self.value(a) {
                Value::Quantity { dimension, named } => match dimension.over(&TIME) {
                    Some(dimension) => Value::Quantity { dimension, named },
                    None => Value::Unknown,
                },
                other => other,
            },
            ("r" | "v" | "a" | "omega" | "alpha", [a]) => self.slash(text, a),
            (_, [a]) => self.elementary(text, a),
            _ => Value::Unknown,
        }
    }

    /// A function of a plain number.
    fn elementary(&mut self, text: &str, a: &'a Expr) -> Value {
        let Some((_, f)) = Function::ALL.iter().find(|(name, _)| *name == text) else {
            return Value::Unknown;
        };
        let unit = if matches!(text, "sin" | "cos" | "tan") { "rad" } else { "1" };
        match self.expect(a, &PLAIN, unit, Reason::Argument) {
            Value::Number { value, .. } => Value::formula(f.apply(value)),
            Value::Direction => Value::Unknown,
            _ => Value::quantity(PLAIN),
        }
    }

    /// A power: with an exponent that is no number, nothing is known of it unless its base is plain in the end.
    fn power(&mut self, a: &'a Expr, n: &'a Expr) -> Value {
        let base = self.value(a);
        let exponent = self.expect(n, &PLAIN, "1", Reason::Argument);
        match (base, exponent) {
            (Value::Number { value, .. }, Value::Number { value: n, .. }) => {
                Value::other_number(value.powf(n))
            }
            (Value::Number { .. }, _) => Value::quantity(PLAIN),
            (base, Value::Number { value, .. }) => base.power(Ratio::of(value)),
            (Value::Mixed(k), _) => Value::Mixed(k),
            (Value::Quantity { dimension, named }, _) => {
                let power = Dimension::variable(self.system.variable());
                self.wishes.push((dimension, Some(power.clone())));
                Value::Quantity { dimension: power, named }
            }
            _ => Value::Unknown,
        }
    }

    /// `r(y / x)` and its kin; the points in it may be placed by vectors.
    fn slash(&mut self, text: &str, e: &'a Expr) -> Value {
        let mut at = e;
        while let ExprKind::Binary(BinaryOp::Div, left, right, _) = &at.kind {
            self.point(right);
            at = left;
        }
        self.point(at);
        Value::quantity(match text {
            "r" => LENGTH,
            "v" => SPEED,
            "a" => ACCELERATION,
            "omega" => RATE,
            _ => RATE_OF_RATE,
        })
    }

    /// A place: `body.at(vector)`.
    pub fn point(&mut self, e: &'a Expr) {
        if let ExprKind::Method(base, _, arguments) = &e.kind {
            self.point(base);
            for argument in arguments {
                self.expect(argument, &LENGTH, "m", Reason::Place);
            }
        }
    }
}
