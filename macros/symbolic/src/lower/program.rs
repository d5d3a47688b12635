//! Straight-line programs: instructions, their operands, and operation counts.

use crate::expr::eval::join_lanes;
use crate::expr::lanes::MAX_LANES;
use crate::expr::{Extreme, Function, Lookup, Symbol};
use std::collections::BTreeSet;

/// Operand of an instruction of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operand {
    /// Constant operand.
    Const(f64),
    /// Operand that is an input of the program.
    Symbol(Symbol),
    /// Operand that is the result of the instruction with this index.
    Value(usize),
    /// Constants, one for each SIMD lane: an index of the program's tuples.
    Tuple(usize),
    /// Inputs, one for each SIMD lane: an index of the program's gathers.
    Gather(usize),
}

impl Operand {
    /// Returns the index of the instruction that computes the operand, or zero.
    pub fn instruction_index(self) -> usize {
        match self {
            Operand::Value(k) => k,
            _ => 0,
        }
    }

    /// Replaces a value by the operand that computes it in another program.
    pub fn operand_in_other_program(self, values: &[Operand]) -> Operand {
        match self {
            Operand::Value(k) => values[k],
            other => other,
        }
    }
}

/// Operation of an instruction of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// Negation `-a` of an operand.
    Neg(Operand),
    /// Sum `a + b` of two operands.
    Add(Operand, Operand),
    /// Difference `a - b` of two operands.
    Sub(Operand, Operand),
    /// Product `a * b` of two operands.
    Mul(Operand, Operand),
    /// Quotient `a / b` of two operands.
    Div(Operand, Operand),
    /// Fused product and sum `a * b + c`.
    MulAdd(Operand, Operand, Operand),
    /// Fused product and difference `a * b - c`.
    MulSub(Operand, Operand, Operand),
    /// Fused product and difference `c - a * b`.
    NegMulAdd(Operand, Operand, Operand),
    /// Elementary function `f(a)` of an operand.
    Call(Function, Operand),
    /// Angle `atan2(a, b)` of the point with ordinate `a` and abscissa `b`.
    Atan2(Operand, Operand),
    /// Power `a^b` of two operands.
    Pow(Operand, Operand),
    /// Minimum or maximum of the operands `a` and `b`.
    Extreme(Extreme, Operand, Operand),
    /// A table's value or derivative; variables that it does not have repeat the last.
    Table(Lookup, Operand, Operand, Operand),
    /// Sum of the first `n` SIMD lanes of `a`.
    Sum(usize, Operand),
    /// Value of one SIMD lane of `a`.
    Lane(usize, Operand),
    /// Vector of the first `n` lanes of one value, followed by the first `n` lanes of another.
    Join(usize, Operand, Operand),
}

impl Op {
    /// Calls `f` with every operand of the operation.
    pub fn visit_operands(&self, mut f: impl FnMut(Operand)) {
        match *self {
            Op::Neg(a) | Op::Call(_, a) | Op::Sum(_, a) | Op::Lane(_, a) => f(a),
            Op::Add(a, b)
            | Op::Sub(a, b)
            | Op::Mul(a, b)
            | Op::Div(a, b)
            | Op::Atan2(a, b)
            | Op::Pow(a, b)
            | Op::Extreme(_, a, b)
            | Op::Join(_, a, b) => {
                f(a);
                f(b);
            }
            Op::Table(lookup, a, b, c) => [a, b, c].into_iter().take(lookup.variable_count()).for_each(f),
            Op::MulAdd(a, b, c) | Op::MulSub(a, b, c) | Op::NegMulAdd(a, b, c) => {
                f(a);
                f(b);
                f(c);
            }
        }
    }
}

