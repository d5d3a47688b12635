//! SIMD lanes: expressions with one value for each of several identical subsystems of a mechanism, such as
//! limbs. All operations act lane by lane; an expression without lanes has the same value in each lane. Lanes
//! originate from constants and inputs that differ between lanes, or from joined expressions. A sum over the
//! lanes, or the selection of one lane, ends them.

use super::graph::ZERO;
use super::node::{Id, Node, Symbol};
use super::{Expr, Graph};
use std::collections::BTreeMap;

/// Maximum number of SIMD lanes of an expression.
pub const MAX_LANES: usize = 8;

/// Interned constants and inputs of expressions with SIMD lanes.
#[derive(Default)]
pub struct InternedLaneData {
    tuples: Vec<Vec<f64>>,
    /// Index of each tuple of constants, keyed by the bits of its numbers.
    known: BTreeMap<Vec<u64>, u32>,
    gathers: Vec<Vec<Symbol>>,
    /// Number of SIMD lanes of each node, one for expressions without lanes; filled on demand.
    widths: Vec<u8>,
}

impl Graph {
    /// Returns a constant for each lane, or an ordinary constant if all are equal.
    pub fn lanes_from_constants(&self, values: &[f64]) -> Expr<'_> {
        self.expr(self.intern_lane_constants(values.to_vec()))
    }

    /// Returns an input for each lane, or an ordinary input if all are equal.
    pub fn lane_input_of_symbols(&self, symbols: &[Symbol]) -> Expr<'_> {
        if let Some(first) = symbols.first().filter(|first| symbols.iter().all(|s| s == *first)) {
            return self.symbol(*first);
        }
        let mut tables = self.lanes.borrow_mut();
        let known = tables.gathers.iter().position(|g| g == symbols);
        let k = known.unwrap_or_else(|| {
            tables.gathers.push(symbols.to_vec());
            tables.gathers.len() - 1
        });
        self.expr(self.intern_node(Node::Gather(k as u32)))
    }

    /// Returns the constants of a tuple node, one for each SIMD lane.
    pub fn lanes_of_tuple(&self, k: u32) -> Vec<f64> {
        self.lanes.borrow().tuples[k as usize].clone()
    }

    /// Returns the symbols of a gather node, one for each SIMD lane.
    pub fn symbols_of_gather(&self, k: u32) -> Vec<Symbol> {
        self.lanes.borrow().gathers[k as usize].clone()
    }

    /// Returns the number of SIMD lanes of a node, one for an expression without lanes.
    fn lane_count(&self, id: Id) -> usize {
        let (nodes, mut tables) = (self.nodes(), self.lanes.borrow_mut());
        for node in &nodes[tables.widths.len().min(id as usize + 1)..=id as usize] {
            let mut width = 1;
            node.visit_operands(|a| width = width.max(tables.widths[a as usize]));
            let width = match *node {
                Node::Tuple(k) => tables.tuples[k as usize].len() as u8,
                Node::Gather(k) => tables.gathers[k as usize].len() as u8,
                Node::Sum(..) | Node::Lane(..) => 1,
                Node::Join(n, ..) => 2 * n,
                _ => width,
            };
            tables.widths.push(width);
        }
        tables.widths[id as usize].into()
    }

    /// Returns the first `n` lanes of `a`, followed by `n` lanes of `b`.
    fn join_lanes(&self, n: usize, a: Id, b: Id) -> Id {
        if a == b && self.lane_count(a) == 1 {
            return a;
        }
        if let (Some(a), Some(b)) =
            (self.expr(a).constant_lane_values(n), self.expr(b).constant_lane_values(n))
        {
            return self.intern_lane_constants([a, b].concat());
        }
        match (self.node(a), self.node(b)) {
            (Node::Neg(a), Node::Neg(b)) => self.neg(self.intern_node(Node::Join(n as u8, a, b))),
            _ => self.intern_node(Node::Join(n as u8, a, b)),
        }
    }

    fn intern_lane_constants(&self, mut values: Vec<f64>) -> Id {
        for x in &mut values {
            // Minus zero becomes zero.
            *x += 0.0;
        }
        let bits: Vec<u64> = values.iter().map(|x| x.to_bits()).collect();
        if bits.iter().all(|b| *b == bits[0]) {
            return values.first().map_or(ZERO, |x| self.intern_constant(*x));
        }
        let mut tables = self.lanes.borrow_mut();
        let next = tables.tuples.len() as u32;
        let k = *tables.known.entry(bits).or_insert(next);
        if k == next {
            tables.tuples.push(values);
        }
        drop(tables);
        self.intern_node(Node::Tuple(k))
    }

    /// Applies a function to each constant of a tuple. Other nodes are returned unchanged.
    pub(super) fn map_lanes(&self, id: Id, f: impl Fn(f64) -> f64) -> Id {
        match self.node(id) {
            Node::Tuple(k) => self.intern_lane_constants(self.lanes_of_tuple(k).into_iter().map(f).collect()),
            _ => id,
        }
    }

    /// Applies a function to each constant of a tuple. `None` if a result is not finite or the node is not a
    /// tuple.
    pub(super) fn map_lanes_if_finite(&self, id: Id, f: impl Fn(f64) -> f64) -> Option<Id> {
        let Node::Tuple(k) = self.node(id) else { return None };
        let values: Vec<f64> = self.lanes_of_tuple(k).into_iter().map(f).collect();
        values.iter().all(|x| x.is_finite()).then(|| self.intern_lane_constants(values))
    }

    /// Applies `f` to two constants, at least one of which is a tuple. `None` for other operands.
    pub(super) fn combine_constant_lanes(&self, a: Id, b: Id, f: fn(f64, f64) -> f64) -> Option<Id> {
        let values: Vec<f64> = match (self.node(a), self.node(b)) {
            (Node::Tuple(x), Node::Tuple(y)) => {
                self.lanes_of_tuple(x).into_iter().zip(self.lanes_of_tuple(y)).map(|(x, y)| f(x, y)).collect()
            }
            (Node::Tuple(x), Node::Const(y)) => self.lanes_of_tuple(x).into_iter().map(|x| f(x, y)).collect(),
            (Node::Const(x), Node::Tuple(y)) => self.lanes_of_tuple(y).into_iter().map(|y| f(x, y)).collect(),
            _ => return None,
        };
        Some(self.intern_lane_constants(values))
    }

    /// Returns whether the first nonzero constant of a tuple is negative. This holds for exactly one of a
    /// tuple and its negative.
    pub(super) fn is_first_nonzero_negative(&self, k: u32) -> bool {
        let tables = self.lanes.borrow();
        tables.tuples[k as usize].iter().find(|x| **x != 0.0).is_some_and(|x| *x < 0.0)
    }
}

