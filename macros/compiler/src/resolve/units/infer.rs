//! Inference of dimensions: every expression is visited once, and equal dimensions are equated.
//!
//! A number that is a term or an operand by itself may have any unit, and so may a direction by itself (one
//! metre where a length is expected). A number that multiplies a parameter is a plain factor, except the
//! number of the mechanism's gravity, which is an acceleration. A number that multiplies only coordinates,
//! rates, time or inputs is a coefficient: its unit is inferred, and plain if unconstrained. All terms of a
//! sum have one unit. An argument accepts an expression of coordinates, rates and time only as a number of
//! the unit that it needs.

use super::unify::{DimensionSystem, EquationOutcome};
use super::value::{InferredUnit, UnitSource};
use crate::language::dimension::{Dimension, PLAIN, UnknownDimensionIndex};
use crate::language::ratio::Ratio;
use crate::syntax::{BinaryOp, Description, Expr, ExprKind};
use std::collections::BTreeMap;

/// Reason why two dimensions must be equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DimensionEqualityReason<'a> {
    /// The attribute `#[unit(…)]` of a parameter states the dimension.
    Unit,
    /// An argument or a field expects the dimension.
    Place,
    /// An argument of a function must be a plain number.
    Argument,
    /// Terms of a sum must have equal dimensions.
    Sum(BinaryOp),
    /// Components of a vector must have equal dimensions.
    Components,
    /// Arguments that a function compares must have equal dimensions; the name of the function.
    Compared(&'a str),
    /// Pieces of a piecewise law must have equal dimensions.
    Pieces,
}

/// Origin of an equation between dimensions.
#[derive(Clone, Copy, Debug)]
pub struct EquationOrigin<'a> {
    /// Reason for the equation.
    pub reason: DimensionEqualityReason<'a>,
    /// Expression at which an error is reported: the whole operation, an argument, or a component.
    pub expression: &'a Expr,
    /// Second expression of the comparison, if there is one.
    pub compared_with: Option<&'a Expr>,
}

/// Equation between dimensions that contradicts earlier ones.
#[derive(Clone, Debug)]
pub struct DimensionMismatch<'a> {
    /// Origin of the equation.
    pub origin: EquationOrigin<'a>,
    /// Dimension of `origin.expression`, or of the second operand.
    pub found: Dimension,
    /// Expected dimension: that of the context, or of the first operand.
    pub expected: Dimension,
}

/// Meaning of a name for the inference of units.
#[derive(Clone, Debug)]
pub enum UnitMeaningOfName {
    /// The name is a parameter or a definition, whose dimension is an unknown.
    Named(UnknownDimensionIndex, UnitSource),
    /// The name is a coordinate or an input, whose dimension is known.
    Moving(Dimension, UnitSource),
}

/// Maximum number of contradictions between dimensions that are recorded.
const MAX_MISMATCHES: usize = 32;

/// State of the inference of units in a mechanism.
pub struct Inference<'a> {
    /// Equations between dimensions that have been found so far.
    pub system: DimensionSystem,
    /// Meanings of the names of parameters, coordinates, inputs and definitions. The first unknowns are those
    /// of the parameters.
    pub names: BTreeMap<String, UnitMeaningOfName>,
    /// Unknown dimensions of each table, by name: those of its variables, followed by that of its values.
    pub tables: BTreeMap<String, Vec<UnknownDimensionIndex>>,
    /// Local names of the current expression, such as `stretch`.
    pub locals: Vec<(&'static str, Dimension)>,
    /// Origin of the equation that determined each unknown.
    pub origins: BTreeMap<UnknownDimensionIndex, EquationOrigin<'a>>,
    /// Notation of each unknown's unit where its name is the whole expression.
    pub hints: BTreeMap<UnknownDimensionIndex, String>,
    /// Magnitudes of the numbers in the mechanism's gravity, such as 9.81. A factor of this magnitude may
    /// have a dimension, even if it multiplies a parameter.
    pub gravity: Vec<f64>,
    /// Dimensions that are plain numbers unless constrained otherwise. If the first of a pair is plain, so is
    /// the second.
    pub plain_defaults: Vec<(Dimension, Option<Dimension>)>,
    /// Contradictions between dimensions that have been found so far.
    pub mismatches: Vec<DimensionMismatch<'a>>,
    /// Whether the limit on the work of the inference was exceeded.
    pub limit_exceeded: bool,
}

/// Returns the magnitudes of the numbers in the mechanism's gravity, such as 9.81.
fn numbers_in_gravity(description: &Description) -> Vec<f64> {
    let parts = description.gravity.iter().flat_map(Expr::all_subexpressions);
    parts.filter_map(Expr::literal_number).map(f64::abs).filter(|g| *g > 0.0).collect()
}

