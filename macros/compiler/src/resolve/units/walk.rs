//! Traversal of expressions for the inference of units: values of subexpressions, and equations between their
//! dimensions.

use super::infer::{DimensionEqualityReason, EquationOrigin, Inference, UnitMeaningOfName};
use super::value::{InferredUnit, UnitSource, unit_of_product};
use crate::expr::Function;
use crate::language::dimension::{Dimension, INERTIA, LENGTH, PLAIN, RATE, TIME, UnknownDimensionIndex};
use crate::language::ratio::Ratio;
use crate::language::{Builtin, Callable, UnitRule};
use crate::syntax::{BinaryOp, Callee, Expr, ExprKind, Name};

impl<'a> Inference<'a> {
    /// Returns the inferred unit of an expression.
    pub fn inferred_unit_of_expression(&mut self, e: &'a Expr) -> InferredUnit {
        match &e.kind {
            ExprKind::Number(n) => InferredUnit::Number(*n),
            ExprKind::Name(name) => self.inferred_unit_of_name(name),
            ExprKind::Field(inner, member) => self.inferred_unit_of_member(inner, member),
            ExprKind::Neg(inner) => self.inferred_unit_of_expression(inner).unit_of_negation(),
            ExprKind::Binary(BinaryOp::Mul | BinaryOp::Div, ..) => self.inferred_unit_of_product(e),
            ExprKind::Binary(..) => self.inferred_unit_of_sum(e, None),
            ExprKind::Call(function, arguments) => self.inferred_unit_of_call(function, arguments),
            ExprKind::Array(items) => self.equate_to_common_unit(items, DimensionEqualityReason::Components),
            ExprKind::Method(..) | ExprKind::Tuple(_) | ExprKind::Text(_) => InferredUnit::Unknown,
        }
    }

    fn inferred_unit_of_name(&self, name: &str) -> InferredUnit {
        if let Some((_, dimension)) = self.locals.iter().find(|(local, _)| *local == name) {
            return InferredUnit::known_from_motion(dimension.clone());
        }
        match (Builtin::find_by_name(name), self.names.get(name)) {
            (_, Some(UnitMeaningOfName::Named(v, anchor))) => {
                InferredUnit::Quantity { dimension: Dimension::unknown_dimension(*v), anchor: *anchor }
            }
            (Some(Builtin::Axis(_)), _) => InferredUnit::Direction,
            (Some(Builtin::Pi), _) => InferredUnit::Number(std::f64::consts::PI),
            (Some(Builtin::Time), _) => InferredUnit::known_from_motion(TIME),
            (_, Some(UnitMeaningOfName::Moving(dimension, anchor))) => {
                InferredUnit::Quantity { dimension: dimension.clone(), anchor: *anchor }
            }
            _ => InferredUnit::Unknown,
        }
    }

    /// Returns the inferred unit of a coordinate of a joint, or of an axis of a frame.
    fn inferred_unit_of_member(&self, inner: &Expr, member: &Name) -> InferredUnit {
        let ExprKind::Name(joint) = &inner.kind else { return InferredUnit::Unknown };
        match self.names.get(&format!("{joint}.{}", member.text)) {
            Some(UnitMeaningOfName::Moving(dimension, _)) => {
                InferredUnit::known_from_motion(dimension.clone())
            }
            _ => InferredUnit::Direction,
        }
    }

    /// Equates the dimensions of two values; returns the common value.
    fn equate_values(
        &mut self,
        a: InferredUnit,
        b: InferredUnit,
        origin: EquationOrigin<'a>,
    ) -> InferredUnit {
        let (
            InferredUnit::Quantity { dimension, anchor },
            InferredUnit::Quantity { dimension: other, anchor: second },
        ) = (&a, &b)
        else {
            return a.more_specific_unit(b);
        };
        match self.equate_dimensions(other, dimension, origin) {
            true => InferredUnit::Quantity { dimension: dimension.clone(), anchor: *anchor.max(second) },
            false => InferredUnit::Unknown,
        }
    }

