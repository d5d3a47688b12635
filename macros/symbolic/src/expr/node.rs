//! Nodes of the expression graph, and the elementary functions.

use super::air;

/// Index of a node in its graph.
pub type Id = u32;

/// An input of an expression. Its meaning is defined by the code that creates it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol(pub u32);

/// Elementary functions of one variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names of the elementary functions say it all")]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
    Signum,
    /// Temperature, K, of the standard atmosphere at a geopotential height, m.
    IsaTemperature,
    /// Temperature gradient, K/m, of the standard atmosphere at a geopotential height, m.
    IsaLapseRate,
    /// Pressure, Pa, of the standard atmosphere at a geopotential height, m.
    IsaPressure,
}

impl Function {
    /// Functions of the standard atmosphere, with their names in the runtime. The language names them
    /// differently.
    const OF_AIR: [(&'static str, Function); 3] = [
        ("isa_temperature", Function::IsaTemperature),
        ("isa_lapse_rate", Function::IsaLapseRate),
        ("isa_pressure", Function::IsaPressure),
    ];

    /// All elementary functions, with their names in the language.
    pub const ALL: [(&'static str, Function); 14] = [
        ("sin", Function::Sin),
        ("cos", Function::Cos),
        ("tan", Function::Tan),
        ("asin", Function::Asin),
        ("acos", Function::Acos),
        ("atan", Function::Atan),
        ("sinh", Function::Sinh),
        ("cosh", Function::Cosh),
        ("tanh", Function::Tanh),
        ("exp", Function::Exp),
        ("ln", Function::Ln),
        ("sqrt", Function::Sqrt),
        ("abs", Function::Abs),
        ("signum", Function::Signum),
    ];

    /// Returns the name in the language and in generated code.
    pub fn function_name(self) -> &'static str {
        let mut all = Function::ALL.iter().chain(&Function::OF_AIR);
        all.find(|(_, f)| *f == self).map_or("?", |(name, _)| name)
    }

    /// Evaluates the elementary function at a number.
    pub fn evaluate_at(self, x: f64) -> f64 {
        match self {
            Function::Sin => libm::sin(x),
            Function::Cos => libm::cos(x),
            Function::Tan => libm::tan(x),
            Function::Asin => libm::asin(x),
            Function::Acos => libm::acos(x),
            Function::Atan => libm::atan(x),
            Function::Sinh => libm::sinh(x),
            Function::Cosh => libm::cosh(x),
            Function::Tanh => libm::tanh(x),
            Function::Exp => libm::exp(x),
            Function::Ln => libm::log(x),
            Function::Sqrt => x.sqrt(),
            Function::Abs => x.abs(),
            Function::Signum => x.signum(),
            Function::IsaTemperature => air::temperature(x),
            Function::IsaLapseRate => air::temperature_gradient(x),
            Function::IsaPressure => air::pressure(x),
        }
    }

    /// Returns whether the function is odd: `f(-x) = -f(x)`.
    pub fn is_odd(self) -> bool {
        use Function::{Asin, Atan, Sin, Sinh, Tan, Tanh};
        matches!(self, Sin | Tan | Asin | Atan | Sinh | Tanh)
    }

    /// Returns whether the function is even: `f(-x) = f(x)`.
    pub fn is_even(self) -> bool {
        matches!(self, Function::Cos | Function::Cosh | Function::Abs)
    }
}

/// Function defined by a table, or one of its derivatives. The index of the table, the number of variables,
/// and the order of differentiation by each variable are packed in 16 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Lookup(u16);

impl Lookup {
    /// Maximum number of tables of a mechanism.
    pub const MAX_TABLES: usize = 256;

    /// Returns the lookup of table number `table`, with one to three variables.
    pub fn new(table: usize, variables: usize) -> Lookup {
        Lookup((table as u16) << 8 | (variables as u16 & 3) << 6)
    }

    /// Returns the index of the interpolation table that is looked up.
    pub fn table_index(self) -> usize {
        usize::from(self.0 >> 8)
    }

    /// Returns the number of variables of the interpolation table.
    pub fn variable_count(self) -> usize {
        usize::from(self.0 >> 6 & 3)
    }

    /// Returns the order of differentiation of the table by a variable.
    pub fn derivative_order(self, variable: usize) -> usize {
        usize::from(self.0 >> (2 * variable) & 3)
    }

    /// Returns the orders of differentiation of the table by all variables.
    pub fn derivative_orders(self) -> Vec<usize> {
        (0..self.variable_count()).map(|k| self.derivative_order(k)).collect()
    }

    /// Returns the derivative by a variable. `None` if it is zero, since tables are at most cubic in
    /// each variable.
    pub fn partial_derivative(self, variable: usize) -> Option<Lookup> {
        (self.derivative_order(variable) < 3).then(|| Lookup(self.0 + (1 << (2 * variable))))
    }

