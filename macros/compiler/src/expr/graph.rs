//! The graph: nodes are shared (structurally equal expressions have one id), and every constructor simplifies.
//!
//! Normal form, kept by the constructors: constants are folded; zero and one vanish; a minus sign is lifted out of
//! products, quotients, differences and odd functions, and absorbed by sums, so that `a − b` and `b − a` share one
//! node; the operands of commutative operations stand in order of their ids; constants that meet in a product or in a
//! sum are merged. Only rewrites that never cost an operation are made: `2 x` times `y` stays so, since `2 x` may be
//! used again. A constant of each lane counts as a constant.

use super::handle::Expr;
use super::lanes::Tables;
use super::node::{Function, Id, Lookup, Node, Symbol};
use std::cell::{Ref, RefCell, RefMut};
use std::fmt;

struct Store {
    nodes: Vec<Node>,
    /// Open addressing, power of two, `EMPTY` where free.
    table: Vec<Id>,
    /// How many nodes there may be.
    most: usize,
    /// There would be more.
    is_full: bool,
}

const EMPTY: Id = Id::MAX;

/// How many nodes a graph may have. Derivatives of a chain of 64 skew pins have 1.3 million; with four million the compiler takes a
/// gibibyte of memory and tens of seconds, and rustc several times that for what comes out.
const MOST_NODES: usize = 4_000_000;

impl Store {
    fn intern(&mut self, node: Node) -> Id {
        let mask = self.table.len() - 1;
        let mut slot = node.hash() as usize & mask;
        loop {
            let id = self.table[slot];
            if id == EMPTY {
                break;
            }
            if self.nodes[id as usize].same(node) {
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
            self.grow();
        }
        id
    }

    fn grow(&mut self) {
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

/// The owner of all expressions of a mechanism.
pub struct Graph {
    store: RefCell<Store>,
    /// A number for every node, zero between uses.
    table: RefCell<Vec<u32>>,
    /// Tables of zeros that are not in use, see [`Memo`](super::Memo).
    tables: RefCell<Vec<Vec<u32>>>,
    /// What the lanes of nodes hold.
    pub(super) lanes: RefCell<Tables>,
    /// Names of the functions that are given by tables.
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
    /// An empty graph.
    pub fn new() -> Graph {
        Graph::with_room_for(MOST_NODES)
    }

    /// An empty graph that can have so many nodes.
    pub fn with_room_for(most: usize) -> Graph {
        let mut store =
            Store { nodes: Vec::new(), table: vec![EMPTY; 1024], most: most.max(2), is_full: false };
        store.intern(Node::Const(0.0));
        store.intern(Node::Const(1.0));
        Graph {
            store: RefCell::new(store),
            table: RefCell::default(),
            tables: RefCell::default(),
            lanes: RefCell::default(),
            functions: RefCell::default(),
        }
    }

    /// Number of nodes made so far.
    pub fn len(&self) -> usize {
        self.store.borrow().nodes.len()
    }

    /// Expressions were made that it has no room for. They count as zero, so that no work is spent on them: whatever was derived is of
    /// no use.
    pub fn is_full(&self) -> bool {
        self.store.borrow().is_full
    }

    /// Never true: zero and one are always there.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The node with an id.
    pub fn node(&self, id: Id) -> Node {
        self.store.borrow().nodes[id as usize]
    }

    /// All nodes, operands before operations. None can be made while they are borrowed.
    pub fn nodes(&self) -> Ref<'_, [Node]> {
        Ref::map(self.store.borrow(), |store| store.nodes.as_slice())
    }

    /// A table with a zero for every node. Who borrows it sets back to zero what was written.
    pub fn borrow_table(&self) -> RefMut<'_, Vec<u32>> {
        let mut table = self.table.borrow_mut();
        table.resize(self.len(), 0);
        table
    }

    /// A table of zeros, of any length.
    pub(super) fn take_table(&self) -> Vec<u32> {
        self.tables.borrow_mut().pop().unwrap_or_default()
    }

    /// Keeps a table that has zeros alone again.
    pub(super) fn keep_table(&self, table: Vec<u32>) {
        self.tables.borrow_mut().push(table);
    }

    /// The expression with an id.
    pub fn expr(&self, id: Id) -> Expr<'_> {
        Expr { graph: self, id }
    }

