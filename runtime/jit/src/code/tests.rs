//! Tests with random programs: machine code equals an evaluation of one operation after the other, bit for
//! bit.

use super::plan::needs_function_call;
use super::{Code, write_sines_and_cosines};
use crate::layout::InputLayout;
use crate::table::AnyTable;
use linkwork::Table;
use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::expr::{Extreme, Function, Lookup};
use linkwork_compiler::lower::{Angles, Op, Operand, Program};
use linkwork_compiler::mechanism::Quantity;
use random::Random;
use std::collections::HashMap;

#[path = "../../tests/random/mod.rs"]
mod random;

/// Number of random programs; the environment variable `LINKWORK_PROGRAMS` chooses another number.
const PROGRAMS: u64 = 1000;
/// Numbers of lanes of programs with lanes.
const LANES: [usize; 7] = [2, 3, 4, 5, 6, 7, 8];
/// Arguments of the programs: more than there are registers for their addresses.
const ARGUMENTS: [Argument; 7] =
    [Argument::Q, Argument::V, Argument::A, Argument::Tau, Argument::U, Argument::T, Argument::Momenta(5)];
/// Numbers of parameters, and of values of each argument.
const INPUTS: [usize; 8] = [3, 9, 5, 5, 5, 5, 1, 5];
const CONSTANTS: [f64; 8] = [0.0, -0.0, 1.0, -1.0, 0.5, 9.81, -1e-3, 1e6];
const VALUES: [f64; 6] = [0.0, -0.0, 1e5, f64::NAN, f64::INFINITY, 5e-324];

impl Random {
    fn value(&mut self) -> f64 {
        match self.index_below(40) {
            0 => VALUES[self.index_below(VALUES.len())],
            _ => self.index_below(8001) as f64 / 2000.0 - 2.0,
        }
    }

    fn operand(&mut self, before: usize, reach: usize) -> Operand {
        let symbol = |quantity: Quantity| Operand::Symbol(quantity.symbol());
        match self.index_below(if before == 0 { 5 } else { 16 }) {
            0 => Operand::Const(CONSTANTS[self.index_below(CONSTANTS.len())]),
            1 => symbol(Quantity::Parameter(self.index_below(INPUTS[0]))),
            2 | 3 => symbol(Quantity::Configuration(self.index_below(INPUTS[1]))),
            4 => {
                let k = self.index_below(INPUTS[2]);
                symbol(match self.index_below(6) {
                    0 => Quantity::Velocity(k),
                    1 => Quantity::Acceleration(k),
                    2 => Quantity::Force(k),
                    3 => Quantity::Input(k),
                    4 => Quantity::Time,
                    _ => Quantity::Momentum(k),
                })
            }
            _ => Operand::Value(before - 1 - self.index_below(before.min(reach))),
        }
    }

    fn operation(&mut self, before: usize, reach: usize, calls: usize) -> Op {
        let [a, b, c] = std::array::from_fn(|_| self.operand(before, reach));
        match self.index_below(28 + calls) {
            0..=4 => Op::Add(a, b),
            5..=8 => Op::Sub(a, b),
            9..=13 => Op::Mul(a, b),
            14..=18 => Op::MulAdd(a, b, c),
            19..=21 => Op::MulSub(a, b, c),
            22..=24 => Op::NegMulAdd(a, b, c),
            25 => Op::Neg(a),
            26 => Op::Div(a, b),
            27 => Op::Call([Function::Sin, Function::Cos][self.index_below(2)], a),
            28 => Op::Call(Function::ALL[self.index_below(Function::ALL.len())].1, a),
            29 => Op::Atan2(a, b),
            30 => Op::Pow(a, b),
            31 => Op::Extreme([Extreme::Min, Extreme::Max][self.index_below(2)], a, b),
            _ => Op::Table(Lookup::new(0, 1).partial_derivative(0).unwrap_or(Lookup::new(0, 1)), a, a, a),
        }
    }

