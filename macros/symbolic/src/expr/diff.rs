//! Differentiation with respect to a symbol, or along a direction in the space of several symbols.

use super::node::{Extreme, Function, Id, Node, Symbol};
use super::{Expr, Graph, Memo, air};
use std::collections::BTreeMap;

/// Constant added to lengths to avoid division by zero: too small to change a result, but a normal number in
/// `f32`.
pub const TINY: f64 = 1e-37;

/// Differentiates an expression with respect to all symbols in reverse mode. Each node is visited once, after
/// all operations on it, with the derivative of the expression by this node. Efficient for many symbols deep
/// in the expression.
pub fn gradient<'g>(e: Expr<'g>, symbols: &[Symbol]) -> Vec<Expr<'g>> {
    let g = e.graph();
    let mut found = vec![g.zero(); symbols.len()];
    // Operands have smaller indices than the operations on them. The derivative by the node with the largest
    // index is therefore complete.
    let mut open = BTreeMap::from([(e.id(), g.one())]);
    while let Some((id, by)) = open.pop_last() {
        let node = g.node(id);
        if let Node::Symbol(s) = node {
            for (found, _) in found.iter_mut().zip(symbols).filter(|(_, symbol)| **symbol == s) {
                *found = by;
            }
        }
        let mut operands = Vec::new();
        node.visit_operands(|a| {
            if !operands.contains(&a) {
                operands.push(a);
            }
        });
        for a in operands {
            // Partial derivative of the node by this operand, all other operands constant.
            let by_operand = DirectionalDerivative::with_respect_to_operand(a, g);
            let step = by_operand.differentiate_node(id);
            if !step.is_zero() {
                let sum = open.entry(a).or_insert(g.zero());
                *sum += by * step;
            }
        }
    }
    found
}

/// Directional derivatives of the expressions of one graph, with a cache of computed results.
pub struct DirectionalDerivative<'g> {
    graph: &'g Graph,
    /// Rates of change of symbols along the direction. All other symbols are constant.
    rates: Vec<(Symbol, Expr<'g>)>,
    /// Index of the derivative of each node that was differentiated.
    known: Memo<'g>,
}

impl<'g> DirectionalDerivative<'g> {
    /// Creates the differentiation of expressions with respect to `symbol`.
    pub fn with_respect_to(symbol: Symbol, graph: &'g Graph) -> DirectionalDerivative<'g> {
        DirectionalDerivative::differentiation_with_rates(vec![(symbol, graph.one())], graph)
    }

    /// Creates the differentiation along a direction in which the symbols change at the given rates and all
    /// others are constant.
    pub fn differentiation_with_rates(
        rates: Vec<(Symbol, Expr<'g>)>,
        graph: &'g Graph,
    ) -> DirectionalDerivative<'g> {
        DirectionalDerivative { graph, rates, known: Memo::new(graph) }
    }

    /// Presets the derivatives of some expressions, instead of differentiating their operands. If a preset
    /// expression is a negation, a multiple, or a sum with a constant, the derivative of its operand is
    /// preset as well.
    pub fn with_preset_derivatives(
        mut self,
        derivatives: impl IntoIterator<Item = (Expr<'g>, Expr<'g>)>,
    ) -> DirectionalDerivative<'g> {
        for (e, derivative) in derivatives {
            let (mut e, mut derivative) = (e, derivative);
            loop {
                self.known.assign_number(e.id(), derivative.id());
                let expression_of_id = |id: Id| self.graph.expr(id);
                let constant_value = |id: Id| expression_of_id(id).constant_value();
                (e, derivative) = match e.node() {
                    Node::Neg(a) => (expression_of_id(a), -derivative),
                    Node::Add(a, b) if constant_value(a).is_some() => (expression_of_id(b), derivative),
                    Node::Add(a, b) | Node::Sub(a, b) if constant_value(b).is_some() => {
                        (expression_of_id(a), derivative)
                    }
                    Node::Sub(a, b) if constant_value(a).is_some() => (expression_of_id(b), -derivative),
                    Node::Mul(a, b) => match (constant_value(a), constant_value(b)) {
                        (Some(c), _) if c != 0.0 => (expression_of_id(b), derivative * (1.0 / c)),
                        (_, Some(c)) if c != 0.0 => (expression_of_id(a), derivative * (1.0 / c)),
                        _ => break,
                    },
                    _ => break,
                };
                if e.constant_value().is_some() || matches!(e.node(), Node::Symbol(_)) {
                    break;
                }
            }
        }
        self
    }