    /// Evaluates a surrogate function, for use where the values of the table are unknown. It is a product of
    /// cubic polynomials, like tables: truncated Taylor series of sines that differ between tables. All
    /// derivatives are consistent.
    pub fn evaluate_surrogate(self, x: [f64; 3]) -> f64 {
        let surrogate_cubic = |(k, x): (usize, f64)| {
            let (order, pace, phase) =
                (self.derivative_order(k), 0.7 + 0.2 * k as f64, 0.4 + 0.3 * self.table_index() as f64);
            let sine_derivative = |n: usize| {
                libm::pow(pace, n as f64) * libm::sin(phase + std::f64::consts::FRAC_PI_2 * n as f64)
            };
            (order..=3).rev().fold(0.0, |sum, n| sine_derivative(n) + sum * x / (n + 1 - order) as f64)
        };
        x.into_iter().take(self.variable_count()).enumerate().map(surrogate_cubic).product()
    }
}

/// Choice between minimum and maximum of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names say it all")]
pub enum Extreme {
    Min,
    Max,
}

impl Extreme {
    /// Returns the name in the language and in generated code.
    pub fn function_name(self) -> &'static str {
        match self {
            Extreme::Min => "min",
            Extreme::Max => "max",
        }
    }

    /// Evaluates the minimum or maximum of two numbers.
    pub fn evaluate_extreme(self, a: f64, b: f64) -> f64 {
        match self {
            Extreme::Min => a.min(b),
            Extreme::Max => a.max(b),
        }
    }
}

/// Node of the expression graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// Constant with the same value in all SIMD lanes.
    Const(f64),
    /// Input symbol with the same value in all SIMD lanes.
    Symbol(Symbol),
    /// Negation `-a` of a node.
    Neg(Id),
    /// Sum `a + b` of two nodes.
    Add(Id, Id),
    /// Difference `a - b` of two nodes.
    Sub(Id, Id),
    /// Product `a * b` of two nodes.
    Mul(Id, Id),
    /// Quotient `a / b` of two nodes.
    Div(Id, Id),
    /// Elementary function `f(a)` of a node.
    Call(Function, Id),
    /// `atan2(a, b)`: the angle, rad, of the point with ordinate `a` and abscissa `b`.
    Atan2(Id, Id),
    /// Power `a^b` of two nodes.
    Pow(Id, Id),
    /// Minimum or maximum of the nodes `a` and `b`.
    Extreme(Extreme, Id, Id),
    /// Value or derivative of a table at its variables. Surplus operands repeat the last variable.
    Table(Lookup, Id, Id, Id),
    /// Constants, one for each SIMD lane: an index of the graph's tuples.
    Tuple(u32),
    /// Input symbols, one for each SIMD lane: an index of the graph's gathers.
    Gather(u32),
    /// Sum of the first `n` lanes of `a`: `n` and `a`.
    Sum(u8, Id),
    /// Value of one lane of `a`: index of the lane, and `a`.
    Lane(u8, Id),
    /// First `n` lanes of `a`, followed by the first `n` lanes of `b`: `n`, `a` and `b`.
    Join(u8, Id, Id),
}

impl Node {
    /// Calls `f` with the index of every operand of the node.
    pub fn visit_operands(self, mut f: impl FnMut(Id)) {
        match self {
            Node::Const(_) | Node::Symbol(_) | Node::Tuple(_) | Node::Gather(_) => {}
            Node::Neg(a) | Node::Call(_, a) | Node::Sum(_, a) | Node::Lane(_, a) => f(a),
            Node::Add(a, b)
            | Node::Sub(a, b)
            | Node::Mul(a, b)
            | Node::Div(a, b)
            | Node::Atan2(a, b)
            | Node::Pow(a, b)
            | Node::Extreme(_, a, b)
            | Node::Join(_, a, b) => {
                f(a);
                f(b);
            }
            Node::Table(lookup, a, b, c) => [a, b, c].into_iter().take(lookup.variable_count()).for_each(f),
        }
    }

    pub(super) fn hash(self) -> u64 {
        let (tag, a, b): (u64, u64, u64) = match self {
            Node::Const(c) => (1, c.to_bits(), 0),
            Node::Symbol(s) => (2, s.0.into(), 0),
            Node::Neg(a) => (3, a.into(), 0),
            Node::Add(a, b) => (4, a.into(), b.into()),
            Node::Sub(a, b) => (5, a.into(), b.into()),
            Node::Mul(a, b) => (6, a.into(), b.into()),
            Node::Div(a, b) => (7, a.into(), b.into()),
            Node::Atan2(a, b) => (8, a.into(), b.into()),
            Node::Pow(a, b) => (9, a.into(), b.into()),
            Node::Extreme(f, a, b) => (30 + f as u64, a.into(), b.into()),
            Node::Tuple(k) => (32, k.into(), 0),
            Node::Gather(k) => (33, k.into(), 0),
            Node::Sum(n, a) => (34, a.into(), n.into()),
            Node::Lane(k, a) => (35, a.into(), k.into()),
            Node::Table(lookup, a, b, c) => {
                (50 + u64::from(lookup.0) * 512, u64::from(a) | u64::from(c) << 32, b.into())
            }
            Node::Join(n, a, b) => (36 + u64::from(n), a.into(), b.into()),
            Node::Call(f, a) => (10 + f as u64, a.into(), 0),
        };
        let mut h = (a ^ tag.wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
        h = (h ^ (h >> 32) ^ b.wrapping_mul(0xC4CE_B9FE_1A85_EC53)).wrapping_mul(0x9FB2_1C65_1E98_DF25);
        h ^ (h >> 29)
    }

    pub(super) fn is_bitwise_equal_node(self, other: Node) -> bool {
        match (self, other) {
            // Compares bits, so that a NaN equals itself. Negative zero does not occur, see
            // `Graph::constant`.
            (Node::Const(a), Node::Const(b)) => a.to_bits() == b.to_bits(),
            (a, b) => a == b,
        }
    }
}
