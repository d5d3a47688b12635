//! Expressions → dimensions: every expression is walked once, and what must be alike is equated.
//!
//! A number that is a term or an operand by itself may have any unit, and so may a direction by itself (one
//! metre where a length is expected). A number that multiplies a parameter is a plain factor, except the
//! number of the mechanism's gravity, which is an acceleration. A number that multiplies coordinates, rates,
//! time or inputs alone is a coefficient: it takes the unit that is missing, and is plain otherwise. All
//! terms of a sum have one unit. An argument accepts an expression of coordinates, rates and time alone as a
//! number of the unit that it needs.

use super::unify::{Outcome, System};
use super::value::{Anchor, Value};
use crate::language::dimension::{Dimension, PLAIN, Variable};
use crate::language::ratio::Ratio;
use crate::syntax::{BinaryOp, Description, Expr, ExprKind};
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
    /// The pieces of a law.
    Pieces,
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
    /// A parameter or a definition.
    Named(Variable, Anchor),
    /// A coordinate or an input.
    Moving(Dimension, Anchor),
}

/// Most contradictions that are kept.
const MOST_MISMATCHES: usize = 32;

/// The inference in progress.
pub struct Inference<'a> {
    /// The equations so far.
    pub system: System,
    /// Names of parameters, coordinates, inputs and definitions. The first unknowns are those of the
    /// parameters.
    pub names: BTreeMap<String, Meaning>,
    /// Tables by name: the unknowns of their variables, then of their values.
    pub tables: BTreeMap<String, Vec<Variable>>,
    /// Names of the place at hand, such as `stretch`.
    pub locals: Vec<(&'static str, Dimension)>,
    /// By unknown: what made it known.
    pub origins: BTreeMap<Variable, Origin<'a>>,
    /// By unknown: how its unit is written where it stands alone.
    pub hints: BTreeMap<Variable, String>,
    /// Numbers of the mechanism's gravity, which are accelerations also as factors of parameters.
    pub gravity: Vec<f64>,
    /// What is a plain number unless something else demands a unit; the second one if the first is.
    pub wishes: Vec<(Dimension, Option<Dimension>)>,
    /// Contradictions.
    pub mismatches: Vec<Mismatch<'a>>,
    /// There was too much to do.
    pub gave_up: bool,
}

/// The numbers that gravity is given by, such as 9.81, without signs.
fn numbers_of_gravity(description: &Description) -> Vec<f64> {
    let parts = description.gravity.iter().flat_map(Expr::parts);
    parts.filter_map(Expr::literal).map(f64::abs).filter(|g| *g > 0.0).collect()
}

impl<'a> Inference<'a> {
    /// Begins with the parameters.
    pub fn new(description: &Description) -> Inference<'a> {
        let mut new = Inference {
            system: System::default(),
            names: BTreeMap::new(),
            tables: BTreeMap::new(),
            locals: Vec::new(),
            origins: BTreeMap::new(),
            hints: BTreeMap::new(),
            gravity: numbers_of_gravity(description),
            wishes: Vec::new(),
            mismatches: Vec::new(),
            gave_up: false,
        };
        for parameter in &description.parameters {
            new.name_unknown(&parameter.text, Anchor::Parameter);
        }
        for table in &description.tables {
            let unknown = (0..=table.variables).map(|_| new.system.variable()).collect();
            new.tables.insert(table.name.text.clone(), unknown);
        }
        new
    }

    /// Gives a name an unknown dimension.
    pub fn name_unknown(&mut self, name: &str, anchor: Anchor) {
        let v = self.system.variable();
        self.names.insert(name.to_string(), Meaning::Named(v, anchor));
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
    pub fn differ(&mut self, a: &Dimension, b: &Dimension) -> bool {
        let quotient = a.quotient(b).and_then(|quotient| self.system.resolve(&quotient));
        quotient.is_some_and(|quotient| quotient.is_known() && !quotient.is_plain())
    }

    /// Demands a dimension of an expression. `unit` is how it is written at this place.
    pub fn expect(&mut self, e: &'a Expr, dimension: &Dimension, unit: &str, reason: Reason<'a>) -> Value {
        let value = match &e.kind {
            ExprKind::Binary(BinaryOp::Add | BinaryOp::Sub, ..) => self.sum(e, Some(dimension)),
            _ => self.value(e),
        };
        let Value::Quantity { dimension: found, anchor } = value else { return value };
        // A number in front that is one has any unit.
        if anchor == Anchor::Motion && self.differ(&found, dimension) {
            return Value::Unknown;
        }
        if !self.equate(&found, dimension, Origin { reason, at: e, like: None }) {
            return Value::Unknown;
        }
        if let (Some(v), false) = (self.alone(e), unit.is_empty()) {
            self.hints.entry(v).or_insert_with(|| unit.to_string());
        }
        Value::Quantity { dimension: found, anchor }
    }

    /// The unknown of a name that stands alone.
    fn alone(&self, e: &Expr) -> Option<Variable> {
        let dimension = match &e.kind {
            ExprKind::Neg(inner) => return self.alone(inner),
            ExprKind::Name(name) => match self.names.get(name)? {
                Meaning::Named(v, _) => return Some(*v),
                Meaning::Moving(dimension, _) => dimension,
            },
            _ => return None,
        };
        match dimension.unknown.as_slice() {
            [(v, Ratio::ONE)] if dimension.base == PLAIN.base => Some(*v),
            _ => None,
        }
    }
}