    /// A constant.
    pub fn num(&self, value: f64) -> Expr<'_> {
        self.expr(self.constant(value))
    }

    /// Zero.
    pub fn zero(&self) -> Expr<'_> {
        self.expr(ZERO)
    }

    /// One.
    pub fn one(&self) -> Expr<'_> {
        self.expr(ONE)
    }

    /// An input.
    pub fn symbol(&self, symbol: Symbol) -> Expr<'_> {
        self.expr(self.intern(Node::Symbol(symbol)))
    }

    /// Names the functions that are given by tables, by number.
    pub fn name_tables(&self, names: Vec<String>) {
        *self.functions.borrow_mut() = names;
    }

    /// The name of a table, with a mark for every time that it is differentiated: `lift.d1.d2`.
    pub fn table_name(&self, lookup: Lookup) -> String {
        let mut name = self.functions.borrow().get(lookup.table()).cloned().unwrap_or_default();
        for (k, order) in lookup.orders().into_iter().enumerate() {
            name.push_str(&format!(".d{}", k + 1).repeat(order));
        }
        name
    }

    /// A table's value or derivative; variables that it does not have are left out.
    pub fn lookup(&self, lookup: Lookup, x: [Expr<'_>; 3]) -> Expr<'_> {
        let last = lookup.variables().saturating_sub(1);
        let [a, b, c] = std::array::from_fn(|k: usize| x[k.min(last)].id);
        self.expr(self.intern(Node::Table(lookup, a, b, c)))
    }

    pub(super) fn intern(&self, node: Node) -> Id {
        self.store.borrow_mut().intern(node)
    }

    pub(super) fn constant(&self, value: f64) -> Id {
        // Minus zero is zero: the sign of zero carries no meaning here.
        self.intern(Node::Const(if value == 0.0 { 0.0 } else { value }))
    }

    pub(super) fn value(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Const(c) => Some(c),
            _ => None,
        }
    }

    /// True for a constant, of all lanes or of each.
    pub(super) fn is_constant(&self, id: Id) -> bool {
        matches!(self.node(id), Node::Const(_) | Node::Tuple(_))
    }

    /// `f` of two constants; `None` if one is not.
    fn fold(&self, a: Id, b: Id, f: fn(f64, f64) -> f64) -> Option<Id> {
        match (self.node(a), self.node(b)) {
            (Node::Const(x), Node::Const(y)) => Some(self.constant(f(x, y))),
            (Node::Const(_) | Node::Tuple(_), Node::Const(_) | Node::Tuple(_)) => self.fold_lanes(a, b, f),
            _ => None,
        }
    }

    /// `±a` without its sign: the sign is kept apart so that it can be lifted.
    pub(super) fn unsigned(&self, id: Id) -> (bool, Id) {
        match self.node(id) {
            Node::Neg(a) => (true, a),
            Node::Const(c) if c < 0.0 => (true, self.constant(-c)),
            Node::Tuple(k) if self.starts_negative(k) => (true, self.neg(id)),
            _ => (false, id),
        }
    }

    pub(super) fn signed(&self, negative: bool, id: Id) -> Id {
        if negative { self.neg(id) } else { id }
    }

    pub(super) fn neg(&self, a: Id) -> Id {
        match self.node(a) {
            Node::Const(c) => self.constant(-c),
            Node::Tuple(_) => self.map_lanes(a, |x| -x),
            Node::Neg(a) => a,
            _ => self.intern(Node::Neg(a)),
        }
    }

    pub(super) fn add(&self, a: Id, b: Id) -> Id {
        if a == ZERO {
            return b;
        }
        if b == ZERO {
            return a;
        }
        if let Some(sum) = self.fold(a, b, |x, y| x + y) {
            return sum;
        }
        if let Some(sum) = self.constant_sum(a, b).or_else(|| self.constant_sum(b, a)) {
            return sum;
        }
        let ((na, a), (nb, b)) = (self.unsigned(a), self.unsigned(b));
        match (na, nb) {
            (false, false) => self.plain_sum(a, b),
            (true, true) => self.neg(self.plain_sum(a, b)),
            (false, true) => self.difference(a, b),
            (true, false) => self.difference(b, a),
        }
    }

    /// The sum of a constant and a sum or difference with another constant.
    fn constant_sum(&self, c: Id, b: Id) -> Option<Id> {
        if !self.is_constant(c) {
            return None;
        }
        let (negative, b) = self.unsigned(b);
        let (Node::Add(x, y) | Node::Sub(x, y)) = self.node(b) else { return None };
        let difference = matches!(self.node(b), Node::Sub(..));
        let (d, d_negative, rest, rest_negative) = match (self.is_constant(x), self.is_constant(y)) {
            (true, false) => (x, false, y, difference),
            (false, true) => (y, difference, x, false),
            _ => return None,
        };
        let sum = self.add(c, self.signed(negative != d_negative, d));
        Some(self.add(sum, self.signed(negative != rest_negative, rest)))
    }

    fn plain_sum(&self, a: Id, b: Id) -> Id {
        if a == b {
            return self.mul(self.constant(2.0), a);
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
        self.intern(Node::Add(a.min(b), a.max(b)))
    }

    fn difference(&self, a: Id, b: Id) -> Id {
        if a == b {
            return ZERO;
        }
        // (x + b) - b = x and (x - c) - x = -c, so that what was added can be taken away again.
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
        // One order for both signs, so that `a − b` and `b − a` share.
        if a < b { self.intern(Node::Sub(a, b)) } else { self.neg(self.intern(Node::Sub(b, a))) }
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
        let ((na, a), (nb, b)) = (self.unsigned(a), self.unsigned(b));
        self.signed(na != nb, self.plain_product(a, b))
    }

    /// The product of two operands without signs.
    fn plain_product(&self, a: Id, b: Id) -> Id {
        if let Some(product) = self.fold(a, b, |x, y| x * y) {
            return product;
        }
        match (self.is_constant(a), self.is_constant(b)) {
            (true, _) => self.scaled(a, b),
            (_, true) => self.scaled(b, a),
            _ => self.variable_product(a, b),
        }
    }

    /// A constant without sign times something that is not constant.
    fn scaled(&self, c: Id, b: Id) -> Id {
        if c == ONE {
            return b;
        }
        match self.node(b) {
            Node::Mul(x, y) => {
                if let Some(product) = self.fold(c, x, |c, d| c * d) {
                    return self.mul(product, y);
                }
            }
            Node::Div(x, y) => {
                // Another division would cost more than a product with an inverse that is shared.
                if x != ONE
                    && let Some(product) = self.fold(c, x, |c, d| c * d)
                {
                    return self.intern(Node::Div(product, y));
                }
                if let Some(quotient) = self.fold(c, y, |c, d| c / d) {
                    return self.mul(quotient, x);
                }
            }
            _ => {}
        }
        self.intern(Node::Mul(c, b))
    }

    fn variable_product(&self, a: Id, b: Id) -> Id {
        self.intern(Node::Mul(a.min(b), a.max(b)))
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
        if let Some(quotient) = self.fold(a, b, |x, y| x / y) {
            return quotient;
        }
        let ((na, a), (nb, b)) = (self.unsigned(a), self.unsigned(b));
        let magnitude = match self.inverse(b) {
            // A division by a constant is a product; exact for powers of two, else within half an ulp.
            Some(inverse) => self.mul(inverse, a),
            None => self.intern(Node::Div(a, b)),
        };
        self.signed(na != nb, magnitude)
    }

    /// The inverse of a constant, where it is finite.
    fn inverse(&self, b: Id) -> Option<Id> {
        match self.node(b) {
            Node::Const(y) if y != 0.0 && (1.0 / y).is_finite() => Some(self.constant(1.0 / y)),
            Node::Tuple(_) => self.finite_lanes(b, |y| 1.0 / y),
            _ => None,
        }
    }

    pub(super) fn call(&self, f: Function, a: Id) -> Id {
        if let Node::Tuple(_) = self.node(a)
            && let Some(result) = self.finite_lanes(a, |x| f.apply(x))
        {
            return result;
        }
        if let Some(x) = self.value(a) {
            let y = f.apply(x);
            if y.is_finite() {
                return self.constant(y);
            }
        }
        if f == Function::Sqrt
            && let Node::Mul(x, y) = self.node(a)
            && x == y
        {
            return self.call(Function::Abs, x);
        }
        if f.is_odd() || f.is_even() {
            let (negative, a) = self.unsigned(a);
            return self.signed(f.is_odd() && negative, self.intern(Node::Call(f, a)));
        }
        self.intern(Node::Call(f, a))
    }
}