    /// Equates the units of several expressions and returns the common unit.
    fn equate_to_common_unit(
        &mut self,
        items: &'a [Expr],
        reason: DimensionEqualityReason<'a>,
    ) -> InferredUnit {
        let mut first: Option<&Expr> = None;
        let mut common = InferredUnit::Number(0.0);
        for item in items {
            let value = self.inferred_unit_of_expression(item);
            let is_quantity = matches!(value, InferredUnit::Quantity { .. });
            common = self.equate_values(
                common,
                value,
                EquationOrigin { reason, expression: item, compared_with: first },
            );
            first = first.or(is_quantity.then_some(item));
        }
        match common {
            InferredUnit::Number(_) => InferredUnit::Number(f64::NAN),
            other => other,
        }
    }

    /// Returns the inferred unit of a sum of any number of terms. If a term has a parameter or an input,
    /// terms of unknown dimension get the expected dimension, so that an error is reported at the other term.
    pub fn inferred_unit_of_sum(&mut self, e: &'a Expr, expected: Option<&Dimension>) -> InferredUnit {
        let mut written = Vec::new();
        let mut current = e;
        while let ExprKind::Binary(op @ (BinaryOp::Add | BinaryOp::Sub), left, right, _) = &current.kind {
            written.push((Some((DimensionEqualityReason::Sum(*op), current)), &**right));
            current = left;
        }
        written.push((None, current));
        let terms: Vec<_> = written
            .into_iter()
            .rev()
            .map(|(sum, term)| (sum, term, self.inferred_unit_of_expression(term)))
            .collect();
        let is_anchored = terms.iter().any(|(.., value)| value.source_of_unit() > UnitSource::Motion);
        for (_, term, value) in &terms {
            if let (InferredUnit::Quantity { dimension, .. }, Some(expected), true) =
                (value, expected, is_anchored)
                && self.system.substitute_solved_unknowns(dimension).is_some_and(|d| !d.is_known())
            {
                self.equate_dimensions(
                    dimension,
                    expected,
                    EquationOrigin {
                        reason: DimensionEqualityReason::Place,
                        expression: term,
                        compared_with: None,
                    },
                );
            }
        }
        let mut terms = terms.into_iter();
        let first = terms.next().map_or(InferredUnit::Unknown, |(.., value)| value);
        let total = terms.fold(first, |total, (sum, term, value)| {
            let (reason, current) = sum.unwrap_or((DimensionEqualityReason::Place, term));
            self.equate_values(
                total,
                value,
                EquationOrigin { reason, expression: current, compared_with: None },
            )
        });
        match total {
            InferredUnit::Number(_) => InferredUnit::Number(f64::NAN),
            other => other,
        }
    }

    /// Returns the inferred unit of a product or quotient of any number of factors. Nested products in
    /// parentheses are flattened: `a / (2 * b)` is `a / 2 / b`.
    fn inferred_unit_of_product(&mut self, e: &'a Expr) -> InferredUnit {
        let mut factors = Vec::new();
        let mut waiting = vec![(false, e)];
        while let Some((below, factor)) = waiting.pop() {
            match &factor.kind {
                ExprKind::Binary(op @ (BinaryOp::Mul | BinaryOp::Div), left, right, _) => {
                    waiting.push((below != (*op == BinaryOp::Div), &**right));
                    waiting.push((below, &**left));
                }
                _ => factors.push((below, self.inferred_unit_of_expression(factor))),
            }
        }
        let value = self.inferred_unit_of_factors(&factors);
        // `sin(angle) * x` is a metre along `x` where a length is expected, as `x` is.
        let has_direction = factors.iter().any(|(_, factor)| matches!(factor, InferredUnit::Direction));
        match &value {
            InferredUnit::Quantity { dimension, anchor: UnitSource::Motion }
                if has_direction
                    && self.system.substitute_solved_unknowns(dimension).is_some_and(|d| d.is_plain()) =>
            {
                InferredUnit::Direction
            }
            _ => value,
        }
    }

