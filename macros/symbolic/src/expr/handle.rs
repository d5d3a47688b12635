//! Handle of an expression, with arithmetic that adds nodes to its graph.

use super::graph::{Graph, ZERO};
use super::node::{Extreme, Function, Id, Node};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// An expression: a node of a graph, with arithmetic.
#[derive(Clone, Copy)]
pub struct Expr<'g> {
    pub(super) graph: &'g Graph,
    pub(super) id: Id,
}

impl PartialEq for Expr<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl<'g> Expr<'g> {
    /// Returns the index of the expression's node in its graph.
    pub fn id(self) -> Id {
        self.id
    }

    /// Returns the graph that owns the expression.
    pub fn graph(self) -> &'g Graph {
        self.graph
    }

    /// Returns the node of the expression.
    pub fn node(self) -> Node {
        self.graph.node(self.id)
    }

    /// Returns the value of the expression if it is a constant.
    pub fn constant_value(self) -> Option<f64> {
        self.graph.constant_value(self.id)
    }

    /// Returns true for a constant, or a constant times another expression.
    pub fn has_constant_factor(self) -> bool {
        let (_, id) = self.graph.split_sign(self.id);
        match self.graph.node(id) {
            Node::Mul(a, _) => self.graph.is_constant(a),
            node => matches!(node, Node::Const(_) | Node::Tuple(_)),
        }
    }

    /// Returns whether the expression is the constant zero.
    pub fn is_zero(self) -> bool {
        self.id == ZERO
    }

    /// Returns a constant of the graph that owns this expression.
    pub fn num(self, value: f64) -> Expr<'g> {
        self.graph.num(value)
    }

    /// Returns the constant zero of the graph that owns this expression.
    pub fn zero(self) -> Expr<'g> {
        self.graph.zero()
    }

    /// Returns an elementary function applied to this expression.
    pub fn apply_function(self, f: Function) -> Expr<'g> {
        self.graph.expr(self.graph.call_function(f, self.id))
    }

    /// Returns the sine of the expression, an angle in rad.
    pub fn sin(self) -> Expr<'g> {
        self.apply_function(Function::Sin)
    }

    /// Returns the cosine of the expression, an angle in rad.
    pub fn cos(self) -> Expr<'g> {
        self.apply_function(Function::Cos)
    }

    /// Returns the square root of the expression.
    pub fn sqrt(self) -> Expr<'g> {
        self.apply_function(Function::Sqrt)
    }

    /// Returns the angle, rad, of the point (`abscissa`, `self`).
    pub fn atan2(self, abscissa: Expr<'g>) -> Expr<'g> {
        if let (Some(y), Some(x)) = (self.constant_value(), abscissa.constant_value()) {
            return self.num(libm::atan2(y, x));
        }
        self.graph.expr(self.graph.intern_node(Node::Atan2(self.id, abscissa.id)))
    }

    /// Returns the minimum or maximum of two expressions.
    pub fn minimum_or_maximum(self, f: Extreme, other: Expr<'g>) -> Expr<'g> {
        match (self.constant_value(), other.constant_value()) {
            (Some(a), Some(b)) => self.num(f.evaluate_extreme(a, b)),
            _ if self == other => self,
            _ => self.graph.expr(self.graph.intern_node(Node::Extreme(f, self.id, other.id))),
        }
    }

    /// Returns a power. Integer exponents up to eight become products.
    pub fn pow(self, exponent: Expr<'g>) -> Expr<'g> {
        match (self.constant_value(), exponent.constant_value()) {
            (Some(x), Some(n)) if libm::pow(x, n).is_finite() => self.num(libm::pow(x, n)),
            (_, Some(n)) if n == n.trunc() && n.abs() <= 8.0 => {
                let product = (0..n.abs() as u32).fold(self.graph.one(), |p, _| p * self);
                if n < 0.0 { self.graph.one() / product } else { product }
            }
            (_, Some(0.5)) => self.sqrt(),
            _ => self.graph.expr(self.graph.intern_node(Node::Pow(self.id, exponent.id))),
        }
    }

    /// Returns the square of the expression.
    pub fn square(self) -> Expr<'g> {
        self * self
    }
}

/// Implements arithmetic operators by the functions of the graph.
macro_rules! operators {
    ($($operator:ident $function:ident),+) => {$(
        impl<'g> $operator for Expr<'g> {
            type Output = Expr<'g>;
            fn $function(self, b: Expr<'g>) -> Expr<'g> {
                self.graph.expr(self.graph.$function(self.id, b.id))
            }
        }
    )+};
}

operators!(Add add, Sub sub, Mul mul, Div div);

impl<'g> Mul<f64> for Expr<'g> {
    type Output = Expr<'g>;
    fn mul(self, b: f64) -> Expr<'g> {
        self * self.num(b)
    }
}

impl<'g> Neg for Expr<'g> {
    type Output = Expr<'g>;
    fn neg(self) -> Expr<'g> {
        self.graph.expr(self.graph.neg(self.id))
    }
}

impl<'g> AddAssign for Expr<'g> {
    fn add_assign(&mut self, b: Expr<'g>) {
        *self = *self + b;
    }
}

impl<'g> SubAssign for Expr<'g> {
    fn sub_assign(&mut self, b: Expr<'g>) {
        *self = *self - b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn constant_operations_fold() {
        let g = Graph::new();
        let x = g.symbol(Symbol(0));
        assert_eq!(x * g.zero(), g.zero());
        assert_eq!(x * g.one(), x);
        assert_eq!(x + g.zero(), x);
        assert_eq!(x - x, g.zero());
        assert_eq!(x / x, g.one());
        assert_eq!((g.num(2.0) * x) * g.num(3.0), g.num(6.0) * x);
        assert_eq!(x / g.num(4.0), g.num(0.25) * x);
        assert_eq!(x + x, g.num(2.0) * x);
        assert_eq!(g.num(0.0).sin(), g.zero());
        assert_eq!((x + g.num(2.0)) + g.num(3.0), x + g.num(5.0));
        assert_eq!(g.num(2.0) - (g.num(3.0) - x), x - g.num(1.0));
    }

    #[test]
    fn signs_move_outwards_so_that_negatives_share() {
        let g = Graph::new();
        let (x, y, z) = (g.symbol(Symbol(0)), g.symbol(Symbol(1)), g.symbol(Symbol(2)));
        assert_eq!((-x) * y, -(x * y));
        assert_eq!((-x) + (-y), -(x + y));
        assert_eq!(x - y, -(y - x));
        assert_eq!((x - y) * z, -((y - x) * z));
        assert_eq!((-x).sin(), -x.sin());
        assert_eq!((y - x).cos(), (x - y).cos());
        assert_eq!(g.num(-3.0) * x, -(g.num(3.0) * x));
    }

    #[test]
    fn reused_multiples_remain_one_product() {
        let g = Graph::new();
        let (x, y, z) = (g.symbol(Symbol(0)), g.symbol(Symbol(1)), g.symbol(Symbol(2)));
        let twice = g.num(2.0) * x;
        let before = g.len();
        let _ = (twice * y, twice * z);
        assert_eq!(g.len(), before + 2);
    }

    #[test]
    fn subtracting_an_added_term_cancels_it() {
        let g = Graph::new();
        let (x, y) = (g.symbol(Symbol(0)), g.symbol(Symbol(1)));
        assert_eq!((x + y) - y, x);
        assert_eq!((x - y) + y, x);
        assert_eq!(x - (x - y), y);
    }
}