    fn program(&mut self) -> Program {
        let most = [8, 40, 40, 300][self.index_below(4)];
        let length = 1 + self.index_below(most);
        let reach = [4, 20, 1000][self.index_below(3)];
        let calls = [0, 0, 5][self.index_below(3)];
        let mut program = Program::default();
        for k in 0..length {
            let op = self.operation(k, reach, calls);
            program.instructions.push(op);
        }
        let outputs = 1 + self.index_below(40);
        program.outputs = (0..outputs).map(|_| self.operand(length, length)).collect();
        program.remove_unused_instructions();
        program
    }
}

/// Evaluates a program one operation after the other, where some values are already known. Returns all
/// values.
fn evaluate_all_values(
    program: &Program,
    value: &dyn Fn(&[f64], Operand) -> f64,
    table: &AnyTable,
    known: &HashMap<usize, f64>,
) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::new();
    for (k, op) in program.instructions.iter().enumerate() {
        let value_of_operand = |operand| value(&values, operand);
        let found = match *op {
            Op::Neg(a) => -value_of_operand(a),
            Op::Add(a, b) => value_of_operand(a) + value_of_operand(b),
            Op::Sub(a, b) => value_of_operand(a) - value_of_operand(b),
            Op::Mul(a, b) => value_of_operand(a) * value_of_operand(b),
            Op::Div(a, b) => value_of_operand(a) / value_of_operand(b),
            Op::MulAdd(a, b, c) => value_of_operand(a).mul_add(value_of_operand(b), value_of_operand(c)),
            Op::MulSub(a, b, c) => value_of_operand(a).mul_add(value_of_operand(b), -value_of_operand(c)),
            Op::NegMulAdd(a, b, c) => {
                (-value_of_operand(a)).mul_add(value_of_operand(b), value_of_operand(c))
            }
            Op::Call(f, a) => f.evaluate_at(value_of_operand(a)),
            Op::Atan2(a, b) => value_of_operand(a).atan2(value_of_operand(b)),
            Op::Pow(a, b) => value_of_operand(a).powf(value_of_operand(b)),
            Op::Extreme(f, a, b) => f.evaluate_extreme(value_of_operand(a), value_of_operand(b)),
            Op::Table(_, a, ..) => table.value_or_derivative([value_of_operand(a); 3], [1, 0, 0]),
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => f64::NAN,
        };
        values.push(known.get(&k).copied().unwrap_or(found));
    }
    values
}

/// Program under construction whose values have one lane or `lanes` lanes.
struct LaneProgramBuilder {
    program: Program,
    lanes: usize,
    /// Whether each value has lanes.
    is_wide: Vec<bool>,
    /// Whether each value depends on no function: only sines of such values are computed together.
    is_plain: Vec<bool>,
}

impl LaneProgramBuilder {
    fn push(&mut self, op: Op, is_wide: bool) {
        let mut is_plain = true;
        op.visit_operands(|operand| is_plain &= !matches!(operand, Operand::Value(k) if !self.is_plain[k]));
        // The library's sines of single lanes have other bits.
        let op = match op {
            Op::Call(Function::Sin | Function::Cos, a) if !is_plain => Op::Neg(a),
            op => op,
        };
        self.is_plain.push(is_plain && !matches!(op, Op::Call(..)) && !needs_function_call(&op));
        self.program.instructions.push(op);
        self.is_wide.push(is_wide);
    }

    /// Returns a random value that has lanes, or has no lanes; `None` if no value does.
    fn value(&self, random: &mut Random, reach: usize, is_wide: bool) -> Option<Operand> {
        let first = self.is_wide.len().saturating_sub(reach);
        let all: Vec<usize> = (first..self.is_wide.len()).filter(|k| self.is_wide[*k] == is_wide).collect();
        (!all.is_empty()).then(|| Operand::Value(all[random.index_below(all.len())]))
    }

