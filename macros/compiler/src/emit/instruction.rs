//! Conversion of instructions and their operands to Rust expressions.

use super::pieces::{ExpressionPiece, PrecedenceLevel, Statement};
use super::scalar::ScalarSpelling;
use crate::catalogue::Argument;
use crate::expr::{Lookup, Symbol};
use crate::lower::{Op, Operand, Program};
use crate::mechanism::Quantity;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Kind of build (optimised or debug) for which a function body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuildKind {
    /// Body for optimised builds, and for all builds of a function without a separate debug body.
    Optimised,
    /// Builds with debug assertions. Without optimisation a call takes longer than the operation that it
    /// computes, and every passed value takes stack of its own. The body therefore uses only scalars, and
    /// operators instead of calls.
    Debug,
}

/// State of the writer of one function body.
pub struct BodyWriter<'a> {
    /// Build (debug, release or both) for which the body is written.
    pub build: BuildKind,
    /// Program whose instructions are written.
    pub program: &'a Program,
    /// Number of SIMD lanes of each value; one for a scalar.
    pub lanes: Vec<usize>,
    /// Spelling of scalar types and operations.
    pub scalar: &'a ScalarSpelling,
    /// Arguments of the function, and results of the functions that it calls.
    pub arguments: Vec<Argument>,
    /// Statements that have been written so far.
    pub statements: Vec<Statement>,
    /// Text of each value that is not bound to a name.
    pub pieces: Vec<Option<ExpressionPiece>>,
    /// Number of statements up to and including sines and cosines.
    pub head: usize,
    /// Arguments on which the angles of the sines and cosines depend.
    pub early: Vec<Argument>,
    /// Operations of `Ops`, with their numbers of lanes, that are bound to names before all statements;
    /// `None` if operations are called directly.
    pub named: Option<BTreeSet<(&'static str, usize)>>,
}

