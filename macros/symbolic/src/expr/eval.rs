//! Numerical evaluation of expressions, used as a reference in tests and to check models.

use super::lanes::MAX_LANES;
use super::node::{Id, Node, Symbol};
use super::{Expr, Graph, Memo};

/// Evaluates several expressions of one graph at these values of the symbols.
pub fn eval(roots: &[Expr<'_>], symbol: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
    Tape::new(roots).evaluate_at(symbol)
}

/// Evaluates one expression at these values of the symbols.
pub fn eval_one(root: Expr<'_>, symbol: &dyn Fn(Symbol) -> f64) -> f64 {
    eval(&[root], symbol)[0]
}

/// The nodes of several expressions in order of evaluation, for repeated evaluation.
pub struct Tape<'g> {
    graph: Option<&'g Graph>,
    /// The nodes, with the positions of their operands in this list.
    steps: Vec<(Node, [u32; 3])>,
    /// Indices in `steps` of the expressions whose values are returned.
    roots: Vec<u32>,
    /// True if a node of the tape has several SIMD lanes.
    in_lanes: bool,
}

impl<'g> Tape<'g> {
    /// Collects the nodes of expressions, which belong to one graph.
    pub fn new(roots: &[Expr<'g>]) -> Tape<'g> {
        let mut tape = Tape { graph: None, steps: Vec::new(), roots: Vec::new(), in_lanes: false };
        let Some(first) = roots.first() else { return tape };
        let graph = first.graph();
        let mut places = Memo::new(graph);
        for id in nodes_in_order(graph, roots) {
            let (node, mut operands, mut count) = (graph.node(id), [0; 3], 0);
            node.visit_operands(|a| {
                operands[count] = places.get(a).unwrap_or(0);
                count += 1;
            });
            places.assign_number(id, tape.steps.len() as u32);
            tape.in_lanes |= is_lane_node(node);
            tape.steps.push((node, operands));
        }
        tape.roots = roots.iter().map(|r| places.get(r.id()).unwrap_or(0)).collect();
        tape.graph = Some(graph);
        tape
    }

    /// Returns the number of nodes of the tape, including symbols and constants.
    pub fn node_count(&self) -> usize {
        self.steps.len()
    }

    /// Evaluates the expressions of the tape at these values of the symbols.
    pub fn evaluate_at(&self, symbol: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
        self.evaluate_tape(symbol)
    }

    /// Evaluates the expressions of the tape with estimates of their rounding errors.
    pub fn evaluate_with_rounding(&self, symbol: &dyn Fn(Symbol) -> f64) -> Vec<ValueWithRoundingError> {
        let values = self.evaluate_tape(&|s| PerturbedValue::from_number(symbol(s)));
        values.into_iter().map(PerturbedValue::with_rounding_error).collect()
    }

    fn evaluate_tape<V: TapeNumber>(&self, symbol: &dyn Fn(Symbol) -> V) -> Vec<V> {
        match self.graph {
            None => Vec::new(),
            Some(graph) if self.in_lanes => self.evaluate_and_take_first_lane::<V, MAX_LANES>(graph, symbol),
            Some(graph) => self.evaluate_and_take_first_lane::<V, 1>(graph, symbol),
        }
    }

    /// Evaluates all nodes in `N` lanes and returns the first lane of each expression.
    fn evaluate_and_take_first_lane<V: TapeNumber, const N: usize>(
        &self,
        graph: &Graph,
        symbol: &dyn Fn(Symbol) -> V,
    ) -> Vec<V> {
        let none = V::from_number(f64::NAN);
        let pad_to_lane_count = |list: Vec<V>| std::array::from_fn(|k| list.get(k).copied().unwrap_or(none));
        let mut values: Vec<[V; N]> = Vec::with_capacity(self.steps.len());
        for (node, [a, b, c]) in &self.steps {
            let lanes_at_tape_index = |place: u32| values.get(place as usize).copied().unwrap_or([none; N]);
            let value = match *node {
                Node::Tuple(k) => {
                    pad_to_lane_count(graph.lanes_of_tuple(k).into_iter().map(V::from_number).collect())
                }
                Node::Gather(k) => {
                    pad_to_lane_count(graph.symbols_of_gather(k).into_iter().map(symbol).collect())
                }
                Node::Sum(n, _) => [V::sum_of_lanes(&lanes_at_tape_index(*a)[..usize::from(n)]); N],
                Node::Lane(k, _) => [lanes_at_tape_index(*a)[usize::from(k)]; N],
                Node::Join(n, _, _) => join_lanes(n.into(), lanes_at_tape_index(*a), lanes_at_tape_index(*b)),
                Node::Symbol(s) => [symbol(s); N],
                node => {
                    let (a, b, c) =
                        (lanes_at_tape_index(*a), lanes_at_tape_index(*b), lanes_at_tape_index(*c));
                    std::array::from_fn(|lane| V::apply_node_operation(node, [a[lane], b[lane], c[lane]]))
                }
            };
            values.push(value);
        }
        self.roots.iter().map(|place| values[*place as usize][0]).collect()
    }
}

/// Number type in which a tape is evaluated.
trait TapeNumber: Copy {
    /// Converts a constant to this number type.
    fn from_number(number: f64) -> Self;
    fn sum_of_lanes(lanes: &[Self]) -> Self;
    /// Applies the operation of a node to the values of its operands.
    fn apply_node_operation(node: Node, operands: [Self; 3]) -> Self;
}

impl TapeNumber for f64 {
    fn from_number(number: f64) -> f64 {
        number
    }

    fn sum_of_lanes(lanes: &[f64]) -> f64 {
        lanes.iter().sum()
    }

    fn apply_node_operation(node: Node, operands: [f64; 3]) -> f64 {
        apply_operation(node, operands)
    }
}

/// A value with an estimate of its rounding error.
#[derive(Clone, Copy, Debug)]
pub struct ValueWithRoundingError {
    /// Computed value of a node of the tape.
    pub value: f64,
    /// Standard deviation of the rounding error, in the unit of the value.
    pub error: f64,
}

impl ValueWithRoundingError {
    /// Maximum ratio of a value to its error for which the value may be rounding error alone. For random
    /// mechanisms, the ratio of pivots of the mass matrix that are exactly zero is at most 0.5. That of other
    /// pivots is at least `1e9`, or `1e6` if masses differ by twelve orders of magnitude.
    const MOST_ERRORS: f64 = 32.0;

    /// Returns true if the exact value may be zero within the estimated rounding error.
    pub fn may_be_zero(self) -> bool {
        self.value.abs() <= Self::MOST_ERRORS * self.error
    }
}

/// Number of perturbed values for each value.
const PERTURBED: usize = 4;

/// A value, and the values for random perturbations of all constants, symbols and operations by relative
/// errors with the standard deviation [`f64::EPSILON`] (Monte Carlo arithmetic: Parker, Pierce and Eggert,
/// *Monte Carlo arithmetic: how to gamble with floating point and win*, Comput. Sci. Eng. 2, 2000). Unlike
/// bounds of single errors, perturbed values keep the correlations of errors, so that errors do not seem to
/// grow in long products of rotations.
#[derive(Clone, Copy)]
struct PerturbedValue {
    value: f64,
    perturbed: [f64; PERTURBED],
}

impl PerturbedValue {
    /// Perturbs values by errors that depend on the digits of `value` alone, so that results are
    /// reproducible.
    fn with_perturbations(value: f64, perturbed: [f64; PERTURBED]) -> PerturbedValue {
        let mut random = value.to_bits();
        let perturbed = perturbed.map(|exact| {
            // The generator SplitMix64 (Steele, Lea and Flood, 2014).
            random = random.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut mixed = random;
            mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            mixed ^= mixed >> 31;
            let uniform = (mixed >> 11) as f64 / (1_u64 << 53) as f64;
            // Uniform in an interval with the standard deviation one.
            exact * (1.0 + f64::EPSILON * (2.0 * uniform - 1.0) * 3_f64.sqrt())
        });
        PerturbedValue { value, perturbed }
    }

    fn with_rounding_error(self) -> ValueWithRoundingError {
        let squares = self.perturbed.map(|perturbed| (perturbed - self.value).powi(2));
        let error = (squares.iter().sum::<f64>() / PERTURBED as f64).sqrt();
        // A number that is not finite has an unknown error.
        ValueWithRoundingError {
            value: self.value,
            error: if error.is_nan() { f64::INFINITY } else { error },
        }
    }
}

impl TapeNumber for PerturbedValue {
    fn from_number(number: f64) -> PerturbedValue {
        PerturbedValue::with_perturbations(number, [number; PERTURBED])
    }

    fn sum_of_lanes(lanes: &[PerturbedValue]) -> PerturbedValue {
        let sum = |of: &dyn Fn(&PerturbedValue) -> f64| lanes.iter().map(of).sum::<f64>();
        let perturbed = std::array::from_fn(|k| sum(&|lane| lane.perturbed[k]));
        PerturbedValue::with_perturbations(sum(&|lane| lane.value), perturbed)
    }

    fn apply_node_operation(node: Node, operands: [PerturbedValue; 3]) -> PerturbedValue {
        let value = apply_operation(node, operands.map(|operand| operand.value));
        let perturbed = |k: usize| apply_operation(node, operands.map(|operand| operand.perturbed[k]));
        PerturbedValue::with_perturbations(value, std::array::from_fn(perturbed))
    }
}

/// Returns the nodes that the expressions depend on, operands before operations.
pub fn nodes_in_order(graph: &Graph, roots: &[Expr<'_>]) -> Vec<Id> {
    let mut seen = Memo::new(graph);
    let mut needed = Vec::new();
    let mut todo: Vec<Id> = roots.iter().map(|r| r.id()).collect();
    while let Some(id) = todo.pop() {
        if seen.get(id).is_none() {
            seen.assign_number(id, 0);
            needed.push(id);
            graph.node(id).visit_operands(|a| todo.push(a));
        }
    }
    // Operands have smaller indices than the operations on them.
    needed.sort_unstable();
    needed
}

fn is_lane_node(node: Node) -> bool {
    matches!(node, Node::Tuple(_) | Node::Gather(_) | Node::Sum(..) | Node::Lane(..) | Node::Join(..))
}

/// Returns the first `n` lanes of `a`, followed by the lanes of `b`.
pub fn join_lanes<V: Copy, const N: usize>(n: usize, a: [V; N], b: [V; N]) -> [V; N] {
    std::array::from_fn(|k| if k < n { a[k] } else { b[k - n] })
}

/// Applies the operation of a node to the numbers of its operands. NaN for symbols and lane operations.
fn apply_operation(node: Node, [a, b, c]: [f64; 3]) -> f64 {
    match node {
        Node::Const(number) => number,
        Node::Neg(_) => -a,
        Node::Add(..) => a + b,
        Node::Sub(..) => a - b,
        Node::Mul(..) => a * b,
        Node::Div(..) => a / b,
        Node::Call(f, _) => f.evaluate_at(a),
        Node::Atan2(..) => libm::atan2(a, b),
        Node::Pow(..) => libm::pow(a, b),
        Node::Extreme(f, ..) => f.evaluate_extreme(a, b),
        Node::Table(lookup, ..) => lookup.evaluate_surrogate([a, b, c]),
        Node::Symbol(_)
        | Node::Tuple(_)
        | Node::Gather(_)
        | Node::Sum(..)
        | Node::Lane(..)
        | Node::Join(..) => f64::NAN,
    }
}