/// Program without branches and loops: a list of instructions with its outputs.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// Instructions of the program; instruction `k` computes value `k`.
    pub instructions: Vec<Op>,
    /// Number of uses of each value as an operand or an output.
    pub uses: Vec<u32>,
    /// Operands that are the results of the program.
    pub outputs: Vec<Operand>,
    /// Operation counts before fusing; an operation on all lanes of a value counts once.
    pub counts: OperationCounts,
    /// Constants of SIMD lanes, for each operand with one constant per lane.
    pub tuples: Vec<Vec<f64>>,
    /// Symbols of SIMD lanes, for each operand with one input per lane.
    pub gathers: Vec<Vec<Symbol>>,
    /// Variant of the program with identical limbs as SIMD lanes, if it is cheaper.
    pub simd: Option<Box<Program>>,
}

/// Numbers of operations of a program: one for every arithmetic instruction; a negation counts as an
/// addition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OperationCounts {
    /// Number of multiplications of the program.
    pub mul: usize,
    /// Number of additions, subtractions and negations of the program.
    pub add: usize,
    /// Number of divisions of the program.
    pub div: usize,
    /// Number of elementary functions; a sine and a cosine of one angle are two.
    pub calls: usize,
}

impl OperationCounts {
    /// Returns the number of multiplications, additions and divisions together.
    pub fn total_operations(&self) -> usize {
        self.mul + self.add + self.div
    }
}

impl Program {
    /// Returns the program that computes only the chosen outputs.
    pub fn with_selected_outputs(mut self, chosen: &[usize]) -> Program {
        self.outputs = chosen.iter().filter_map(|k| self.outputs.get(*k).copied()).collect();
        self.remove_unused_instructions();
        self.counts = self.count_operations();
        self.simd = self.simd.map(|program| Box::new(program.with_selected_outputs(chosen)));
        self
    }

    /// Permutes the instructions; in `order`, operands must precede operations.
    pub fn reorder_instructions(mut self, order: &[usize]) -> Program {
        let mut number = vec![0; self.instructions.len()];
        for (place, k) in order.iter().enumerate() {
            number[*k] = place;
        }
        self.instructions = order.iter().map(|k| self.instructions[*k].renumber_operands(&number)).collect();
        self.uses = order.iter().map(|k| self.uses[*k]).collect();
        self.outputs.iter_mut().for_each(|o| *o = renumber_operand(*o, &number));
        self
    }

    /// Removes unused instructions, renumbers the others and counts uses.
    pub fn remove_unused_instructions(&mut self) {
        let n = self.instructions.len();
        self.uses.clear();
        self.uses.resize(n, 0);
        for output in &self.outputs {
            if let Operand::Value(k) = output {
                self.uses[*k] += 1;
            }
        }
        let mut dead = 0;
        for k in (0..n).rev() {
            if self.uses[k] == 0 {
                dead += 1;
                continue;
            }
            self.instructions[k].visit_operands(|o| {
                if let Operand::Value(a) = o {
                    self.uses[a] += 1;
                }
            });
        }
        if dead == 0 {
            return;
        }
        let mut number = vec![0; n];
        let mut next = 0;
        for k in 0..n {
            if self.uses[k] > 0 {
                number[k] = next;
                self.instructions[next] = self.instructions[k].renumber_operands(&number);
                self.uses[next] = self.uses[k];
                next += 1;
            }
        }
        self.instructions.truncate(next);
        self.uses.truncate(next);
        for output in &mut self.outputs {
            *output = renumber_operand(*output, &number);
        }
    }

    /// Counts the operations of the program.
    pub fn count_operations(&self) -> OperationCounts {
        let mut counts = OperationCounts::default();
        for op in &self.instructions {
            match op {
                Op::Neg(_) | Op::Add(..) | Op::Sub(..) | Op::Sum(..) | Op::Extreme(..) => counts.add += 1,
                Op::Mul(..) => counts.mul += 1,
                Op::Div(..) => counts.div += 1,
                Op::MulAdd(..) | Op::MulSub(..) | Op::NegMulAdd(..) => {
                    counts.mul += 1;
                    counts.add += 1;
                }
                Op::Call(..) | Op::Atan2(..) | Op::Pow(..) | Op::Table(..) => counts.calls += 1,
                Op::Lane(..) | Op::Join(..) => {}
            }
        }
        counts
    }