    /// Returns the product of factors; the flag marks divisors.
    fn inferred_unit_of_factors(&mut self, factors: &[(bool, InferredUnit)]) -> InferredUnit {
        let (value, free) = unit_of_product(factors);
        let is_gravity = factors.iter().any(|(_, factor)| match factor {
            InferredUnit::Number(g) => self.gravity.contains(&g.abs()),
            _ => false,
        });
        let (InferredUnit::Quantity { dimension, anchor }, true) = (&value, free || is_gravity) else {
            return value;
        };
        let number = Dimension::unknown_dimension(self.system.add_unknown_dimension());
        self.default_to_plain(number.clone());
        match dimension.dimension_of_product(&number) {
            Some(dimension) => InferredUnit::Quantity { dimension, anchor: *anchor },
            None => InferredUnit::Unknown,
        }
    }

    /// Returns the inferred unit of a call: of a table, otherwise of a function of the language.
    fn inferred_unit_of_call(&mut self, callee: &'a Callee, arguments: &'a [Expr]) -> InferredUnit {
        if let Some(unknown) = self.tables.get(&callee.text).cloned() {
            return self.inferred_unit_of_table(&unknown, arguments);
        }
        match (callee.id, arguments) {
            (Some(Callable::Elementary(f)), [a]) => self.inferred_unit_of_elementary_function(f, a),
            (Some(Callable::Function(function)), _) => {
                self.inferred_unit_of_language_function(&function.row().unit, &callee.text, arguments)
            }
            (Some(Callable::If), [_, _, _, _]) => {
                let (compared, pieces) = arguments.split_at(2);
                self.equate_to_common_unit(compared, DimensionEqualityReason::Compared(&callee.text));
                self.equate_to_common_unit(pieces, DimensionEqualityReason::Pieces)
            }
            _ => InferredUnit::Unknown,
        }
    }

