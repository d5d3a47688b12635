//! Expressions of actuator laws, built with arithmetic operators.

use crate::diag::Place;
use crate::syntax::{BinaryOp, Expr, ExprKind};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Name of the calls that represent piecewise expressions.
const IF: &str = "if";

/// Expression of an actuator law that is being built.
#[derive(Clone)]
pub(super) struct ActuatorLawExpression(pub(super) Expr);

impl ActuatorLawExpression {
    /// Returns the expression that consists of a name.
    pub(super) fn formula_of_name(text: String, place: &Place) -> ActuatorLawExpression {
        ActuatorLawExpression(Expr { kind: ExprKind::Name(text), place: place.clone() })
    }

    /// Returns the expression that consists of a number.
    pub(super) fn number_literal(value: f64, place: &Place) -> ActuatorLawExpression {
        ActuatorLawExpression(Expr::number_at(value, place))
    }

    fn number_with_same_span(&self, value: f64) -> ActuatorLawExpression {
        ActuatorLawExpression::number_literal(value, &self.0.place)
    }

    fn binary_operation(self, op: BinaryOp, other: ActuatorLawExpression) -> ActuatorLawExpression {
        ActuatorLawExpression(Expr::binary_operation(op, self.0, other.0))
    }

    fn function_call(
        function: &str,
        arguments: Vec<ActuatorLawExpression>,
        place: &Place,
    ) -> ActuatorLawExpression {
        ActuatorLawExpression(Expr::function_call_expression(
            function,
            arguments.into_iter().map(|formula| formula.0).collect(),
            place,
        ))
    }

    /// Returns an elementary function of this expression.
    pub(super) fn apply_function(self, function: &str) -> ActuatorLawExpression {
        let place = self.0.place.clone();
        ActuatorLawExpression::function_call(function, vec![self], &place)
    }

    /// Returns the square of this expression.
    pub(super) fn square(self) -> ActuatorLawExpression {
        self.clone() * self
    }

    /// Returns this expression, limited to values between two numbers.
    pub(super) fn clamp_between(self, low: f64, high: f64) -> ActuatorLawExpression {
        let place = self.0.place.clone();
        let [low, high] = [low, high].map(|end| ActuatorLawExpression::number_literal(end, &place));
        let above = ActuatorLawExpression::function_call("max", vec![self, low], &place);
        ActuatorLawExpression::function_call("min", vec![above, high], &place)
    }

    /// Returns one of two values by a comparison with a number: `if self < border { below } else { above }`.
    pub(super) fn piecewise_choice(
        self,
        border: f64,
        below: ActuatorLawExpression,
        above: ActuatorLawExpression,
    ) -> ActuatorLawExpression {
        let place = self.0.place.clone();
        let border = self.number_with_same_span(border);
        ActuatorLawExpression::function_call(IF, vec![self, border, below, above], &place)
    }
}

impl Add for ActuatorLawExpression {
    type Output = ActuatorLawExpression;
    fn add(self, other: ActuatorLawExpression) -> ActuatorLawExpression {
        self.binary_operation(BinaryOp::Add, other)
    }
}

impl Sub for ActuatorLawExpression {
    type Output = ActuatorLawExpression;
    fn sub(self, other: ActuatorLawExpression) -> ActuatorLawExpression {
        self.binary_operation(BinaryOp::Sub, other)
    }
}

impl Mul for ActuatorLawExpression {
    type Output = ActuatorLawExpression;
    fn mul(self, other: ActuatorLawExpression) -> ActuatorLawExpression {
        self.binary_operation(BinaryOp::Mul, other)
    }
}

impl Div for ActuatorLawExpression {
    type Output = ActuatorLawExpression;
    fn div(self, other: ActuatorLawExpression) -> ActuatorLawExpression {
        self.binary_operation(BinaryOp::Div, other)
    }
}

impl Add<f64> for ActuatorLawExpression {
    type Output = ActuatorLawExpression;
    fn add(self, other: f64) -> ActuatorLawExpression {
        let other = self.number_with_same_span(other);
        self + other
    }
}

impl Mul<f64> for ActuatorLawExpression {
    type Output = ActuatorLawExpression;
    fn mul(self, other: f64) -> ActuatorLawExpression {
        let other = self.number_with_same_span(other);
        self * other
    }
}

impl Neg for ActuatorLawExpression {
    type Output = ActuatorLawExpression;
    fn neg(self) -> ActuatorLawExpression {
        self * -1.0
    }
}