    /// Returns the symbols of the inputs that the program uses.
    pub fn used_symbols(&self) -> BTreeSet<Symbol> {
        let mut symbols: BTreeSet<Symbol> = self.gathers.iter().flatten().copied().collect();
        let mut record_symbol = |o: Operand| match o {
            Operand::Symbol(s) => drop(symbols.insert(s)),
            Operand::Const(_) | Operand::Value(_) | Operand::Tuple(_) | Operand::Gather(_) => {}
        };
        for op in &self.instructions {
            op.visit_operands(&mut record_symbol);
        }
        self.outputs.iter().for_each(|o| record_symbol(*o));
        symbols
    }

    /// Returns whether every constant of the program is finite.
    pub fn has_only_finite_constants(&self) -> bool {
        let mut finite = true;
        let mut check_constant_is_finite =
            |o: Operand| finite &= !matches!(o, Operand::Const(c) if !c.is_finite());
        for op in &self.instructions {
            op.visit_operands(&mut check_constant_is_finite);
        }
        self.outputs.iter().for_each(|o| check_constant_is_finite(*o));
        finite && self.tuples.iter().flatten().all(|c| c.is_finite())
    }

    /// Returns the text of an operation on constants whose result is not finite, if there is one. Operations
    /// on constants with a finite result may remain where a pass has changed a sign.
    pub fn nonfinite_constant_operation_text(&self) -> Option<String> {
        let constant_value = |o: Operand| match o {
            Operand::Const(c) => Some(c),
            _ => None,
        };
        self.instructions.iter().find_map(|op| {
            let (value, text) = match *op {
                Op::Call(f, a) => {
                    let a = constant_value(a)?;
                    (f.evaluate_at(a), format!("{}({a})", f.function_name()))
                }
                Op::Pow(a, b) => {
                    let (a, b) = (constant_value(a)?, constant_value(b)?);
                    (libm::pow(a, b), format!("pow({a}, {b})"))
                }
                Op::Div(a, b) => {
                    let (a, b) = (constant_value(a)?, constant_value(b)?);
                    (a / b, format!("{a} / {b}"))
                }
                _ => return None,
            };
            (!value.is_finite()).then_some(text)
        })
    }

    /// Interprets the program; returns the values of the outputs.
    pub fn interpret_program(&self, symbol: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
        self.interpret_with_tables(symbol, &Lookup::evaluate_surrogate)
    }

    /// Interprets the program with a function that evaluates table lookups from their variables.
    pub fn interpret_with_tables(
        &self,
        symbol: &dyn Fn(Symbol) -> f64,
        table: &dyn Fn(Lookup, [f64; 3]) -> f64,
    ) -> Vec<f64> {
        let joins = self.instructions.iter().any(|op| matches!(op, Op::Join(..)));
        match joins || !self.tuples.is_empty() || !self.gathers.is_empty() {
            true => self.interpret_in_lanes::<MAX_LANES>(symbol, table),
            false => self.interpret_in_lanes::<1>(symbol, table),
        }
    }

    fn interpret_in_lanes<const N: usize>(
        &self,
        symbol: &dyn Fn(Symbol) -> f64,
        table: &dyn Fn(Lookup, [f64; 3]) -> f64,
    ) -> Vec<f64> {
        let lanes_from_list =
            |list: Vec<f64>| std::array::from_fn(|k| list.get(k).copied().unwrap_or(f64::NAN));
        let mut values: Vec<[f64; N]> = Vec::with_capacity(self.instructions.len());
        let lane_values_of_operand = |values: &[[f64; N]], o: Operand| match o {
            Operand::Const(c) => [c; N],
            Operand::Symbol(s) => [symbol(s); N],
            Operand::Value(k) => values[k],
            Operand::Tuple(k) => lanes_from_list(self.tuples[k].clone()),
            Operand::Gather(k) => lanes_from_list(self.gathers[k].iter().map(|s| symbol(*s)).collect()),
        };
        for op in &self.instructions {
            let result = match *op {
                Op::Sum(n, a) => [lane_values_of_operand(&values, a)[..n].iter().sum(); N],
                Op::Lane(k, a) => [lane_values_of_operand(&values, a)[k]; N],
                Op::Join(n, a, b) => {
                    join_lanes(n, lane_values_of_operand(&values, a), lane_values_of_operand(&values, b))
                }
                op => {
                    let mut operands = Vec::with_capacity(3);
                    op.visit_operands(|o| operands.push(lane_values_of_operand(&values, o)));
                    std::array::from_fn(|lane| op.evaluate_in_lane(|k| operands[k][lane], table))
                }
            };
            values.push(result);
        }
        self.outputs.iter().map(|o| lane_values_of_operand(&values, *o)[0]).collect()
    }
}