    /// Returns a random operand with lanes: constants, inputs in any order or adjacent ones, or a value.
    fn random_wide_operand(&mut self, random: &mut Random, reach: usize) -> Operand {
        let choice = random.index_below(12);
        if let Some(value) = self.value(random, reach, true).filter(|_| choice > 2) {
            return value;
        }
        if choice == 0 {
            let constants = (0..self.lanes).map(|_| CONSTANTS[random.index_below(CONSTANTS.len())]);
            self.program.tuples.push(constants.collect());
            return Operand::Tuple(self.program.tuples.len() - 1);
        }
        let first = random.index_below(INPUTS[1] - self.lanes + 1);
        let is_adjacent = random.index_below(2) == 0;
        let symbols = (0..self.lanes).map(|k| {
            let k = if is_adjacent { first + k } else { random.index_below(INPUTS[1]) };
            Quantity::Configuration(k).symbol()
        });
        self.program.gathers.push(symbols.collect());
        Operand::Gather(self.program.gathers.len() - 1)
    }

    /// Returns a random operand without lanes.
    fn random_scalar_operand(&self, random: &mut Random, reach: usize) -> Operand {
        match self.value(random, reach, false).filter(|_| random.index_below(3) > 0) {
            Some(value) => value,
            None => random.operand(0, 1),
        }
    }

    fn add_random_instruction(&mut self, random: &mut Random, reach: usize, calls: usize) {
        let is_wide = random.index_below(4) > 0;
        let half = self.lanes / 2;
        let (op, is_wide) = match random.index_below(10) {
            0 => {
                (Op::Sum(1 + random.index_below(self.lanes), self.random_wide_operand(random, reach)), false)
            }
            1 | 2 => {
                (Op::Lane(random.index_below(self.lanes), self.random_wide_operand(random, reach)), false)
            }
            3 if self.lanes == 2 * half => {
                let [a, b] = std::array::from_fn(|_| match random.index_below(2) {
                    0 => self.random_wide_operand(random, reach),
                    _ => self.random_scalar_operand(random, reach),
                });
                (Op::Join(half, a, b), true)
            }
            _ => {
                let op = random.operation(0, 1, calls);
                let mut first = is_wide;
                let op = op.map_operands(|_| {
                    match std::mem::take(&mut first) || is_wide && random.index_below(3) > 0 {
                        true => self.random_wide_operand(random, reach),
                        false => self.random_scalar_operand(random, reach),
                    }
                });
                (op, is_wide)
            }
        };
        self.push(op, is_wide);
    }

    fn random_program(random: &mut Random) -> Program {
        let lanes = LANES[random.index_below(LANES.len())];
        let (is_wide, is_plain) = (Vec::new(), Vec::new());
        let mut wide = LaneProgramBuilder { program: Program::default(), lanes, is_wide, is_plain };
        let most = [8, 40, 200][random.index_below(3)];
        let reach = [4, 20, 1000][random.index_below(3)];
        let calls = [0, 0, 5][random.index_below(3)];
        (0..1 + random.index_below(most)).for_each(|_| wide.add_random_instruction(random, reach, calls));
        let mut outputs = Vec::new();
        for _ in 0..1 + random.index_below(10) {
            match random.index_below(3) {
                0 => outputs.push(wide.random_scalar_operand(random, 1000)),
                // Lanes of one value are neighbours.
                _ => {
                    let value = wide.random_wide_operand(random, 1000);
                    for k in 0..lanes {
                        wide.push(Op::Lane(k, value), false);
                        outputs.push(Operand::Value(wide.is_wide.len() - 1));
                    }
                }
            }
        }
        let LaneProgramBuilder { mut program, .. } = wide;
        program.outputs = outputs;
        program.remove_unused_instructions();
        program
    }
}

