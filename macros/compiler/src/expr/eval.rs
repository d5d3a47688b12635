//! Evaluation of expressions with numbers: the oracle of the tests and of the checks of a model.

use super::lanes::MAX_LANES;
use super::node::{Id, Node, Symbol};
use super::{Expr, Graph, Memo};

/// The values of several expressions of one graph, given the value of every symbol.
pub fn eval(roots: &[Expr<'_>], symbol: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
    Tape::of(roots).values(symbol)
}

/// The value of one expression.
pub fn eval_one(root: Expr<'_>, symbol: &dyn Fn(Symbol) -> f64) -> f64 {
    eval(&[root], symbol)[0]
}

/// What several expressions need, in order, to be evaluated more than once.
pub struct Tape<'g> {
    graph: Option<&'g Graph>,
    /// Every node with its operands' places on the tape.
    steps: Vec<(Node, [u32; 3])>,
    /// Where the values of the expressions are.
    roots: Vec<u32>,
    /// Some node has several lanes.
    in_lanes: bool,
}

impl<'g> Tape<'g> {
    /// For the given expressions, all of one graph.
    pub fn of(roots: &[Expr<'g>]) -> Tape<'g> {
        let mut tape = Tape { graph: None, steps: Vec::new(), roots: Vec::new(), in_lanes: false };
        let Some(first) = roots.first() else { return tape };
        let graph = first.graph();
        let mut places = Memo::new(graph);
        for id in needed(graph, roots) {
            let (node, mut operands, mut count) = (graph.node(id), [0; 3], 0);
            node.operands(|a| {
                operands[count] = places.get(a).unwrap_or(0);
                count += 1;
            });
            places.set(id, tape.steps.len() as u32);
            tape.in_lanes |= is_of_lanes(node);
            tape.steps.push((node, operands));
        }
        tape.roots = roots.iter().map(|r| places.get(r.id()).unwrap_or(0)).collect();
        tape.graph = Some(graph);
        tape
    }

    /// How many operations it has, symbols and constants included.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// The values of the expressions.
    pub fn values(&self, symbol: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
        match self.graph {
            None => Vec::new(),
            Some(graph) if self.in_lanes => self.run::<MAX_LANES>(graph, symbol),
            Some(graph) => self.run::<1>(graph, symbol),
        }
    }

    /// The values of the expressions (their first lanes), everything computed in so many lanes.
    fn run<const N: usize>(&self, graph: &Graph, symbol: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
        let mut values: Vec<[f64; N]> = Vec::with_capacity(self.steps.len());
        for (node, [a, b, c]) in &self.steps {
            let at = |place: u32| values.get(place as usize).copied().unwrap_or([f64::NAN; N]);
            let value = match *node {
                Node::Tuple(k) => padded(&graph.tuple(k)),
                Node::Gather(k) => padded(&graph.gather(k).into_iter().map(symbol).collect::<Vec<_>>()),
                Node::Sum(n, _) => [at(*a)[..usize::from(n)].iter().sum(); N],
                Node::Lane(k, _) => [at(*a)[usize::from(k)]; N],
                Node::Join(n, _, _) => joined(n.into(), at(*a), at(*b)),
                Node::Symbol(s) => [symbol(s); N],
                node => {
                    let (a, b, c) = (at(*a), at(*b), at(*c));
                    std::array::from_fn(|lane| step(node, [a[lane], b[lane], c[lane]]))
                }
            };
            values.push(value);
        }
        self.roots.iter().map(|place| values[*place as usize][0]).collect()
    }
}

/// The nodes that the expressions depend on, operands first.
pub fn needed(graph: &Graph, roots: &[Expr<'_>]) -> Vec<Id> {
    let mut seen = Memo::new(graph);
    let mut needed = Vec::new();
    let mut todo: Vec<Id> = roots.iter().map(|r| r.id()).collect();
    while let Some(id) = todo.pop() {
        if seen.get(id).is_none() {
            seen.set(id, 0);
            needed.push(id);
            graph.node(id).operands(|a| todo.push(a));
        }
    }
    // Operands are made before operations.
    needed.sort_unstable();
    needed
}

fn is_of_lanes(node: Node) -> bool {
    matches!(node, Node::Tuple(_) | Node::Gather(_) | Node::Sum(..) | Node::Lane(..) | Node::Join(..))
}

/// So many lanes of `a`, then those of `b`.
pub fn joined<const N: usize>(n: usize, a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| if k < n { a[k] } else { b[k - n] })
}

fn padded<const N: usize>(list: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| list.get(k).copied().unwrap_or(f64::NAN))
}

/// An operation on the values of its operands.
fn step(node: Node, [a, b, c]: [f64; 3]) -> f64 {
    match node {
        Node::Const(number) => number,
        Node::Neg(_) => -a,
        Node::Add(..) => a + b,
        Node::Sub(..) => a - b,
        Node::Mul(..) => a * b,
        Node::Div(..) => a / b,
        Node::Call(f, _) => f.apply(a),
        Node::Atan2(..) => a.atan2(b),
        Node::Pow(..) => a.powf(b),
        Node::Extreme(f, ..) => f.apply(a, b),
        Node::Table(lookup, ..) => lookup.apply([a, b, c]),
        Node::Symbol(_)
        | Node::Tuple(_)
        | Node::Gather(_)
        | Node::Sum(..)
        | Node::Lane(..)
        | Node::Join(..) => f64::NAN,
    }
}