impl Op {
    /// Returns the result of the operation in one SIMD lane from its operands in that lane.
    fn evaluate_in_lane(self, get: impl Fn(usize) -> f64, table: &dyn Fn(Lookup, [f64; 3]) -> f64) -> f64 {
        match self {
            Op::Neg(_) => -get(0),
            Op::Add(..) => get(0) + get(1),
            Op::Sub(..) => get(0) - get(1),
            Op::Mul(..) => get(0) * get(1),
            Op::Div(..) => get(0) / get(1),
            Op::MulAdd(..) => get(0).mul_add(get(1), get(2)),
            Op::MulSub(..) => get(0).mul_add(get(1), -get(2)),
            Op::NegMulAdd(..) => (-get(0)).mul_add(get(1), get(2)),
            Op::Call(f, _) => f.evaluate_at(get(0)),
            Op::Atan2(..) => libm::atan2(get(0), get(1)),
            Op::Pow(..) => libm::pow(get(0), get(1)),
            Op::Extreme(f, ..) => f.evaluate_extreme(get(0), get(1)),
            Op::Table(lookup, ..) => {
                table(lookup, std::array::from_fn(|k| if k < lookup.variable_count() { get(k) } else { 0.0 }))
            }
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => get(0),
        }
    }

    fn renumber_operands(self, number: &[usize]) -> Op {
        self.map_operands(|o| renumber_operand(o, number))
    }

    /// Returns the operation with each operand replaced by its image under a function.
    pub fn map_operands(self, mut n: impl FnMut(Operand) -> Operand) -> Op {
        match self {
            Op::Neg(a) => Op::Neg(n(a)),
            Op::Add(a, b) => Op::Add(n(a), n(b)),
            Op::Sub(a, b) => Op::Sub(n(a), n(b)),
            Op::Mul(a, b) => Op::Mul(n(a), n(b)),
            Op::Div(a, b) => Op::Div(n(a), n(b)),
            Op::MulAdd(a, b, c) => Op::MulAdd(n(a), n(b), n(c)),
            Op::MulSub(a, b, c) => Op::MulSub(n(a), n(b), n(c)),
            Op::NegMulAdd(a, b, c) => Op::NegMulAdd(n(a), n(b), n(c)),
            Op::Call(f, a) => Op::Call(f, n(a)),
            Op::Atan2(a, b) => Op::Atan2(n(a), n(b)),
            Op::Pow(a, b) => Op::Pow(n(a), n(b)),
            Op::Extreme(f, a, b) => Op::Extreme(f, n(a), n(b)),
            Op::Table(lookup, a, b, c) => {
                let last = lookup.variable_count().saturating_sub(1);
                let mut x = [a, b, c];
                x.iter_mut().take(last + 1).for_each(|x| *x = n(*x));
                let [a, b, c] = std::array::from_fn(|k: usize| x[k.min(last)]);
                Op::Table(lookup, a, b, c)
            }
            Op::Sum(count, a) => Op::Sum(count, n(a)),
            Op::Lane(k, a) => Op::Lane(k, n(a)),
            Op::Join(count, a, b) => Op::Join(count, n(a), n(b)),
        }
    }
}

fn renumber_operand(o: Operand, number: &[usize]) -> Operand {
    match o {
        Operand::Value(k) => Operand::Value(number[k]),
        other => other,
    }
}
