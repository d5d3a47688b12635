//! Evaluation of expressions with numbers: the oracle of the tests and of the checks of a model.

use super::graph::Expr;
use super::node::{Node, Symbol};

/// The values of several expressions of one graph, given the value of every symbol.
pub fn eval(roots: &[Expr<'_>], symbol: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
    let Some(first) = roots.first() else {
        return Vec::new();
    };
    let nodes = first.graph().nodes();
    let mut needed = vec![false; nodes.len()];
    for root in roots {
        needed[root.id() as usize] = true;
    }
    for id in (0..nodes.len()).rev().filter(|id| needed[*id]).collect::<Vec<_>>() {
        mark(&nodes, id, &mut needed);
    }
    let mut values = vec![0.0_f64; nodes.len()];
    for id in 0..nodes.len() {
        if needed[id] {
            values[id] = step(nodes[id], &values, symbol);
        }
    }
    roots.iter().map(|r| values[r.id() as usize]).collect()
}

/// The value of one expression.
pub fn eval_one(root: Expr<'_>, symbol: &dyn Fn(Symbol) -> f64) -> f64 {
    eval(&[root], symbol)[0]
}

fn mark(nodes: &[Node], root: usize, needed: &mut [bool]) {
    let mut todo = vec![root];
    while let Some(id) = todo.pop() {
        nodes[id].operands(|a| {
            if !needed[a as usize] {
                needed[a as usize] = true;
                todo.push(a as usize);
            }
        });
    }
}

fn step(node: Node, values: &[f64], symbol: &dyn Fn(Symbol) -> f64) -> f64 {
    let at = |id: u32| values[id as usize];
    match node {
        Node::Const(c) => c,
        Node::Symbol(s) => symbol(s),
        Node::Neg(a) => -at(a),
        Node::Add(a, b) => at(a) + at(b),
        Node::Sub(a, b) => at(a) - at(b),
        Node::Mul(a, b) => at(a) * at(b),
        Node::Div(a, b) => at(a) / at(b),
        Node::Call(f, a) => f.apply(at(a)),
        Node::Atan2(a, b) => at(a).atan2(at(b)),
        Node::Pow(a, b) => at(a).powf(at(b)),
    }
}
