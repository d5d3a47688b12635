//! Expressions of actuator laws, built with arithmetic operators.

use crate::diag::Place;
use crate::syntax::{BinaryOp, Expr, ExprKind};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Name of the calls that represent piecewise expressions.
const IF: &str = "if";

/// Expression of an actuator law that is being built.
#[derive(Clone)]
pub(super) struct Formula(pub(super) Expr);

impl Formula {
    /// Returns the expression that consists of a name.
    pub(super) fn named_value(text: String, place: &Place) -> Formula {
        Formula(Expr { kind: ExprKind::Name(text), place: place.clone() })
    }

    /// Returns the expression that consists of a number.
    pub(super) fn number_literal(value: f64, place: &Place) -> Formula {
        Formula(Expr::number_at(value, place))
    }

    fn constant_like(&self, value: f64) -> Formula {
        Formula::number_literal(value, &self.0.place)
    }

    fn binary_operation(self, op: BinaryOp, other: Formula) -> Formula {
        Formula(Expr::binary_operation(op, self.0, other.0))
    }

    fn function_call(function: &str, arguments: Vec<Formula>, place: &Place) -> Formula {
        Formula(Expr::function_call_at(
            function,
            arguments.into_iter().map(|formula| formula.0).collect(),
            place,
        ))
    }

    /// Returns an elementary function of this expression.
    pub(super) fn apply_function(self, function: &str) -> Formula {
        let place = self.0.place.clone();
        Formula::function_call(function, vec![self], &place)
    }

    /// Returns the square of this expression.
    pub(super) fn square(self) -> Formula {
        self.clone() * self
    }

    /// Returns this expression, limited to values between two numbers.
    pub(super) fn clamp_between(self, low: f64, high: f64) -> Formula {
        let place = self.0.place.clone();
        let [low, high] = [low, high].map(|end| Formula::number_literal(end, &place));
        let above = Formula::function_call("max", vec![self, low], &place);
        Formula::function_call("min", vec![above, high], &place)
    }

    /// Returns one of two values by a comparison with a number: `if self < border { below } else { above }`.
    pub(super) fn piecewise_choice(self, border: f64, below: Formula, above: Formula) -> Formula {
        let place = self.0.place.clone();
        let border = self.constant_like(border);
        Formula::function_call(IF, vec![self, border, below, above], &place)
    }
}

impl Add for Formula {
    type Output = Formula;
    fn add(self, other: Formula) -> Formula {
        self.binary_operation(BinaryOp::Add, other)
    }
}

impl Sub for Formula {
    type Output = Formula;
    fn sub(self, other: Formula) -> Formula {
        self.binary_operation(BinaryOp::Sub, other)
    }
}

impl Mul for Formula {
    type Output = Formula;
    fn mul(self, other: Formula) -> Formula {
        self.binary_operation(BinaryOp::Mul, other)
    }
}

impl Div for Formula {
    type Output = Formula;
    fn div(self, other: Formula) -> Formula {
        self.binary_operation(BinaryOp::Div, other)
    }
}

impl Add<f64> for Formula {
    type Output = Formula;
    fn add(self, other: f64) -> Formula {
        let other = self.constant_like(other);
        self + other
    }
}

impl Mul<f64> for Formula {
    type Output = Formula;
    fn mul(self, other: f64) -> Formula {
        let other = self.constant_like(other);
        self * other
    }
}

impl Neg for Formula {
    type Output = Formula;
    fn neg(self) -> Formula {
        self * -1.0
    }
}
