//! Expressions under construction, with the usual operators.

use crate::diag::Place;
use crate::syntax::{BinaryOp, Expr, ExprKind};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Name of the calls that represent piecewise expressions.
const IF: &str = "if";

/// Expression under construction.
#[derive(Clone)]
pub(super) struct Formula(pub(super) Expr);

impl Formula {
    /// Returns the value of a name.
    pub(super) fn name(text: String, place: &Place) -> Formula {
        Formula(Expr { kind: ExprKind::Name(text), place: place.clone() })
    }

    /// Returns a number.
    pub(super) fn number(value: f64, place: &Place) -> Formula {
        Formula(Expr::number_at(value, place))
    }

    fn constant(&self, value: f64) -> Formula {
        Formula::number(value, &self.0.place)
    }

    fn operation(self, op: BinaryOp, other: Formula) -> Formula {
        Formula(Expr::binary_operation(op, self.0, other.0))
    }

    fn call(function: &str, arguments: Vec<Formula>, place: &Place) -> Formula {
        Formula(Expr::function_call_at(
            function,
            arguments.into_iter().map(|formula| formula.0).collect(),
            place,
        ))
    }

    /// Returns an elementary function of the value.
    pub(super) fn function(self, function: &str) -> Formula {
        let place = self.0.place.clone();
        Formula::call(function, vec![self], &place)
    }

    /// Returns the square.
    pub(super) fn square(self) -> Formula {
        self.clone() * self
    }

    /// Returns the nearest value between two numbers.
    pub(super) fn clamp(self, low: f64, high: f64) -> Formula {
        let place = self.0.place.clone();
        let [low, high] = [low, high].map(|end| Formula::number(end, &place));
        let above = Formula::call("max", vec![self, low], &place);
        Formula::call("min", vec![above, high], &place)
    }

    /// Returns one of two values by a comparison with a number: `if self < border { below } else { above }`.
    pub(super) fn choose(self, border: f64, below: Formula, above: Formula) -> Formula {
        let place = self.0.place.clone();
        let border = self.constant(border);
        Formula::call(IF, vec![self, border, below, above], &place)
    }
}

impl Add for Formula {
    type Output = Formula;
    fn add(self, other: Formula) -> Formula {
        self.operation(BinaryOp::Add, other)
    }
}

impl Sub for Formula {
    type Output = Formula;
    fn sub(self, other: Formula) -> Formula {
        self.operation(BinaryOp::Sub, other)
    }
}

impl Mul for Formula {
    type Output = Formula;
    fn mul(self, other: Formula) -> Formula {
        self.operation(BinaryOp::Mul, other)
    }
}

impl Div for Formula {
    type Output = Formula;
    fn div(self, other: Formula) -> Formula {
        self.operation(BinaryOp::Div, other)
    }
}

impl Add<f64> for Formula {
    type Output = Formula;
    fn add(self, other: f64) -> Formula {
        let other = self.constant(other);
        self + other
    }
}

impl Mul<f64> for Formula {
    type Output = Formula;
    fn mul(self, other: f64) -> Formula {
        let other = self.constant(other);
        self * other
    }
}

impl Neg for Formula {
    type Output = Formula;
    fn neg(self) -> Formula {
        self * -1.0
    }
}