impl<'a> Inference<'a> {
    /// Begins the inference with the parameters and tables.
    pub fn new(description: &Description) -> Inference<'a> {
        let mut new = Inference {
            system: DimensionSystem::default(),
            names: BTreeMap::new(),
            tables: BTreeMap::new(),
            locals: Vec::new(),
            origins: BTreeMap::new(),
            hints: BTreeMap::new(),
            gravity: numbers_in_gravity(description),
            plain_defaults: Vec::new(),
            mismatches: Vec::new(),
            limit_exceeded: false,
        };
        for parameter in &description.parameters {
            new.assign_unknown_dimension(&parameter.text, UnitSource::Parameter);
        }
        for table in &description.tables {
            let unknown = (0..=table.variables).map(|_| new.system.add_unknown_dimension()).collect();
            new.tables.insert(table.name.text.clone(), unknown);
        }
        new
    }

    /// Assigns an unknown dimension to a name.
    pub fn assign_unknown_dimension(&mut self, name: &str, anchor: UnitSource) {
        let v = self.system.add_unknown_dimension();
        self.names.insert(name.to_string(), UnitMeaningOfName::Named(v, anchor));
    }

    /// Equates two dimensions; returns false if they contradict each other.
    pub fn equate_dimensions(
        &mut self,
        found: &Dimension,
        expected: &Dimension,
        origin: EquationOrigin<'a>,
    ) -> bool {
        if self.limit_exceeded {
            return true;
        }
        match self.system.equate_dimensions(found, expected) {
            EquationOutcome::Holds(known) => {
                for v in known {
                    self.origins.entry(v).or_insert(origin);
                }
                true
            }
            EquationOutcome::Contradicts => {
                if self.mismatches.len() < MAX_MISMATCHES {
                    self.mismatches.push(DimensionMismatch {
                        origin,
                        found: found.clone(),
                        expected: expected.clone(),
                    });
                }
                false
            }
            EquationOutcome::LimitExceeded => {
                self.limit_exceeded = true;
                true
            }
        }
    }

    /// Makes a dimension plain at the end if it is not constrained otherwise.
    pub fn default_to_plain(&mut self, dimension: Dimension) {
        self.plain_defaults.push((dimension, None));
    }

    /// Applies the defaults of plain numbers that contradict nothing, in order.
    pub fn make_plain_numbers_dimensionless(&mut self) {
        for (wish, then) in std::mem::take(&mut self.plain_defaults) {
            if self.system.equate_dimensions(&wish, &PLAIN) != EquationOutcome::Contradicts
                && let Some(then) = then
            {
                self.system.equate_dimensions(&then, &PLAIN);
            }
        }
    }

    /// Whether two dimensions are known to be different.
    pub fn are_different_dimensions(&mut self, a: &Dimension, b: &Dimension) -> bool {
        let quotient =
            a.dimension_of_quotient(b).and_then(|quotient| self.system.substitute_solved_unknowns(&quotient));
        quotient.is_some_and(|quotient| quotient.is_known() && !quotient.is_plain())
    }

    /// Equates the dimension of an expression with an expected one; `unit` is its notation in this context.
    pub fn equate_with_expected_dimension(
        &mut self,
        e: &'a Expr,
        dimension: &Dimension,
        unit: &str,
        reason: DimensionEqualityReason<'a>,
    ) -> InferredUnit {
        let value = match &e.kind {
            ExprKind::Binary(BinaryOp::Add | BinaryOp::Sub, ..) => {
                self.inferred_unit_of_sum(e, Some(dimension))
            }
            _ => self.inferred_unit_of_expression(e),
        };
        let InferredUnit::Quantity { dimension: found, anchor } = value else { return value };
        // An expression of coordinates may have an implicit factor of one, with any unit.
        if anchor == UnitSource::Motion && self.are_different_dimensions(&found, dimension) {
            return InferredUnit::Unknown;
        }
        if !self.equate_dimensions(
            &found,
            dimension,
            EquationOrigin { reason, expression: e, compared_with: None },
        ) {
            return InferredUnit::Unknown;
        }
        if let (Some(v), false) = (self.unit_unknown_of_name(e), unit.is_empty()) {
            self.hints.entry(v).or_insert_with(|| unit.to_string());
        }
        InferredUnit::Quantity { dimension: found, anchor }
    }

    /// Returns the unknown of an expression that is a single name.
    fn unit_unknown_of_name(&self, e: &Expr) -> Option<UnknownDimensionIndex> {
        let dimension = match &e.kind {
            ExprKind::Neg(inner) => return self.unit_unknown_of_name(inner),
            ExprKind::Name(name) => match self.names.get(name)? {
                UnitMeaningOfName::Named(v, _) => return Some(*v),
                UnitMeaningOfName::Moving(dimension, _) => dimension,
            },
            _ => return None,
        };
        match dimension.unknown.as_slice() {
            [(v, Ratio::ONE)] if dimension.base == PLAIN.base => Some(*v),
            _ => None,
        }
    }
}