    /// Creates the partial differentiation of an operation with respect to its operand `id`. Its other
    /// operands are constant.
    fn with_respect_to_operand(id: Id, graph: &'g Graph) -> DirectionalDerivative<'g> {
        let mut derivative = DirectionalDerivative::differentiation_with_rates(Vec::new(), graph);
        derivative.known.assign_number(id, graph.one().id());
        derivative
    }

    /// Returns the derivative of the expression `e`.
    pub fn differentiate(&mut self, e: Expr<'g>) -> Expr<'g> {
        // Operands before operations, without recursion: a deep chain must not exhaust the stack.
        let mut todo = vec![e.id()];
        while let Some(&id) = todo.last() {
            if self.known.get(id).is_some() {
                todo.pop();
                continue;
            }
            let before = todo.len();
            self.graph.node(id).visit_operands(|a| {
                if self.known.get(a).is_none() {
                    todo.push(a);
                }
            });
            if todo.len() == before {
                let derivative = self.differentiate_node(id).id();
                self.known.assign_number(id, derivative);
                todo.pop();
            }
        }
        self.known_derivative(e.id())
    }

    fn known_derivative(&self, id: Id) -> Expr<'g> {
        self.known.get(id).map_or(self.graph.zero(), |d| self.graph.expr(d))
    }

    fn differentiate_node(&self, id: Id) -> Expr<'g> {
        let expression_of_id = |id: Id| self.graph.expr(id);
        let derivative_of_id = |id: Id| self.known_derivative(id);
        match self.graph.node(id) {
            // Derivatives are taken before the inputs of lanes are gathered.
            Node::Const(_) | Node::Tuple(_) | Node::Gather(_) => self.graph.zero(),
            Node::Sum(n, a) => derivative_of_id(a).lane_sum(n.into()),
            Node::Lane(k, a) => derivative_of_id(a).lane(k.into()),
            Node::Join(n, a, b) => derivative_of_id(a).append_lanes(n.into(), derivative_of_id(b)),
            Node::Symbol(s) => self
                .rates
                .iter()
                .find(|(symbol, _)| *symbol == s)
                .map_or(self.graph.zero(), |(_, rate)| *rate),
            Node::Neg(a) => -derivative_of_id(a),
            Node::Add(a, b) => derivative_of_id(a) + derivative_of_id(b),
            Node::Sub(a, b) => derivative_of_id(a) - derivative_of_id(b),
            Node::Mul(a, b) => {
                derivative_of_id(a) * expression_of_id(b) + expression_of_id(a) * derivative_of_id(b)
            }
            Node::Div(a, b) => {
                (derivative_of_id(a) - expression_of_id(id) * derivative_of_id(b)) / expression_of_id(b)
            }
            Node::Call(f, a) if derivative_of_id(a).is_zero() => expression_of_id(a).apply_function(f).zero(),
            Node::Call(f, a) => {
                self.outer_derivative(f, expression_of_id(a), expression_of_id(id)) * derivative_of_id(a)
            }
            Node::Atan2(y, x) => {
                (expression_of_id(x) * derivative_of_id(y) - expression_of_id(y) * derivative_of_id(x))
                    / (expression_of_id(x).square() + expression_of_id(y).square())
            }
            Node::Extreme(_, a, b) if derivative_of_id(a) == derivative_of_id(b) => derivative_of_id(a),
            Node::Extreme(f, a, b) => {
                let sign = (expression_of_id(a) - expression_of_id(b)).apply_function(Function::Signum);
                let change = (derivative_of_id(a) - derivative_of_id(b)) * sign;
                let sum = derivative_of_id(a) + derivative_of_id(b);
                (if f == Extreme::Max { sum + change } else { sum - change }) * 0.5
            }
            Node::Table(lookup, a, b, c) => {
                let x = [a, b, c];
                (0..lookup.variable_count()).fold(self.graph.zero(), |sum, k| {
                    match lookup.partial_derivative(k) {
                        Some(slope) if !derivative_of_id(x[k]).is_zero() => {
                            sum + self.graph.table_lookup(slope, x.map(expression_of_id))
                                * derivative_of_id(x[k])
                        }
                        _ => sum,
                    }
                })
            }
            Node::Pow(a, b) => {
                // This form is finite at a base of zero, where the power laws of force elements begin.
                let base_derivative_of_power =
                    |b: Expr<'g>| b * expression_of_id(a).pow(b - self.graph.one());
                let base = if derivative_of_id(a).is_zero() {
                    self.graph.zero()
                } else {
                    base_derivative_of_power(expression_of_id(b)) * derivative_of_id(a)
                };
                match derivative_of_id(b).is_zero() {
                    true => base,
                    false => {
                        base + expression_of_id(id)
                            * derivative_of_id(b)
                            * expression_of_id(a).apply_function(Function::Ln)
                    }
                }
            }
        }
    }