impl<'g> Expr<'g> {
    /// Returns the constants of all lanes, `n` copies for a constant without lanes. `None` if the expression
    /// is not constant.
    pub fn constant_lane_values(self, n: usize) -> Option<Vec<f64>> {
        match self.node() {
            Node::Const(c) => Some(vec![c; n]),
            Node::Tuple(k) => Some(self.graph().lanes_of_tuple(k)),
            _ => None,
        }
    }

    /// Returns whether the expression is a constant, or a tuple of constants, one for each SIMD lane.
    pub fn is_constant(self) -> bool {
        self.graph().is_constant(self.id())
    }

    /// Returns true if the expression and `bound` are constant and the magnitude of the expression is at most
    /// the bound in every lane.
    pub fn is_magnitude_within_bound(self, bound: Expr<'g>) -> bool {
        match (self.constant_lane_values(MAX_LANES), bound.constant_lane_values(MAX_LANES)) {
            (Some(x), Some(bound)) => x.iter().zip(&bound).all(|(x, bound)| x.abs() <= *bound),
            _ => false,
        }
    }

    /// Returns the sum of the first `n` lanes of the expression.
    pub fn lane_sum(self, n: usize) -> Expr<'g> {
        let g = self.graph();
        if let Some(values) = self.constant_lane_values(n) {
            return g.num(values.iter().take(n).sum());
        }
        let (negative, id) = g.split_sign(self.id());
        g.expr(g.apply_sign(negative, g.intern_node(Node::Sum(n as u8, id))))
    }

    /// Returns the `n` lanes of this expression, followed by the `n` lanes of another one. An expression
    /// without lanes has the same value in each lane.
    pub fn append_lanes(self, n: usize, other: Expr<'g>) -> Expr<'g> {
        let g = self.graph();
        g.expr(g.join_lanes(n, self.id(), other.id()))
    }

    /// Returns the value of the expression in lane `k`.
    pub fn lane(self, k: usize) -> Expr<'g> {
        let g = self.graph();
        match self.node() {
            Node::Const(_) | Node::Symbol(_) => return self,
            Node::Tuple(t) => return g.num(g.lanes_of_tuple(t)[k]),
            Node::Gather(t) => return g.symbol(g.symbols_of_gather(t)[k]),
            Node::Join(n, a, b) => {
                let n = usize::from(n);
                return if k < n { g.expr(a).lane(k) } else { g.expr(b).lane(k - n) };
            }
            _ => {}
        }
        // The sign is not lifted: one operation negates all lanes.
        g.expr(g.intern_node(Node::Lane(k as u8, self.id())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::eval::eval;

    #[test]
    fn constant_lanes_fold() {
        let g = Graph::new();
        let constant_lanes = |values: [f64; 3]| g.lanes_from_constants(&values);
        let x = g.lane_input_of_symbols(&[Symbol(0), Symbol(1), Symbol(2)]);
        assert_eq!(constant_lanes([2.0; 3]), g.num(2.0));
        assert_eq!(constant_lanes([1.0, 2.0, 3.0]) - constant_lanes([1.0, 2.0, 3.0]), g.zero());
        assert_eq!(constant_lanes([1.0, 2.0, 4.0]) * constant_lanes([4.0, 2.0, 1.0]), g.num(4.0));
        assert_eq!((constant_lanes([1.0, 2.0, 3.0]) * x) * g.num(2.0), constant_lanes([2.0, 4.0, 6.0]) * x);
        assert_eq!((constant_lanes([1.0, 2.0, 3.0]) + x) - g.num(1.0), constant_lanes([0.0, 1.0, 2.0]) + x);
        assert_eq!(constant_lanes([-1.0, 2.0, 3.0]) * x, -(constant_lanes([1.0, -2.0, -3.0]) * x));
        assert_eq!(x / constant_lanes([1.0, 2.0, 4.0]), constant_lanes([1.0, 0.5, 0.25]) * x);
        assert_eq!(constant_lanes([1.0, 2.0, 3.0]).lane_sum(3), g.num(6.0));
        assert_eq!(g.num(2.0).lane_sum(3), g.num(6.0));
        assert_eq!((-x).lane_sum(3), -x.lane_sum(3));
        assert_eq!(x.lane(1), g.symbol(Symbol(1)));
    }

    #[test]
    fn pairs_of_lanes_are_concatenated() {
        let g = Graph::new();
        let [x, y] = [[0, 1], [2, 3]].map(|s| g.lane_input_of_symbols(&s.map(Symbol)));
        let s = g.symbol(Symbol(0));
        assert_eq!(s.append_lanes(1, s), s, "what has no lanes is the same in all");
        assert_eq!(
            g.lanes_from_constants(&[1.0, 2.0]).append_lanes(2, g.num(3.0)),
            g.lanes_from_constants(&[1.0, 2.0, 3.0, 3.0])
        );
        let both = x.square().append_lanes(2, y.square());
        assert_eq!((-x.square()).append_lanes(2, -y.square()), -both);
        assert_eq!(x.append_lanes(2, y).lane(2), g.symbol(Symbol(2)));
        let all = both * g.lanes_from_constants(&[1.0, 2.0, 3.0, 4.0]) + s;
        let lanes: Vec<Expr<'_>> = (0..4).map(|k| all.lane(k)).chain([all.lane_sum(4)]).collect();
        let value_of_symbol = |s: Symbol| f64::from(s.0) + 1.0;
        let expected = [2.0, 9.0, 28.0, 65.0, 104.0];
        assert_eq!(eval(&lanes, &value_of_symbol), expected);
        assert_eq!(crate::lower::lower(&lanes).interpret_program(&value_of_symbol), expected);
    }

    #[test]
    fn lanes_are_evaluated_independently() {
        let g = Graph::new();
        let x = g.lane_input_of_symbols(&[Symbol(0), Symbol(1), Symbol(2)]);
        let y = g.symbol(Symbol(3));
        let e = g.lanes_from_constants(&[1.0, -2.0, 3.0]) * x.square() + y;
        let values = eval(&[e.lane_sum(3), e.lane(2), e.lane_sum(3) * y], &|s| f64::from(s.0) + 1.0);
        assert_eq!(values, [1.0 - 8.0 + 27.0 + 12.0, 31.0, 32.0 * 4.0]);
    }
}
