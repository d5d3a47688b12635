//! Reordering of sums on the critical path by the times at which their terms become available. If a late term
//! is added first, all other additions wait for it. The numbers of multiplications and additions stay the
//! same.
//!
//! Sums off the critical path keep their order: a partial sum that is computed early would occupy a register.

use super::terms::{LONGEST, Sum};
use super::times::{InstructionTimes, operation_latency};
use super::{Operand, Program};
use crate::machine::MULTIPLY;

impl Program {
    /// Orders the terms of sums on the critical path by the times at which they become available, late terms
    /// last.
    pub(super) fn with_late_terms_last(mut self) -> Program {
        let sums = self.sums_ending_at_instructions();
        let lanes = self.lane_counts();
        let is_multi_lane_operand = |o: Operand| match o {
            Operand::Value(a) => lanes[a] > 1,
            Operand::Tuple(_) | Operand::Gather(_) => true,
            _ => false,
        };
        let mut times = InstructionTimes::default();
        let mut ordered: Vec<Option<Sum>> = Vec::with_capacity(sums.len());
        for (k, sum) in sums.into_iter().enumerate() {
            let before = times.instruction_finish_time(&self, k);
            let sum = sum.map(|sum| times.order_terms_by_time(&self, sum, &is_multi_lane_operand));
            let sum = sum
                .map(|sum| (times.time_of_ordered_sum(&self, &sum.terms), sum))
                .filter(|(time, _)| *time <= before);
            let (time, sum) = sum.map_or((before, None), |(time, sum)| (time, Some(sum)));
            times.known.push(time);
            ordered.push(sum);
        }
        let end = times.known.iter().copied().max().unwrap_or(0);
        let rest = self.remaining_latency(&ordered);
        // Rewritten additions move to where their sum is used, after all its operands.
        let mut late = vec![false; self.instructions.len()];
        let mut rewritten = Vec::new();
        times.known.clear();
        for (k, sum) in ordered.iter().enumerate() {
            let before = times.instruction_finish_time(&self, k);
            times.known.push(before);
            let Some(sum) = sum.as_ref().filter(|_| before + rest[k] > end) else { continue };
            let time = times.time_of_ordered_sum(&self, &sum.terms);
            let Some(ops) = sum.operations_adding_terms().filter(|_| time <= before) else { continue };
            times.known[k] = time;
            for (at, op) in sum.additions.iter().zip(ops) {
                rewritten.push((*at, op));
                late[*at] = *at != k;
            }
        }
        if !late.contains(&true) {
            return self;
        }
        for (at, op) in rewritten {
            self.instructions[at] = op;
        }
        self.schedule_late_after_operands(&late)
    }

    /// Returns for each instruction the sum of at least three terms that ends with it.
    fn sums_ending_at_instructions(&self) -> Vec<Option<Sum>> {
        let mut sums: Vec<Option<Sum>> = self.instructions.iter().map(|_| None).collect();
        let mut inside = vec![false; self.instructions.len()];
        for k in (0..self.instructions.len()).rev() {
            let Some(ends) = self.instructions[k].addition_terms().filter(|_| !inside[k]) else { continue };
            let mut sum = Sum { additions: vec![k], terms: Vec::new() };
            let mut todo = ends.to_vec();
            while let Some(term) = todo.pop() {
                let inner = self.terms_of_single_use_addition(term.operand);
                match inner.filter(|_| sum.terms.len() + todo.len() < LONGEST) {
                    Some(inner) => {
                        sum.additions.push(term.operand.instruction_index());
                        inside[term.operand.instruction_index()] = true;
                        todo.extend(inner.map(|t| t.multiplied_by_sum_sign(term.negative)));
                    }
                    None => sum.terms.push(term),
                }
            }
            sum.additions.sort_unstable();
            sums[k] = Some(sum).filter(|sum| sum.terms.len() > 2);
        }
        sums
    }

    /// Sorts the instructions so that operands precede operations; `late` instructions come right after their
    /// last operand.
    fn schedule_late_after_operands(self, late: &[bool]) -> Program {
        let n = self.instructions.len();
        let mut users = vec![Vec::new(); n];
        let mut missing = vec![0; n];
        for k in (0..n).filter(|k| late[*k]) {
            self.instructions[k].visit_operands(|o| {
                if let Operand::Value(a) = o {
                    users[a].push(k);
                    missing[k] += 1;
                }
            });
        }
        let at_once: Vec<usize> = (0..n).filter(|k| late[*k] && missing[*k] == 0).collect();
        let mut order = Vec::with_capacity(n);
        for k in at_once.into_iter().chain((0..n).filter(|k| !late[*k])) {
            let mut todo = vec![k];
            while let Some(top) = todo.pop() {
                order.push(top);
                for &user in &users[top] {
                    missing[user] -= 1;
                    if missing[user] == 0 {
                        todo.push(user);
                    }
                }
            }
        }
        self.reorder_instructions(&order)
    }
}