/// Evaluates a program; sines and cosines are those of the functions that machine code calls.
fn evaluate(program: &Program, layout: &InputLayout, inputs: &[&[f64]], table: &AnyTable) -> Vec<f64> {
    let value_of_operand = |values: &[f64], operand: Operand| match operand {
        Operand::Const(c) => c,
        Operand::Symbol(symbol) => {
            layout.locate_symbol(symbol).map_or(f64::NAN, |(slot, index)| inputs[slot][index])
        }
        Operand::Value(k) => values[k],
        Operand::Tuple(_) | Operand::Gather(_) => f64::NAN,
    };
    let before = evaluate_all_values(program, &value_of_operand, table, &HashMap::new());
    let angles = Angles::find_angles(program);
    let mut known = HashMap::new();
    for (k, op) in program.instructions.iter().enumerate().filter(|(k, _)| angles.covered[*k]) {
        let Op::Call(f, operand) = *op else { continue };
        let mut array = [value_of_operand(&before, operand), 0.0, 0.0];
        write_sines_and_cosines(array.as_mut_ptr(), 1);
        known.insert(k, array[if f == Function::Sin { 1 } else { 2 }]);
    }
    let all = evaluate_all_values(program, &value_of_operand, table, &known);
    program.outputs.iter().map(|output| value_of_operand(&all, *output)).collect()
}

/// Compares machine code of random programs with their evaluation.
///
/// `random_program` returns a program, and the program without lanes that computes the same bits.
fn compare_code_with_evaluation(
    compile: fn(&Program, &InputLayout, usize) -> Result<Code, String>,
    random_program: fn(&mut Random) -> [Program; 2],
) {
    let count = std::env::var("LINKWORK_PROGRAMS").ok().and_then(|count| count.parse().ok());
    let first = std::env::var("LINKWORK_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(0);
    let layout = InputLayout::new(&ARGUMENTS).expect("seven arguments");
    let table = Table::new([&[-1.0, 0.0, 2.0]], &[1.0, -0.5, 3.0]).map(Table::smooth);
    let tables = [AnyTable::from(table.expect("increasing points"))];
    for seed in first..first + count.unwrap_or(PROGRAMS) {
        let mut random = Random(seed);
        let [program, oracle] = random_program(&mut random);
        let results = random.index_below(program.outputs.len() + 1);
        let code = compile(&program, &layout, results).expect("machine code");
        for _ in 0..3 {
            let inputs = INPUTS.map(|n| (0..n).map(|_| random.value()).collect::<Vec<_>>());
            let inputs = inputs.each_ref().map(Vec::as_slice);
            let mut found = vec![f64::NAN; program.outputs.len()];
            let (first, more) = found.split_at_mut(results);
            code.call(inputs[0], &inputs[1..], &tables, first, more);
            let expected = evaluate(&oracle, &layout, &inputs, &tables[0]);
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let equal = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
                assert!(equal, "program {seed}, output {k}: {found:e} instead of {expected:e}");
            }
        }
    }
}

fn random_program_pair_without_lanes(random: &mut Random) -> [Program; 2] {
    let program = random.program();
    [program.clone(), program]
}

#[cfg(target_arch = "x86_64")]
#[test]
fn assembled_programs_equal_an_evaluation_operation_by_operation() {
    if super::x86::is_supported() {
        compare_code_with_evaluation(Code::assemble_x86_code, random_program_pair_without_lanes);
    }
}

/// A program with lanes computes the bits of the program with one instruction for every lane.
#[cfg(target_arch = "x86_64")]
#[test]
fn assembled_lanes_equal_an_evaluation_lane_by_lane() {
    if super::x86::is_supported() {
        compare_code_with_evaluation(Code::assemble_x86_code, |random| {
            let program = LaneProgramBuilder::random_program(random);
            let oracle = program.expand_lanes();
            [program, oracle]
        });
    }
}

#[test]
fn programs_by_cranelift_equal_an_evaluation_operation_by_operation() {
    compare_code_with_evaluation(Code::compile_with_cranelift, random_program_pair_without_lanes);
}
