//! Evaluation of expressions with numbers: the oracle of the tests and of the checks of a model.

use super::graph::{Expr, Graph};
use super::lanes::MOST;
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
    let graph = first.graph();
    let all = |id: &usize| needed[*id];
    let is_lane =
        |id: usize| matches!(nodes[id], Node::Tuple(_) | Node::Gather(_) | Node::Sum(..) | Node::Lane(..));
    match (0..nodes.len()).filter(all).any(is_lane) {
        true => values::<MOST>(graph, &nodes, &needed, symbol, roots),
        false => values::<1>(graph, &nodes, &needed, symbol, roots),
    }
}

/// The values of `roots` (their first lanes), all needed nodes computed in so many lanes.
fn values<const N: usize>(
    graph: &Graph,
    nodes: &[Node],
    needed: &[bool],
    symbol: &dyn Fn(Symbol) -> f64,
    roots: &[Expr<'_>],
) -> Vec<f64> {
    let mut values = vec![[0.0_f64; N]; nodes.len()];
    for id in (0..nodes.len()).filter(|id| needed[*id]) {
        let at = |a: u32| &values[a as usize];
        values[id] = match nodes[id] {
            Node::Tuple(k) => padded(&graph.tuple(k)),
            Node::Gather(k) => padded(&graph.gather(k).into_iter().map(symbol).collect::<Vec<_>>()),
            Node::Sum(n, a) => [at(a)[..usize::from(n)].iter().sum(); N],
            Node::Lane(k, a) => [at(a)[usize::from(k)]; N],
            node => std::array::from_fn(|lane| step(node, &|a| at(a)[lane], symbol)),
        };
    }
    roots.iter().map(|r| values[r.id() as usize][0]).collect()
}

fn padded<const N: usize>(list: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| list.get(k).copied().unwrap_or(f64::NAN))
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

fn step(node: Node, at: &dyn Fn(u32) -> f64, symbol: &dyn Fn(Symbol) -> f64) -> f64 {
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
        Node::Tuple(_) | Node::Gather(_) | Node::Sum(..) | Node::Lane(..) => f64::NAN,
    }
}