impl InstructionTimes {
    /// Orders the terms of a sum by time, scalars before vectors of lanes; at least one of the first two
    /// terms is not a product.
    fn order_terms_by_time(&self, program: &Program, mut sum: Sum, is_wide: &dyn Fn(Operand) -> bool) -> Sum {
        sum.terms.sort_by_key(|term| {
            (
                is_wide(term.operand),
                self.availability_time_of_term(program, *term).0,
                term.operand.instruction_index(),
            )
        });
        let single = sum.terms.iter().position(|term| !self.availability_time_of_term(program, *term).1);
        if let Some(k) = single.filter(|k| *k > 1) {
            sum.terms[..=k].rotate_right(1);
        }
        sum
    }
}

impl Program {
    /// Returns for each instruction the latency from its value to the end of the program, with reordered
    /// sums.
    fn remaining_latency(&self, sums: &[Option<Sum>]) -> Vec<u32> {
        let mut rest = vec![0; self.instructions.len()];
        let mut is_part = vec![false; self.instructions.len()];
        let raise_remaining_time = |rest: &mut Vec<u32>, o: Operand, to: u32| {
            if let Operand::Value(a) = o {
                rest[a] = rest[a].max(to);
            }
        };
        for k in (0..self.instructions.len()).rev() {
            if is_part[k] {
                continue;
            }
            let op = &self.instructions[k];
            let pair = op.addition_terms();
            let terms = match (&sums[k], &pair) {
                (Some(sum), _) => {
                    sum.additions.iter().for_each(|a| is_part[*a] = true);
                    sum.terms.as_slice()
                }
                (None, Some(pair)) => pair.as_slice(),
                (None, None) => {
                    let time = rest[k] + operation_latency(op);
                    op.visit_operands(|o| raise_remaining_time(&mut rest, o, time));
                    continue;
                }
            };
            let mut time = rest[k];
            for (place, term) in terms.iter().enumerate().rev() {
                // One addition adds the first two terms.
                if place > 0 {
                    time += MULTIPLY;
                }
                match self.factors_of_single_use_product(term.operand) {
                    Some((a, b)) => {
                        is_part[term.operand.instruction_index()] = true;
                        raise_remaining_time(&mut rest, a, time);
                        raise_remaining_time(&mut rest, b, time);
                    }
                    None => raise_remaining_time(&mut rest, term.operand, time),
                }
            }
        }
        rest
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Symbol};
    use crate::lower::lower;

    /// Checks that a late term is added to a sum after several early ones.
    #[test]
    fn late_terms_are_added_last() {
        let g = Graph::new();
        let x: Vec<_> = (0..12).map(|k| g.symbol(Symbol(k))).collect();
        let late = (0..6).fold(x[0], |e, _| e * e / x[1]);
        let sum = late * x[2] + x[3] * x[4] - x[5] * x[6] + x[7] + x[8] * x[9];
        let program = lower(&[sum]);
        let before = program.counts;
        let fused = program.with_late_terms_last().with_fused_products();
        assert_eq!(fused.counts, before);
        // Six quotients of squares and four additions, the last one fused with the late product.
        assert_eq!(fused.instructions.len(), 12 + 4);
        let test_number_of_symbol = |s: Symbol| 1.0 + 0.1 * f64::from(s.0);
        let test_number_of_index = |k: u32| test_number_of_symbol(Symbol(k));
        let expected = {
            let late = (0..6).fold(test_number_of_index(0), |e, _| e * e / test_number_of_index(1));
            late * test_number_of_index(2) + test_number_of_index(3) * test_number_of_index(4)
                - test_number_of_index(5) * test_number_of_index(6)
                + test_number_of_index(7)
                + test_number_of_index(8) * test_number_of_index(9)
        };
        assert!((fused.interpret_program(&test_number_of_symbol)[0] - expected).abs() < 1e-14);
        assert_eq!(fused.estimated_program_time(), 16 + 6 * (4 + 13) + 4);
    }
}