impl BodyWriter<'_> {
    /// Returns the expression of a SIMD vector that is gathered from inputs.
    pub fn gathered_vector(&self, gather: &[Symbol]) -> String {
        let symbols: Vec<String> = gather.iter().map(|s| self.input_symbol_text(*s)).collect();
        format!("Ops::lanes([{}])", symbols.join(", "))
    }

    /// Returns the number of SIMD lanes of an operand.
    pub fn lane_count(&self, o: Operand) -> usize {
        match o {
            Operand::Const(_) | Operand::Symbol(_) => 1,
            Operand::Value(k) => self.lanes[k],
            Operand::Tuple(k) => self.program.tuples[k].len(),
            Operand::Gather(k) => self.program.gathers[k].len(),
        }
    }

    /// Returns an operand of an operation on `lanes` lanes; a scalar is broadcast to all lanes.
    fn broadcast_operand(&mut self, o: Operand, lanes: usize) -> ExpressionPiece {
        let own = self.lane_count(o);
        let piece = self.operand_text(o);
        if own == lanes {
            return piece;
        }
        let text = match self.bind_operation_name("splat", lanes) {
            Some(splat) => format!("{splat}({})", piece.text),
            None => format!("Ops::splat::<_, {lanes}>({})", piece.text),
        };
        ExpressionPiece { text, needs: piece.needs, level: PrecedenceLevel::Whole }
    }

    /// Returns the text of an operand. The text of an unbound value is taken out of `pieces`.
    pub fn operand_text(&mut self, o: Operand) -> ExpressionPiece {
        let piece_without_dependencies =
            |text| ExpressionPiece { text, needs: Vec::new(), level: PrecedenceLevel::Whole };
        match o {
            Operand::Const(c) => piece_without_dependencies(self.constant_text(c)),
            Operand::Symbol(s) => piece_without_dependencies(self.input_symbol_text(s)),
            Operand::Tuple(k) => {
                let tuple: Vec<String> =
                    self.program.tuples[k].iter().map(|c| self.scalar.constant_expression(*c)).collect();
                piece_without_dependencies(format!("Ops::lanes([{}])", tuple.join(", ")))
            }
            Operand::Gather(k) => {
                let gather = &self.program.gathers[k];
                let contains_gathered_symbol = |a: &Argument| {
                    gather.iter().any(|s| a.index_of_quantity(Quantity::from_symbol(*s)).is_some())
                };
                // Gathers of arguments are bound to names; gathers of parameters are not.
                piece_without_dependencies(match self.arguments.iter().any(contains_gathered_symbol) {
                    true => format!("lanes{k}"),
                    false => self.gathered_vector(gather),
                })
            }
            Operand::Value(k) => self.pieces[k].take().unwrap_or_else(|| ExpressionPiece {
                text: format!("t{k}"),
                needs: vec![k],
                level: PrecedenceLevel::Whole,
            }),
        }
    }

    /// Returns the text of an output. For several states, a vector register is converted to lanes.
    pub fn output_text(&mut self, o: Operand) -> ExpressionPiece {
        let piece = self.operand_text(o);
        match self.scalar.uses_batch_lanes() {
            true => ExpressionPiece {
                text: format!("{}.lanes()", parenthesised_below_level(&piece, PrecedenceLevel::Whole)),
                level: PrecedenceLevel::Whole,
                ..piece
            },
            false => piece,
        }
    }

    /// Returns the text of a constant, in parentheses if it is negative.
    pub fn constant_text(&mut self, c: f64) -> String {
        let text = self.scalar.constant_expression(c);
        if c < 0.0 { format!("({text})") } else { text }
    }

    /// Returns the text of an input: a parameter, a prepared value or an entry of an argument.
    pub fn input_symbol_text(&self, s: Symbol) -> String {
        let quantity = Quantity::from_symbol(s);
        if quantity == Quantity::Time {
            return if self.scalar.uses_batch_lanes() { "time" } else { "t" }.to_string();
        }
        match quantity {
            Quantity::Parameter(k) => return self.scalar.parameter_value_expression(k),
            Quantity::Prepared(k) => return self.scalar.broadcast_number(format!("self.numbers[{k}]")),
            _ => {}
        }
        self.arguments
            .iter()
            .find_map(|a| a.index_of_quantity(quantity).map(|k| format!("{}{k}", a.argument_name())))
            .unwrap_or_else(|| "missing".to_string())
    }

    /// Returns the text of an instruction whose result has `lanes` lanes.
    pub fn instruction_text(&mut self, op: Op, lanes: usize) -> ExpressionPiece {
        match op {
            Op::Neg(a) => {
                let a = self.operand_text(a);
                let text = format!("-{}", parenthesised_below_level(&a, PrecedenceLevel::Whole));
                ExpressionPiece { text, needs: a.needs, level: PrecedenceLevel::Product }
            }
            Op::Add(a, b) => {
                self.infix_operation([a, b], "+", lanes, [PrecedenceLevel::Sum, PrecedenceLevel::Product])
            }
            Op::Sub(a, b) => {
                self.infix_operation([a, b], "-", lanes, [PrecedenceLevel::Sum, PrecedenceLevel::Product])
            }
            Op::Mul(a, b) => {
                self.infix_operation([a, b], "*", lanes, [PrecedenceLevel::Product, PrecedenceLevel::Whole])
            }
            Op::Div(a, b) => {
                self.infix_operation([a, b], "/", lanes, [PrecedenceLevel::Product, PrecedenceLevel::Whole])
            }
            Op::MulAdd(a, b, c) if self.build == BuildKind::Debug => {
                self.product_plus_or_minus([a, b], "+", c)
            }
            Op::MulSub(a, b, c) if self.build == BuildKind::Debug => {
                self.product_plus_or_minus([a, b], "-", c)
            }
            Op::NegMulAdd(a, b, c) if self.build == BuildKind::Debug => {
                self.difference_with_product(c, [a, b])
            }
            Op::MulAdd(a, b, c) => self.fused_operation(["mul_add", "scale_add"], [a, b, c], lanes),
            Op::MulSub(a, b, c) => self.fused_operation(["mul_sub", "scale_sub"], [a, b, c], lanes),
            Op::NegMulAdd(a, b, c) => {
                self.fused_operation(["neg_mul_add", "neg_scale_add"], [a, b, c], lanes)
            }
            Op::Call(f, a) => self.call_text(f.function_name(), &[a], lanes),
            Op::Atan2(a, b) => self.call_text("atan2", &[a, b], lanes),
            Op::Pow(a, b) => self.call_text("powf", &[a, b], lanes),
            Op::Extreme(f, a, b) => self.call_text(f.function_name(), &[a, b], lanes),
            Op::Table(lookup, a, b, c) => self.table_lookup_text(lookup, [a, b, c], lanes),
            Op::Sum(n, a) if n == self.lane_count(a) => self.suffix_operation(a, ".sum()"),
            Op::Sum(n, a) => self.suffix_operation(a, &format!(".first::<{n}>().sum()")),
            Op::Lane(k, a) => self.suffix_operation(a, &format!(".lane::<{k}>()")),
            Op::Join(n, a, b) => {
                let (a, b) = (self.broadcast_operand(a, n), self.broadcast_operand(b, n));
                let text = match n {
                    1 => format!("Ops::lanes([{}, {}])", a.text, b.text),
                    _ => format!("Ops::join::<_, {n}, {}>({}, {})", 2 * n, a.text, b.text),
                };
                ExpressionPiece { text, needs: [a.needs, b.needs].concat(), level: PrecedenceLevel::Whole }
            }
        }
    }

    fn suffix_operation(&mut self, a: Operand, suffix: &str) -> ExpressionPiece {
        let a = self.operand_text(a);
        ExpressionPiece {
            text: format!("{}{suffix}", parenthesised_below_level(&a, PrecedenceLevel::Whole)),
            needs: a.needs,
            level: PrecedenceLevel::Whole,
        }
    }

    fn infix_operation(
        &mut self,
        [a, b]: [Operand; 2],
        op: &str,
        lanes: usize,
        [level, right]: [PrecedenceLevel; 2],
    ) -> ExpressionPiece {
        if op == "*"
            && let Some(scaled) = self.scalar_and_vector_factors([a, b], lanes)
        {
            let name = self.bind_operation_name("scale", lanes).unwrap_or_else(|| "Ops::scale".to_string());
            return self.call_with_piece_arguments(&name, scaled);
        }
        let (a, b) = (self.broadcast_operand(a, lanes), self.broadcast_operand(b, lanes));
        let text =
            format!("{} {op} {}", parenthesised_below_level(&a, level), parenthesised_below_level(&b, right));
        let mut needs = a.needs;
        needs.extend(b.needs);
        ExpressionPiece { text, needs, level }
    }

    /// Returns `a * b + c` or `a * b - c`.
    fn product_plus_or_minus(&mut self, product: [Operand; 2], op: &str, c: Operand) -> ExpressionPiece {
        let product =
            self.infix_operation(product, "*", 1, [PrecedenceLevel::Product, PrecedenceLevel::Whole]);
        let c = self.operand_text(c);
        let text =
            format!("{} {op} {}", product.text, parenthesised_below_level(&c, PrecedenceLevel::Product));
        ExpressionPiece { text, needs: [product.needs, c.needs].concat(), level: PrecedenceLevel::Sum }
    }

    /// Returns the expression `c - a * b`.
    fn difference_with_product(&mut self, c: Operand, product: [Operand; 2]) -> ExpressionPiece {
        let c = self.operand_text(c);
        let product =
            self.infix_operation(product, "*", 1, [PrecedenceLevel::Product, PrecedenceLevel::Whole]);
        let text = format!("{} - {}", parenthesised_below_level(&c, PrecedenceLevel::Sum), product.text);
        ExpressionPiece { text, needs: [c.needs, product.needs].concat(), level: PrecedenceLevel::Sum }
    }

    /// Returns a fused operation. The product of a scalar and a vector has an operation of its own, which
    /// saves rustc the check of a broadcast.
    fn fused_operation(
        &mut self,
        [function, scaled]: [&'static str; 2],
        [a, b, c]: [Operand; 3],
        lanes: usize,
    ) -> ExpressionPiece {
        let Some(factors) = self.scalar_and_vector_factors([a, b], lanes) else {
            let name =
                self.bind_operation_name(function, lanes).unwrap_or_else(|| format!("Ops::{function}"));
            return self.call_with_broadcast_arguments(&name, &[a, b, c], lanes);
        };
        let name = self.bind_operation_name(scaled, lanes).unwrap_or_else(|| format!("Ops::{scaled}"));
        let c = self.broadcast_operand(c, lanes);
        self.call_with_piece_arguments(&name, factors.into_iter().chain([c]).collect())
    }

    /// Returns the factors of a product of a scalar and a vector, the scalar first; `None` for other
    /// products.
    fn scalar_and_vector_factors(
        &mut self,
        [a, b]: [Operand; 2],
        lanes: usize,
    ) -> Option<Vec<ExpressionPiece>> {
        let [x, v] = match (self.lane_count(a), self.lane_count(b)) {
            _ if lanes == 1 => return None,
            (1, own) if own == lanes => [a, b],
            (own, 1) if own == lanes => [b, a],
            _ => return None,
        };
        Some(vec![self.operand_text(x), self.operand_text(v)])
    }

    /// Returns the name to which an operation on `lanes` lanes is bound; `None` if operations are called
    /// directly.
    fn bind_operation_name(&mut self, function: &'static str, lanes: usize) -> Option<String> {
        self.named.as_mut()?.insert((function, lanes));
        Some(if lanes == 1 { function.to_string() } else { format!("{function}{lanes}") })
    }

    /// Writes the bindings of named operations. With them rustc resolves the generic arguments and checks the
    /// bounds of an operation once instead of at every call.
    pub fn write_named_operations(&self, out: &mut String) {
        let one = self.scalar.single_lane_scalar_type();
        for (function, lanes) in self.named.iter().flatten() {
            let (name, width) = match (lanes, self.scalar.uses_batch_lanes()) {
                (1, false) => (function.to_string(), None),
                (1, true) => (function.to_string(), Some("LANES".to_string())),
                _ => (format!("{function}{lanes}"), Some(lanes.to_string())),
            };
            let types = match width {
                Some(width) if *function == "splat" || function.contains("scale") => {
                    format!("{one}, {width}")
                }
                Some(width) => format!("::linkwork::__private::Vector<Ops, {one}, {width}>"),
                None => one.to_string(),
            };
            let _ = writeln!(out, "let {name} = Ops::{function}::<{types}>;");
        }
    }

    fn call_text(&mut self, function: &str, arguments: &[Operand], lanes: usize) -> ExpressionPiece {
        self.call_with_broadcast_arguments(&format!("Ops::{function}"), arguments, lanes)
    }

    /// Returns the expression of a table's value, or of one of its derivatives.
    fn table_lookup_text(&mut self, lookup: Lookup, x: [Operand; 3], lanes: usize) -> ExpressionPiece {
        let (field, orders) =
            (self.scalar.table_field_name(lookup.table_index()).to_string(), lookup.derivative_orders());
        let list = self.call_with_broadcast_arguments(
            "",
            x.get(..lookup.variable_count()).unwrap_or_default(),
            lanes,
        );
        let inner = list.text.strip_prefix('(').and_then(|text| text.strip_suffix(')')).unwrap_or_default();
        ExpressionPiece { text: format!("Ops::tabulated(&self.{field}, [{inner}], {orders:?})"), ..list }
    }

    fn call_with_broadcast_arguments(
        &mut self,
        function: &str,
        arguments: &[Operand],
        lanes: usize,
    ) -> ExpressionPiece {
        let list = arguments.iter().map(|a| self.broadcast_operand(*a, lanes)).collect();
        self.call_with_piece_arguments(function, list)
    }

    fn call_with_piece_arguments(
        &mut self,
        function: &str,
        arguments: Vec<ExpressionPiece>,
    ) -> ExpressionPiece {
        let (mut needs, mut list) = (Vec::new(), Vec::new());
        for piece in arguments {
            needs.extend(piece.needs);
            list.push(piece.text);
        }
        ExpressionPiece {
            text: format!("{function}({})", list.join(", ")),
            needs,
            level: PrecedenceLevel::Whole,
        }
    }
}

fn parenthesised_below_level(piece: &ExpressionPiece, level: PrecedenceLevel) -> String {
    if piece.level < level { format!("({})", piece.text) } else { piece.text.clone() }
}