    /// Returns the inferred unit of a function of the language.
    fn inferred_unit_of_language_function(
        &mut self,
        rule: &UnitRule,
        name: &'a str,
        arguments: &'a [Expr],
    ) -> InferredUnit {
        let [first, others @ ..] = arguments else {
            return match rule {
                UnitRule::Of(dimension) => InferredUnit::known_from_motion(dimension.clone()),
                _ => InferredUnit::Unknown,
            };
        };
        match rule {
            UnitRule::Unknown => InferredUnit::Unknown,
            UnitRule::Of(dimension) => {
                self.infer_dimensions_of_unused_values(arguments);
                InferredUnit::known_from_motion(dimension.clone())
            }
            UnitRule::Direction => {
                self.infer_dimensions_of_unused_values(arguments);
                InferredUnit::Direction
            }
            UnitRule::EqualUnits => {
                self.equate_to_common_unit(arguments, DimensionEqualityReason::Compared(name))
            }
            UnitRule::Quotient => {
                match self.equate_to_common_unit(arguments, DimensionEqualityReason::Compared(name)) {
                    InferredUnit::Quantity { .. } => InferredUnit::known_from_motion(PLAIN),
                    _ => InferredUnit::Number(f64::NAN),
                }
            }
            UnitRule::LikeFirst => {
                self.infer_dimensions_of_unused_values(others);
                self.inferred_unit_of_expression(first)
            }
            UnitRule::LikeLast => {
                let values: Vec<InferredUnit> =
                    arguments.iter().map(|a| self.inferred_unit_of_expression(a)).collect();
                values.into_iter().last().unwrap_or(InferredUnit::Unknown)
            }
            UnitRule::Product { scalar } => {
                let factors: Vec<_> =
                    arguments.iter().map(|a| (false, self.inferred_unit_of_expression(a))).collect();
                match self.inferred_unit_of_factors(&factors) {
                    InferredUnit::Direction if *scalar => InferredUnit::known_from_motion(PLAIN),
                    product => product,
                }
            }
            UnitRule::Magnitude => match self.inferred_unit_of_expression(first) {
                InferredUnit::Direction => InferredUnit::known_from_motion(PLAIN),
                other => other,
            },
            UnitRule::Power => match others {
                [exponent] => self.inferred_unit_of_power(first, exponent),
                _ => InferredUnit::Unknown,
            },
            UnitRule::TimeDerivative => match &first.kind {
                // The rate of a vector in a frame; the frame's name has no dimension.
                ExprKind::Binary(BinaryOp::Div, vector, frame, _) if self.is_frame(frame) => {
                    match self.inferred_unit_of_expression(vector) {
                        InferredUnit::Direction => InferredUnit::known_from_motion(RATE),
                        other => quotient_by_dimension(other, &TIME),
                    }
                }
                _ => quotient_by_dimension(self.inferred_unit_of_expression(first), &TIME),
            },
            UnitRule::Inverse => {
                self.inferred_unit_of_expression(first).unit_of_power(Some(Ratio::from_integer(-1)))
            }
            UnitRule::Gradient => match &first.kind {
                ExprKind::Binary(_, field, ..) => match self.inferred_unit_of_expression(field) {
                    value @ InferredUnit::Quantity { .. } => quotient_by_dimension(value, &LENGTH),
                    _ => InferredUnit::Unknown,
                },
                _ => InferredUnit::Unknown,
            },
            UnitRule::Places(dimension) => {
                self.infer_dimensions_of_unused_values(others);
                self.infer_from_slash_operands(first);
                InferredUnit::known_from_motion(dimension.clone())
            }
            UnitRule::Moment => {
                self.infer_from_slash_operands(first);
                let directions: Vec<InferredUnit> =
                    others.iter().map(|a| self.inferred_unit_of_expression(a)).collect();
                match directions.iter().all(|direction| matches!(direction, InferredUnit::Direction)) {
                    true => InferredUnit::known_from_motion(INERTIA),
                    // Vectors with a unit would contribute it.
                    false => InferredUnit::Unknown,
                }
            }
            UnitRule::Cable => {
                self.infer_from_slash_operands(first);
                let Some(ExprKind::Method(base, _, arguments)) = others.first().map(|e| &e.kind) else {
                    return InferredUnit::Unknown;
                };
                self.infer_point(base);
                let radius = arguments.first().map(|radius| {
                    self.equate_with_expected_dimension(
                        radius,
                        &LENGTH,
                        "m",
                        DimensionEqualityReason::Argument,
                    )
                });
                InferredUnit::Quantity {
                    dimension: LENGTH,
                    anchor: radius.map_or(UnitSource::Motion, |r| r.source_of_unit()),
                }
            }
            UnitRule::OfHeight(dimension) => {
                self.equate_with_expected_dimension(first, &LENGTH, "m", DimensionEqualityReason::Argument);
                dimension.clone().map_or(InferredUnit::Unknown, InferredUnit::known_from_motion)
            }
        }
    }

    /// Infers dimensions from expressions whose values are not used.
    fn infer_dimensions_of_unused_values(&mut self, e: &'a [Expr]) {
        e.iter().for_each(|e| drop(self.inferred_unit_of_expression(e)));
    }

    /// Whether an expression is the name of a body or a frame, which has no dimension.
    fn is_frame(&self, e: &Expr) -> bool {
        let is_value = |name: &str| {
            self.names.contains_key(name)
                || Builtin::find_by_name(name).is_some()
                || self.locals.iter().any(|(local, _)| *local == name)
        };
        e.as_name().is_some_and(|name| !is_value(name))
    }

