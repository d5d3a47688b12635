//! The expression graph: nodes are shared, so that structurally equal expressions have one index, and every
//! constructor simplifies.
//!
//! Normal form, maintained by the constructors:
//!
//! - Constants are folded; zero summands and unit factors vanish.
//! - A minus sign is lifted out of products, quotients, differences and odd functions, and absorbed by sums,
//!   so that `a − b` and `b − a` share one node.
//! - Operands of commutative operations are ordered by index.
//! - Several constants in one product or sum are merged.
//!
//! Only rewrites that never cost an operation are made. The product of `2 x` and `y` is not reassociated,
//! since `2 x` may be used elsewhere. A constant for each lane counts as a constant.

use super::handle::Expr;
use super::lanes::InternedLaneData;
use super::node::{Function, Id, Lookup, Node, Symbol};
use std::cell::{Ref, RefCell, RefMut};
use std::fmt;

struct NodeStore {
    nodes: Vec<Node>,
    /// Hash table with open addressing. Its size is a power of two; free slots contain `EMPTY`.
    table: Vec<Id>,
    /// Maximum number of nodes of the expression graph.
    most: usize,
    /// True if a node was rejected because the graph has its maximum number of nodes.
    is_full: bool,
}

const EMPTY: Id = Id::MAX;

/// Maximum number of nodes of a graph. Derivatives of a chain of 64 skew pins have 1.3 million. With four
/// million the compiler takes a gibibyte of memory and tens of seconds, and rustc several times as much for
/// the generated code.
const MOST_NODES: usize = 4_000_000;

impl NodeStore {
    fn intern_node(&mut self, node: Node) -> Id {
        let mask = self.table.len() - 1;
        let mut slot = node.hash() as usize & mask;
        loop {
            let id = self.table[slot];
            if id == EMPTY {
                break;
            }
            if self.nodes[id as usize].is_bitwise_equal_node(node) {
                return id;
            }
            slot = (slot + 1) & mask;
        }
        if self.nodes.len() >= self.most {
            self.is_full = true;
            return ZERO;
        }
        let id = self.nodes.len() as Id;
        self.nodes.push(node);
        self.table[slot] = id;
        if self.nodes.len() * 2 > self.table.len() {
            self.grow_table();
        }
        id
    }

    fn grow_table(&mut self) {
        let size = self.table.len() * 2;
        self.table.clear();
        self.table.resize(size, EMPTY);
        for (id, node) in self.nodes.iter().enumerate() {
            let mut slot = node.hash() as usize & (size - 1);
            while self.table[slot] != EMPTY {
                slot = (slot + 1) & (size - 1);
            }
            self.table[slot] = id as Id;
        }
    }
}

/// Graph that owns all expressions of a mechanism.
pub struct Graph {
    store: RefCell<NodeStore>,
    /// Table with a number for every node, all zero between uses.
    table: RefCell<Vec<u32>>,
    /// Unused lookup tables that contain only zeros, see [`Memo`](super::Memo).
    tables: RefCell<Vec<Vec<u32>>>,
    /// Constants and symbols of expressions with SIMD lanes.
    pub(super) lanes: RefCell<InternedLaneData>,
    /// Names of the functions that are defined by tables.
    functions: RefCell<Vec<String>>,
}

impl Default for Graph {
    fn default() -> Graph {
        Graph::new()
    }
}

impl fmt::Debug for Graph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Graph of {} nodes", self.len())
    }
}

pub(super) const ZERO: Id = 0;
const ONE: Id = 1;

impl Graph {
    /// Creates a graph that contains only the constants zero and one.
    pub fn new() -> Graph {
        Graph::graph_with_node_limit(MOST_NODES)
    }

    /// Creates an expression graph with a maximum number of nodes.
    pub fn graph_with_node_limit(most: usize) -> Graph {
        let mut store =
            NodeStore { nodes: Vec::new(), table: vec![EMPTY; 1024], most: most.max(2), is_full: false };
        store.intern_node(Node::Const(0.0));
        store.intern_node(Node::Const(1.0));
        Graph {
            store: RefCell::new(store),
            table: RefCell::default(),
            tables: RefCell::default(),
            lanes: RefCell::default(),
            functions: RefCell::default(),
        }
    }

