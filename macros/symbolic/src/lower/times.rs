//! Earliest times at which the values of a program are available, limited by operand latencies alone, with
//! products fused.

use super::terms::Term;
use super::{Op, Operand, Program};
use crate::machine::{ADD, CALL, DIVIDE, HALVE, MOVE_LANE, MULTIPLY, NEGATE, SINE};

/// Times of the instructions processed so far, in fractions of a cycle.
#[derive(Default)]
pub(super) struct InstructionTimes {
    pub known: Vec<u32>,
}

impl InstructionTimes {
    fn time_of_value(&self, o: Operand) -> u32 {
        match o {
            Operand::Value(k) => self.known.get(k).copied().unwrap_or(0),
            _ => 0,
        }
    }

    /// Returns the time at which the value of instruction `k` is available.
    pub fn instruction_finish_time(&self, program: &Program, k: usize) -> u32 {
        let op = &program.instructions[k];
        if let Some([a, b]) = op.addition_terms() {
            return self.time_of_ordered_sum(program, &[a, b]);
        }
        let mut start = 0;
        op.visit_operands(|o| start = start.max(self.time_of_value(o)));
        start + if matches!(op, Op::Call(..)) { SINE } else { operation_latency(op) }
    }

    /// Returns the time at which a term can be added, and true if it is a product that fuses; its factors
    /// must be available then.
    pub fn availability_time_of_term(&self, program: &Program, term: Term) -> (u32, bool) {
        match program.factors_of_single_use_product(term.operand) {
            Some((a, b)) => (self.time_of_value(a).max(self.time_of_value(b)), true),
            None => (self.time_of_value(term.operand), false),
        }
    }

    /// Returns the time at which the sum of terms that are added in order is available.
    pub fn time_of_ordered_sum(&self, program: &Program, terms: &[Term]) -> u32 {
        let mut times = terms.iter().map(|term| self.availability_time_of_term(program, *term));
        let (Some(first), Some(second)) = (times.next(), times.next()) else { return 0 };
        let start = match (first, second) {
            // The earlier of two products is a separate instruction.
            ((a, true), (b, true)) => (a.min(b) + MULTIPLY).max(a.max(b)) + MULTIPLY,
            ((a, false), (b, false)) => a.max(b) + ADD,
            ((a, _), (b, _)) => a.max(b) + MULTIPLY,
        };
        times.fold(start, |sum, (time, fuses)| sum.max(time) + if fuses { MULTIPLY } else { ADD })
    }
}

/// Returns the latency of an operation. Sines and cosines are evaluated at the start and count zero.
pub(super) fn operation_latency(op: &Op) -> u32 {
    match op {
        Op::Call(..) => 0,
        Op::Neg(_) => NEGATE,
        Op::Lane(..) | Op::Join(..) => MOVE_LANE,
        Op::Add(..) | Op::Sub(..) => ADD,
        Op::Mul(..) | Op::MulAdd(..) | Op::MulSub(..) | Op::NegMulAdd(..) | Op::Extreme(..) => MULTIPLY,
        Op::Sum(lanes, _) => HALVE * lane_reduction_step_count(*lanes),
        Op::Div(..) => DIVIDE,
        Op::Atan2(..) | Op::Pow(..) | Op::Table(..) => CALL,
    }
}

/// Returns the number of processor issue slots that an operation takes.
pub(super) fn issue_slots(op: &Op) -> u32 {
    match op {
        Op::Call(..) => 0,
        Op::Sum(lanes, _) => 2 * lane_reduction_step_count(*lanes),
        _ => 1,
    }
}

/// Returns the number of steps that add the upper half of the lanes to the lower half.
fn lane_reduction_step_count(lanes: usize) -> u32 {
    lanes.next_power_of_two().trailing_zeros()
}
