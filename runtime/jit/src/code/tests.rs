//! Random programs: machine code equals an evaluation of one operation after the other, bit for bit.

use super::plan::padded;
use super::{Code, write_sines_and_cosines};
use crate::layout::Layout;
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

/// Number of programs; the environment variable `LINKWORK_PROGRAMS` chooses another one.
const PROGRAMS: u64 = 1000;
/// Numbers of parameters, coordinates and velocities.
const INPUTS: [usize; 3] = [3, 9, 5];
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
            4 => symbol(Quantity::Velocity(self.index_below(INPUTS[2]))),
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
        program.remove_unused();
        program
    }
}

/// Evaluates a program one operation after the other, some of whose values are known. Returns all values.
fn values(
    program: &Program,
    value: &dyn Fn(&[f64], Operand) -> f64,
    table: &AnyTable,
    known: &HashMap<usize, f64>,
) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::new();
    for (k, op) in program.instructions.iter().enumerate() {
        let get = |operand| value(&values, operand);
        let found = match *op {
            Op::Neg(a) => -get(a),
            Op::Add(a, b) => get(a) + get(b),
            Op::Sub(a, b) => get(a) - get(b),
            Op::Mul(a, b) => get(a) * get(b),
            Op::Div(a, b) => get(a) / get(b),
            Op::MulAdd(a, b, c) => get(a).mul_add(get(b), get(c)),
            Op::MulSub(a, b, c) => get(a).mul_add(get(b), -get(c)),
            Op::NegMulAdd(a, b, c) => (-get(a)).mul_add(get(b), get(c)),
            Op::Call(f, a) => f.evaluate_at(get(a)),
            Op::Atan2(a, b) => get(a).atan2(get(b)),
            Op::Pow(a, b) => get(a).powf(get(b)),
            Op::Extreme(f, a, b) => f.evaluate_extreme(get(a), get(b)),
            Op::Table(_, a, ..) => table.derivative_value([get(a); 3], [1, 0, 0]),
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => f64::NAN,
        };
        values.push(known.get(&k).copied().unwrap_or(found));
    }
    values
}

/// Evaluates a program; sines and cosines are those of the functions that machine code calls.
fn evaluate(program: &Program, layout: &Layout, inputs: &[&[f64]], table: &AnyTable) -> Vec<f64> {
    let value = |values: &[f64], operand: Operand| match operand {
        Operand::Const(c) => c,
        Operand::Symbol(symbol) => {
            layout.locate(symbol).map_or(f64::NAN, |(slot, index)| inputs[slot][index])
        }
        Operand::Value(k) => values[k],
        Operand::Tuple(_) | Operand::Gather(_) => f64::NAN,
    };
    let before = values(program, &value, table, &HashMap::new());
    let angles = Angles::find_angles(program);
    let list = angles.widest_first(program, |_| 1);
    let count = padded(list.len());
    let mut array = vec![0.0; 3 * count];
    for (at, entry) in array[..count].iter_mut().enumerate() {
        *entry = value(&before, list[if at < list.len() { at } else { 0 }].angle);
    }
    if count > 0 {
        write_sines_and_cosines(array.as_mut_ptr(), count as u64);
    }
    let mut known = HashMap::new();
    for (k, op) in program.instructions.iter().enumerate().filter(|(k, _)| angles.covered[*k]) {
        let Op::Call(f, operand) = *op else { continue };
        let at = list.iter().position(|angle| angle.angle == operand).expect("the angle is in the list");
        known.insert(k, array[if f == Function::Sin { count + at } else { 2 * count + at }]);
    }
    let all = values(program, &value, table, &known);
    program.outputs.iter().map(|output| value(&all, *output)).collect()
}

fn agree(compile: fn(&Program, &Layout, usize) -> Result<Code, String>) {
    let count = std::env::var("LINKWORK_PROGRAMS").ok().and_then(|count| count.parse().ok());
    let layout = Layout::new(&[Argument::Q, Argument::V]).expect("two arguments");
    let table = Table::new([&[-1.0, 0.0, 2.0]], &[1.0, -0.5, 3.0]).map(Table::smooth);
    let tables = [AnyTable::from(table.expect("increasing points"))];
    for seed in 0..count.unwrap_or(PROGRAMS) {
        let mut random = Random(seed);
        let program = random.program();
        let results = random.index_below(program.outputs.len() + 1);
        let code = compile(&program, &layout, results).expect("machine code");
        for _ in 0..3 {
            let inputs = INPUTS.map(|n| (0..n).map(|_| random.value()).collect::<Vec<f64>>());
            let inputs = inputs.each_ref().map(Vec::as_slice);
            let mut found = vec![f64::NAN; program.outputs.len()];
            let (first, more) = found.split_at_mut(results);
            code.call(&inputs, &tables, first, more);
            let expected = evaluate(&program, &layout, &inputs, &tables[0]);
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let equal = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
                assert!(equal, "program {seed}, output {k}: {found:e} instead of {expected:e}");
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[test]
fn assembled_programs_equal_an_evaluation_operation_by_operation() {
    if super::x86::is_supported() {
        agree(Code::assemble_x86_code);
    }
}

#[test]
fn programs_by_cranelift_equal_an_evaluation_operation_by_operation() {
    agree(Code::by_cranelift);
}