    /// Returns the number of nodes of the graph.
    pub fn len(&self) -> usize {
        self.store.borrow().nodes.len()
    }

    /// Returns true if the maximum number of nodes was exceeded. Further new expressions are zero, so that no
    /// work is spent on them, and all results must be discarded.
    pub fn is_full(&self) -> bool {
        self.store.borrow().is_full
    }

    /// Returns false, since a graph always contains the constants zero and one.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Returns the node of the graph with an index.
    pub fn node(&self, id: Id) -> Node {
        self.store.borrow().nodes[id as usize]
    }

    /// Returns all nodes, operands before operations. No node can be added while the result is borrowed.
    pub fn nodes(&self) -> Ref<'_, [Node]> {
        Ref::map(self.store.borrow(), |store| store.nodes.as_slice())
    }

    /// Borrows a table with a zero for every node. The borrower resets every entry that it writes to zero.
    pub fn borrow_zeroed_node_table(&self) -> RefMut<'_, Vec<u32>> {
        let mut table = self.table.borrow_mut();
        table.resize(self.len(), 0);
        table
    }

    /// Returns a lookup table of zeros, of any length.
    pub(super) fn take_memo_table(&self) -> Vec<u32> {
        self.tables.borrow_mut().pop().unwrap_or_default()
    }

    /// Returns a lookup table of zeros to the graph, so that it is reused without an allocation.
    pub(super) fn recycle_memo_table(&self, table: Vec<u32>) {
        self.tables.borrow_mut().push(table);
    }

    /// Returns the expression of the node with index `id`.
    pub fn expr(&self, id: Id) -> Expr<'_> {
        Expr { graph: self, id }
    }

    /// Returns a constant expression with this value.
    pub fn num(&self, value: f64) -> Expr<'_> {
        self.expr(self.intern_constant(value))
    }

    /// Returns the constant zero.
    pub fn zero(&self) -> Expr<'_> {
        self.expr(ZERO)
    }

    /// Returns the constant one.
    pub fn one(&self) -> Expr<'_> {
        self.expr(ONE)
    }

    /// Returns the expression of a symbol, which is an input of programs.
    pub fn symbol(&self, symbol: Symbol) -> Expr<'_> {
        self.expr(self.intern_node(Node::Symbol(symbol)))
    }

    /// Sets the names of the functions that are defined by tables, by table index.
    pub fn set_table_names(&self, names: Vec<String>) {
        *self.functions.borrow_mut() = names;
    }

    /// Returns the name of a table, with a suffix for every differentiation: `lift.d1.d2`.
    pub fn table_name(&self, lookup: Lookup) -> String {
        let mut name = self.functions.borrow().get(lookup.table_index()).cloned().unwrap_or_default();
        for (k, order) in lookup.derivative_orders().into_iter().enumerate() {
            name.push_str(&format!(".d{}", k + 1).repeat(order));
        }
        name
    }

    /// Returns the value or derivative of a table. Surplus variables are ignored.
    pub fn table_lookup(&self, lookup: Lookup, x: [Expr<'_>; 3]) -> Expr<'_> {
        let last = lookup.variable_count().saturating_sub(1);
        let [a, b, c] = std::array::from_fn(|k: usize| x[k.min(last)].id);
        self.expr(self.intern_node(Node::Table(lookup, a, b, c)))
    }

    pub(super) fn intern_node(&self, node: Node) -> Id {
        self.store.borrow_mut().intern_node(node)
    }

    pub(super) fn intern_constant(&self, value: f64) -> Id {
        // Minus zero becomes zero: the sign of zero has no meaning here.
        self.intern_node(Node::Const(if value == 0.0 { 0.0 } else { value }))
    }

    pub(super) fn constant_value(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Const(c) => Some(c),
            _ => None,
        }
    }

    /// Returns whether a node is a constant, or a tuple of constants, one for each SIMD lane.
    pub(super) fn is_constant(&self, id: Id) -> bool {
        matches!(self.node(id), Node::Const(_) | Node::Tuple(_))
    }

    /// Applies `f` to two constants. `None` if an operand is not constant.
    fn fold_two_constants(&self, a: Id, b: Id, f: fn(f64, f64) -> f64) -> Option<Id> {
        match (self.node(a), self.node(b)) {
            (Node::Const(x), Node::Const(y)) => Some(self.intern_constant(f(x, y))),
            (Node::Const(_) | Node::Tuple(_), Node::Const(_) | Node::Tuple(_)) => {
                self.combine_constant_lanes(a, b, f)
            }
            _ => None,
        }
    }

    /// Splits an expression into its sign (true if negative) and the expression without it, so that the sign
    /// can be lifted.
    pub(super) fn split_sign(&self, id: Id) -> (bool, Id) {
        match self.node(id) {
            Node::Neg(a) => (true, a),
            Node::Const(c) if c < 0.0 => (true, self.intern_constant(-c)),
            Node::Tuple(k) if self.is_first_nonzero_negative(k) => (true, self.neg(id)),
            _ => (false, id),
        }
    }

    pub(super) fn apply_sign(&self, negative: bool, id: Id) -> Id {
        if negative { self.neg(id) } else { id }
    }

    pub(super) fn neg(&self, a: Id) -> Id {
        match self.node(a) {
            Node::Const(c) => self.intern_constant(-c),
            Node::Tuple(_) => self.map_lanes(a, |x| -x),
            Node::Neg(a) => a,
            _ => self.intern_node(Node::Neg(a)),
        }
    }

    pub(super) fn add(&self, a: Id, b: Id) -> Id {
        if a == ZERO {
            return b;
        }
        if b == ZERO {
            return a;
        }
        if let Some(sum) = self.fold_two_constants(a, b, |x, y| x + y) {
            return sum;
        }
        if let Some(sum) = self.fold_constant_into_sum(a, b).or_else(|| self.fold_constant_into_sum(b, a)) {
            return sum;
        }
        let ((na, a), (nb, b)) = (self.split_sign(a), self.split_sign(b));
        match (na, nb) {
            (false, false) => self.sum_of_unsigned_terms(a, b),
            (true, true) => self.neg(self.sum_of_unsigned_terms(a, b)),
            (false, true) => self.subtract_nodes(a, b),
            (true, false) => self.subtract_nodes(b, a),
        }
    }

    /// Adds a constant to a sum or difference that has a constant summand. `None` for other operands.
    fn fold_constant_into_sum(&self, c: Id, b: Id) -> Option<Id> {
        if !self.is_constant(c) {
            return None;
        }
        let (negative, b) = self.split_sign(b);
        let (Node::Add(x, y) | Node::Sub(x, y)) = self.node(b) else { return None };
        let difference = matches!(self.node(b), Node::Sub(..));
        let (d, d_negative, rest, rest_negative) = match (self.is_constant(x), self.is_constant(y)) {
            (true, false) => (x, false, y, difference),
            (false, true) => (y, difference, x, false),
            _ => return None,
        };
        let sum = self.add(c, self.apply_sign(negative != d_negative, d));
        Some(self.add(sum, self.apply_sign(negative != rest_negative, rest)))
    }

    fn sum_of_unsigned_terms(&self, a: Id, b: Id) -> Id {
        if a == b {
            return self.mul(self.intern_constant(2.0), a);
        }
        // (x - b) + b = x
        if let Node::Sub(x, y) = self.node(a)
            && y == b
        {
            return x;
        }
        if let Node::Sub(x, y) = self.node(b)
            && y == a
        {
            return x;
        }
        self.intern_node(Node::Add(a.min(b), a.max(b)))
    }

    fn subtract_nodes(&self, a: Id, b: Id) -> Id {
        if a == b {
            return ZERO;
        }
        // (x + b) - b = x and (x - c) - x = -c: a summand cancels when it is subtracted again.
        match self.node(a) {
            Node::Add(x, y) if y == b => return x,
            Node::Add(x, y) if x == b => return y,
            Node::Sub(x, y) if x == b => return self.neg(y),
            _ => {}
        }
        match self.node(b) {
            Node::Add(x, y) if y == a => return self.neg(x),
            Node::Add(x, y) if x == a => return self.neg(y),
            Node::Sub(x, y) if x == a => return y,
            _ => {}
        }
        // One operand order for both signs, so that `a − b` and `b − a` share a node.
        if a < b { self.intern_node(Node::Sub(a, b)) } else { self.neg(self.intern_node(Node::Sub(b, a))) }
    }

    pub(super) fn sub(&self, a: Id, b: Id) -> Id {
        self.add(a, self.neg(b))
    }

    pub(super) fn mul(&self, a: Id, b: Id) -> Id {
        if a == ZERO || b == ZERO {
            return ZERO;
        }
        if a == ONE {
            return b;
        }
        if b == ONE {
            return a;
        }
        let ((na, a), (nb, b)) = (self.split_sign(a), self.split_sign(b));
        self.apply_sign(na != nb, self.product_without_negations(a, b))
    }

    /// Multiplies two nodes whose negations the caller has removed.
    fn product_without_negations(&self, a: Id, b: Id) -> Id {
        if let Some(product) = self.fold_two_constants(a, b, |x, y| x * y) {
            return product;
        }
        match (self.is_constant(a), self.is_constant(b)) {
            (true, _) => self.multiply_by_constant(a, b),
            (_, true) => self.multiply_by_constant(b, a),
            _ => self.product_of_nonconstants(a, b),
        }
    }

    /// Multiplies an expression that is not constant by a positive constant.
    fn multiply_by_constant(&self, c: Id, b: Id) -> Id {
        if c == ONE {
            return b;
        }
        match self.node(b) {
            Node::Mul(x, y) => {
                if let Some(product) = self.fold_two_constants(c, x, |c, d| c * d) {
                    return self.mul(product, y);
                }
            }
            Node::Div(x, y) => {
                // Another division would cost more than a product with a shared inverse.
                if x != ONE
                    && let Some(product) = self.fold_two_constants(c, x, |c, d| c * d)
                {
                    return self.intern_node(Node::Div(product, y));
                }
                if let Some(quotient) = self.fold_two_constants(c, y, |c, d| c / d) {
                    return self.mul(quotient, x);
                }
            }
            _ => {}
        }
        self.intern_node(Node::Mul(c, b))
    }

    fn product_of_nonconstants(&self, a: Id, b: Id) -> Id {
        self.intern_node(Node::Mul(a.min(b), a.max(b)))
    }

    pub(super) fn div(&self, a: Id, b: Id) -> Id {
        if a == ZERO && b != ZERO {
            return ZERO;
        }
        if b == ONE {
            return a;
        }
        if a == b && b != ZERO {
            return ONE;
        }
        if let Some(quotient) = self.fold_two_constants(a, b, |x, y| x / y) {
            return quotient;
        }
        let ((na, a), (nb, b)) = (self.split_sign(a), self.split_sign(b));
        let magnitude = match self.finite_inverse_of_constant(b) {
            // Division by a constant becomes multiplication by its inverse. This is exact for powers of two,
            // otherwise within half an ulp.
            Some(inverse) => self.mul(inverse, a),
            None => self.intern_node(Node::Div(a, b)),
        };
        self.apply_sign(na != nb, magnitude)
    }

    /// Returns the inverse of a constant if it is finite.
    fn finite_inverse_of_constant(&self, b: Id) -> Option<Id> {
        match self.node(b) {
            Node::Const(y) if y != 0.0 && (1.0 / y).is_finite() => Some(self.intern_constant(1.0 / y)),
            Node::Tuple(_) => self.map_lanes_if_finite(b, |y| 1.0 / y),
            _ => None,
        }
    }

    pub(super) fn call_function(&self, f: Function, a: Id) -> Id {
        if let Node::Tuple(_) = self.node(a)
            && let Some(result) = self.map_lanes_if_finite(a, |x| f.evaluate_at(x))
        {
            return result;
        }
        if let Some(x) = self.constant_value(a) {
            let y = f.evaluate_at(x);
            if y.is_finite() {
                return self.intern_constant(y);
            }
        }
        if f == Function::Sqrt
            && let Node::Mul(x, y) = self.node(a)
            && x == y
        {
            return self.call_function(Function::Abs, x);
        }
        if f.is_odd() || f.is_even() {
            let (negative, a) = self.split_sign(a);
            return self.apply_sign(f.is_odd() && negative, self.intern_node(Node::Call(f, a)));
        }
        self.intern_node(Node::Call(f, a))
    }
}