    /// Returns the inferred unit of a table. Its variables have the same units in all calls.
    fn inferred_unit_of_table(
        &mut self,
        unknown: &[UnknownDimensionIndex],
        arguments: &'a [Expr],
    ) -> InferredUnit {
        let Some((value, variables)) = unknown.split_last() else { return InferredUnit::Unknown };
        for (argument, variable) in arguments.iter().zip(variables) {
            self.equate_with_expected_dimension(
                argument,
                &Dimension::unknown_dimension(*variable),
                "",
                DimensionEqualityReason::Argument,
            );
        }
        InferredUnit::Quantity {
            dimension: Dimension::unknown_dimension(*value),
            anchor: UnitSource::Parameter,
        }
    }

    /// Returns the inferred unit of an elementary function: magnitudes and roots of any quantity, all others
    /// of plain numbers.
    fn inferred_unit_of_elementary_function(&mut self, f: Function, a: &'a Expr) -> InferredUnit {
        match f {
            Function::Abs => return self.inferred_unit_of_expression(a),
            Function::Signum => {
                self.inferred_unit_of_expression(a);
                return InferredUnit::known_from_motion(PLAIN);
            }
            Function::Sqrt => {
                return match self.inferred_unit_of_expression(a) {
                    InferredUnit::Number(value) => InferredUnit::Number(value.sqrt()),
                    other => other.unit_of_power(Ratio::new(1, 2)),
                };
            }
            _ => {}
        }
        let unit = if matches!(f, Function::Sin | Function::Cos | Function::Tan) { "rad" } else { "1" };
        match self.equate_with_expected_dimension(a, &PLAIN, unit, DimensionEqualityReason::Argument) {
            InferredUnit::Number(value) => InferredUnit::Number(f.evaluate_at(value)),
            InferredUnit::Direction => InferredUnit::Unknown,
            _ => InferredUnit::known_from_motion(PLAIN),
        }
    }

    /// Returns the inferred unit of a power. If the exponent is not a number, the dimension is unknown unless
    /// the base is plain.
    fn inferred_unit_of_power(&mut self, a: &'a Expr, n: &'a Expr) -> InferredUnit {
        let base = self.inferred_unit_of_expression(a);
        let exponent = self.equate_with_expected_dimension(n, &PLAIN, "1", DimensionEqualityReason::Argument);
        match (base, exponent) {
            (InferredUnit::Number(value), InferredUnit::Number(n)) => {
                InferredUnit::Number(libm::pow(value, n))
            }
            (InferredUnit::Number(_), _) => InferredUnit::known_from_motion(PLAIN),
            (base, InferredUnit::Number(n)) => base.unit_of_power(Ratio::from_value(n)),
            (InferredUnit::Quantity { dimension, anchor }, _) => {
                let power = Dimension::unknown_dimension(self.system.add_unknown_dimension());
                self.plain_defaults.push((dimension, Some(power.clone())));
                InferredUnit::Quantity { dimension: power, anchor }
            }
            _ => InferredUnit::Unknown,
        }
    }

    /// Infers from the operands between slashes, `y / x`, which may be given by vectors.
    fn infer_from_slash_operands(&mut self, e: &'a Expr) {
        let mut current = e;
        while let ExprKind::Binary(BinaryOp::Div, left, right, _) = &current.kind {
            self.infer_point(right);
            current = left;
        }
        self.infer_point(current);
    }

    /// Infers dimensions from the expression `body.at(vector)` of a point.
    pub fn infer_point(&mut self, e: &'a Expr) {
        if let ExprKind::Method(base, _, arguments) = &e.kind {
            self.infer_point(base);
            for argument in arguments {
                self.equate_with_expected_dimension(argument, &LENGTH, "m", DimensionEqualityReason::Place);
            }
        }
    }
}

/// Returns a quantity divided by another dimension; other values are unchanged.
fn quotient_by_dimension(value: InferredUnit, divisor: &Dimension) -> InferredUnit {
    match value {
        InferredUnit::Quantity { dimension, anchor } => match dimension.dimension_of_quotient(divisor) {
            Some(dimension) => InferredUnit::Quantity { dimension, anchor },
            None => InferredUnit::Unknown,
        },
        other => other,
    }
}