    /// Returns the derivative `f'(x)` of an elementary function, given `y = f(x)`.
    fn outer_derivative(&self, f: Function, x: Expr<'g>, y: Expr<'g>) -> Expr<'g> {
        let one = self.graph.one();
        match f {
            Function::Sin => x.cos(),
            Function::Cos => -x.sin(),
            Function::Tan => one + y.square(),
            Function::Asin => one / (one - x.square()).sqrt(),
            Function::Acos => -(one / (one - x.square()).sqrt()),
            Function::Atan => one / (one + x.square()),
            Function::Sinh => x.apply_function(Function::Cosh),
            Function::Cosh => x.apply_function(Function::Sinh),
            Function::Tanh => one - y.square(),
            Function::Exp => y,
            Function::Ln => one / x,
            // Finite where the root is zero. In derivatives of lengths, the other factor is zero there too.
            Function::Sqrt => one / ((y + y.num(TINY)) * 2.0),
            Function::Abs => x.apply_function(Function::Signum),
            Function::Signum | Function::IsaLapseRate => self.graph.zero(),
            Function::IsaTemperature => x.apply_function(Function::IsaLapseRate),
            // Hydrostatic equation.
            Function::IsaPressure => -(y / x.apply_function(Function::IsaTemperature) * air::FALL_OVER_GAS),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::eval::eval_one;

    /// Reverse and forward mode give the same derivatives.
    #[test]
    fn reverse_and_forward_differentiation_agree() {
        let g = Graph::new();
        let symbols = [0, 1, 2].map(Symbol);
        let [x, y, z] = symbols.map(|s| g.symbol(s));
        let shared = (x * y + z).sin();
        let e = shared * shared / (y.square() + z.apply_function(Function::Exp)) + x.atan2(shared)
            - (z - x * shared).sqrt() * y.pow(x);
        let found = gradient(e, &symbols);
        let value_at_sample_point = |e: Expr<'_>| eval_one(e, &|s| [0.7, 1.3, 1.9][s.0 as usize]);
        for (symbol, found) in symbols.into_iter().zip(found) {
            let expected =
                value_at_sample_point(DirectionalDerivative::with_respect_to(symbol, &g).differentiate(e));
            assert!(
                (value_at_sample_point(found) - expected).abs() < 1e-13 * (1.0 + expected.abs()),
                "{symbol:?}"
            );
        }
    }
}
