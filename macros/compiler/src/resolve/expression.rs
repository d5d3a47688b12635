//! Resolution of written expressions into expressions of the graph: names are looked up, and scalars, vectors
//! and matrices are distinguished.

use super::corrections::VECTOR_SYNTAX;
use super::scope::{Axes, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::syntax::{self, BinaryOp, ExprKind, ScalarType};

impl<'a, 'g> Scope<'a, 'g> {
    /// Returns the value of a scalar expression.
    pub fn resolve_scalar(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        match self.resolve_value(e, cx)? {
            Value::Scalar(s) => Some(s),
            Value::Vector(_) => {
                cx.report_error(e.place.clone(), "expected a scalar, found a vector")
                    .add_help("its length is `norm(v)`, its component along a direction `dot(v, x)`");
                None
            }
            Value::Matrix(_) => {
                cx.report_error(e.place.clone(), "expected a scalar, found a matrix").add_help(
                    "an entry of it is `dot(x, M * y)`, the sum of those of its diagonal `trace(M)`",
                );
                None
            }
        }
    }

    /// Returns the value of a vector expression in the attribute's own axes.
    pub fn resolve_own_axes_vector(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Vec3<'g>> {
        self.resolve_vector(e, cx).and_then(|terms| self.own_axes_sum(terms, e, cx))
    }

    /// Returns the sum of a vector's terms, which must all be in the attribute's own axes.
    pub fn own_axes_sum(
        &self,
        terms: Vec<(Axes, Vec3<'g>)>,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Vec3<'g>> {
        let mut sum = Vec3::zero(self.graph);
        for (axes, v) in terms {
            if let Axes::Of(body) = axes {
                cx.report_error(e.place.clone(), format!("this vector is given in the axes of `{body}`"))
                    .add_help("only the axes `x`, `y` and `z` of the frame are allowed here");
                return None;
            }
            sum += v;
        }
        Some(sum)
    }

    /// Returns the value of a vector expression as a sum over axes.
    pub fn resolve_vector(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Vec<(Axes, Vec3<'g>)>> {
        self.resolve_vector_with_help(e, "multiply it by a direction, as in `length * y`", cx)
    }

    /// Returns the value of a vector expression as a sum over axes, and reports a scalar with the given help.
    /// Each subexpression is evaluated once, for any depth of nesting.
    pub fn resolve_vector_with_help(
        &self,
        e: &syntax::Expr,
        help: &str,
        cx: &mut Diagnostics,
    ) -> Option<Vec<(Axes, Vec3<'g>)>> {
        match self.resolve_value(e, cx)? {
            Value::Vector(v) => Some(v),
            // The number zero is also the zero vector.
            Value::Scalar(s) if s.is_zero() => Some(vec![(Axes::Own, Vec3::zero(self.graph))]),
            Value::Scalar(_) => {
                cx.report_error(e.place.clone(), "expected a vector, found a scalar").add_help(help);
                None
            }
            Value::Matrix(_) => {
                cx.report_error(e.place.clone(), "expected a vector, found a matrix")
                    .add_help("a matrix times a vector is one: `M * v`");
                None
            }
        }
    }

    /// Returns the value of an expression, or reports an error. A value that is not finite is also an error.
    ///
    /// The left operands of a chain of operators, such as a long sum, are visited in a loop. The depth of the
    /// recursion is therefore the nesting of brackets and signs, which `syntax::guard` bounds.
    pub fn resolve_value(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let mut operations = Vec::new();
        let mut first = e;
        while let ExprKind::Binary(op, left, right, _) = &first.kind
            && self.symbol_of_compared_expression(first).is_none()
        {
            operations.push((*op, &**right, first));
            first = left;
        }
        let mut value =
            self.resolve_non_binary_expression(first, cx).and_then(|value| require_finite(value, first, cx));
        for (op, right, whole) in operations.into_iter().rev() {
            let right = self.resolve_value(right, cx);
            let both = value.zip(right);
            value = both.and_then(|(left, right)| self.resolve_binary(op, left, right, whole, cx));
            value = value.and_then(|value| require_finite(value, whole, cx));
        }
        value
    }

    /// Returns the value of an expression that is not a binary operation.
    fn resolve_non_binary_expression(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        if let Some(symbol) = self.symbol_of_compared_expression(e) {
            return Some(Value::Scalar(symbol));
        }
        match &e.kind {
            ExprKind::Number(n) => {
                let small = *n != 0.0 && n.abs() < f64::from(f32::MIN_POSITIVE);
                if self.description.scalar == ScalarType::F32 && (small || n.abs() > f64::from(f32::MAX)) {
                    let what = if small { "small" } else { "large" };
                    cx.report_error(e.place.clone(), format!("this number is too {what} for `f32`: {n:e}"))
                        .add_help("use `f64`, or other units");
                    return None;
                }
                Some(Value::Scalar(self.graph.num(*n)))
            }
            ExprKind::Name(name) => self.resolve_name_in_expression(name, e, cx),
            ExprKind::Field(inner, member) => self.resolve_member(inner, member, cx),
            ExprKind::Neg(inner) => Some(match self.resolve_value(inner, cx)? {
                Value::Scalar(s) => Value::Scalar(-s),
                Value::Vector(v) => Value::Vector(v.into_iter().map(|(a, v)| (a, -v)).collect()),
                Value::Matrix(m) => Value::Matrix(m.map(|entry| -entry)),
            }),
            ExprKind::Binary(..) => self.resolve_value(e, cx),
            ExprKind::Call(function, arguments) => self.resolve_call(function, arguments, cx),
            ExprKind::Array(items)
                if !items.is_empty() && items.iter().all(|item| matches!(item.kind, ExprKind::Array(_))) =>
            {
                self.resolve_matrix_from_rows(e, cx)
            }
            ExprKind::Array(items) if items.len() == 3 => {
                let parts: Vec<Option<Expr<'g>>> = items.iter().map(|i| self.resolve_scalar(i, cx)).collect();
                let vector = Vec3([parts[0]?, parts[1]?, parts[2]?]);
                Some(self.vector_in_context_axes(vector))
            }
            ExprKind::Method(_, method, _) => {
                self.report_unknown_method(e, method, cx);
                None
            }
            ExprKind::Array(items) => {
                cx.report_error(
                    e.place.clone(),
                    format!("a vector has three components, found {}", items.len()),
                )
                .add_help(VECTOR_SYNTAX);
                None
            }
            ExprKind::Text(_) => {
                cx.report_error(e.place.clone(), "expected a scalar or a vector, found a path");
                None
            }
            ExprKind::Tuple(items) => {
                let error = cx.report_error(e.place.clone(), "expected a scalar or a vector, found a list");
                match items.as_slice() {
                    [a, b, c] => error.add_help(format!(
                        "write `[{}, {}, {}]` for a vector",
                        a.short_source_text(),
                        b.short_source_text(),
                        c.short_source_text()
                    )),
                    _ => error.add_help(VECTOR_SYNTAX),
                };
                None
            }
        }
    }

    fn resolve_binary(
        &self,
        op: BinaryOp,
        left: Value<'g>,
        right: Value<'g>,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        use Value::{Scalar, Vector};
        Some(match (op, left, right) {
            (BinaryOp::Add, Scalar(a), Scalar(b)) => Scalar(a + b),
            (BinaryOp::Sub, Scalar(a), Scalar(b)) => Scalar(a - b),
            (BinaryOp::Mul, Scalar(a), Scalar(b)) => Scalar(a * b),
            (BinaryOp::Div, _, Scalar(b)) if b.is_zero() => {
                cx.report_error(e.place.clone(), "division by zero")
                    .add_help("the divisor is zero, or simplifies to zero");
                return None;
            }
            (op, left @ Value::Matrix(_), right) | (op, left, right @ Value::Matrix(_)) => {
                return self.resolve_matrix_operation(op, left, right, e, cx);
            }
            (BinaryOp::Div, Scalar(a), Scalar(b)) => Scalar(a / b),
            (BinaryOp::Add, Vector(a), Vector(b)) => Vector(add_vectors_by_axes(a, b)),
            (BinaryOp::Sub, Vector(a), Vector(b)) => {
                Vector(add_vectors_by_axes(a, b.into_iter().map(|(axes, v)| (axes, -v)).collect()))
            }
            (BinaryOp::Mul, Scalar(s), Vector(v)) | (BinaryOp::Mul, Vector(v), Scalar(s)) => {
                Vector(v.into_iter().map(|(a, v)| (a, v * s)).collect())
            }
            (BinaryOp::Div, Vector(v), Scalar(s)) => {
                Vector(v.into_iter().map(|(a, v)| (a, v.map(|c| c / s))).collect())
            }
            (BinaryOp::Mul, Vector(_), Vector(_)) => {
                cx.report_error(e.place.clone(), "the product of two vectors is not defined")
                    .add_help("write `dot(a, b)` or `cross(a, b)`");
                return None;
            }
            (BinaryOp::Div, left, Vector(_)) => {
                cx.report_error(
                    e.place.clone(),
                    format!("{} cannot be divided by a vector", left.kind_with_article()),
                )
                .add_help("divide by its length, `norm(v)`");
                return None;
            }
            (_, left, right) => {
                let verb = if op == BinaryOp::Add { "added to" } else { "subtracted from" };
                let (what, from) = if op == BinaryOp::Add { (&left, &right) } else { (&right, &left) };
                cx.report_error(
                    e.place.clone(),
                    format!("{} cannot be {verb} {}", what.kind_with_article(), from.kind_with_article()),
                )
                .add_help("multiply the scalar by a direction, as in `length * y`");
                return None;
            }
        })
    }
}

/// Returns the value if it is finite; otherwise reports an error at the expression.
fn require_finite<'g>(value: Value<'g>, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
    let is_finite = |s: &Expr<'g>| s.constant_value().is_none_or(f64::is_finite);
    let is_valid = match &value {
        Value::Scalar(s) => is_finite(s),
        Value::Vector(terms) => terms.iter().all(|(_, v)| v.0.iter().all(is_finite)),
        Value::Matrix(m) => m.entries.0.iter().flatten().all(is_finite),
    };
    if !is_valid {
        cx.report_error(e.place.clone(), "this value is not a finite number")
            .add_help("the largest number is about 1e308: use smaller numbers");
    }
    is_valid.then_some(value)
}

/// Returns the sum of two vectors whose components are grouped by frame of reference.
pub fn add_vectors_by_axes<'g>(
    mut a: Vec<(Axes, Vec3<'g>)>,
    b: Vec<(Axes, Vec3<'g>)>,
) -> Vec<(Axes, Vec3<'g>)> {
    for (axes, v) in b {
        match a.iter_mut().find(|(known, _)| *known == axes) {
            Some((_, sum)) => *sum += v,
            None => a.push((axes, v)),
        }
    }
    a
}
