//! Ordering of instructions for few live values, for processors that keep all values of a state in registers.
//! Results are stored as soon as they are computed, and arguments are read before their first use.

use super::{Operand, Program};
use crate::expr::Symbol;
use std::collections::BTreeMap;

impl Program {
    /// Reorders the instructions so that few values are live at once. `arrays` are the lengths of the arrays
    /// to which consecutive results belong. The best of several orders is used.
    pub fn with_few_live_values(self, arrays: &[usize]) -> Program {
        let order = self.order_with_few_live_values(arrays);
        self.reorder_instructions(&order)
    }

    /// Returns the order of the instructions that [`with_few_live_values`](Self::with_few_live_values) uses.
    #[must_use]
    pub fn order_with_few_live_values(&self, arrays: &[usize]) -> Vec<usize> {
        let mut needs = InstructionOperands::from_program(self);
        let mut best: Vec<usize> = (0..self.instructions.len()).collect();
        let mut fewest = needs.maximum_live_values(&best);
        let mut keep_order_if_better = |order: Vec<usize>, needs: &InstructionOperands| {
            let live = needs.maximum_live_values(&order);
            if live < fewest {
                (best, fewest) = (order, live);
            }
        };
        // Derivatives by several arguments share most values in corresponding entries.
        for together in 1..=arrays.len().clamp(1, 3) {
            let mut results = self.interleaved_result_instructions(arrays, together);
            for _ in 0..2 {
                results.reverse();
                needs.results.clone_from(&results);
                keep_order_if_better(needs.depth_first_order(self), &needs);
                if self.instructions.len() <= GREEDY {
                    keep_order_if_better(needs.schedule_backwards(), &needs);
                }
            }
        }
        best
    }

    /// Returns the instructions of the results, with `together` consecutive arrays of equal length entry by
    /// entry.
    fn interleaved_result_instructions(&self, arrays: &[usize], together: usize) -> Vec<usize> {
        let mut keys = Vec::new();
        for (k, length) in arrays.iter().enumerate() {
            let equal = arrays[..k].iter().rev().take_while(|other| *other == length).count();
            let group = k - equal % together;
            keys.extend((0..*length).map(|entry| (group, entry, k)));
        }
        keys.resize(self.outputs.len(), (arrays.len(), 0, 0));
        let mut all: Vec<usize> = (0..self.outputs.len()).collect();
        all.sort_by_key(|k| keys[*k]);
        let index_of_output_value = |k: &usize| match self.outputs[*k] {
            Operand::Value(k) => Some(k),
            _ => None,
        };
        all.iter().filter_map(index_of_output_value).collect()
    }
}

/// Maximum number of instructions of programs for which orders with quadratic effort are tried.
const GREEDY: usize = 4000;

/// Values that each instruction needs, where arguments of the program are numbered after the values of its
/// instructions.
struct InstructionOperands {
    of: Vec<Vec<usize>>,
    /// Number of program values and arguments together.
    count: usize,
    /// Instructions whose values are results, in the order of the results.
    results: Vec<usize>,
}

impl InstructionOperands {
    fn from_program(program: &Program) -> InstructionOperands {
        let n = program.instructions.len();
        let mut arguments: BTreeMap<Symbol, usize> = BTreeMap::new();
        let of = program.instructions.iter().map(|op| {
            let mut list = Vec::new();
            op.visit_operands(|o| {
                let next = n + arguments.len();
                match o {
                    Operand::Value(k) => list.push(k),
                    Operand::Symbol(s) => list.push(*arguments.entry(s).or_insert(next)),
                    _ => {}
                }
            });
            list.sort_unstable();
            list.dedup();
            list
        });
        let of = of.collect();
        let results = program.outputs.iter().filter_map(|o| match o {
            Operand::Value(k) => Some(*k),
            _ => None,
        });
        InstructionOperands { of, count: n + arguments.len(), results: results.collect() }
    }

    /// Returns the maximum number of values that are live at once in an order of the instructions.
    fn maximum_live_values(&self, order: &[usize]) -> usize {
        let mut last = vec![usize::MAX; self.count];
        for (at, k) in order.iter().enumerate() {
            self.of[*k].iter().for_each(|a| last[*a] = at);
        }
        let mut is_live = vec![false; self.count];
        let (mut live, mut most) = (0_usize, 0);
        for (at, k) in order.iter().enumerate() {
            for a in &self.of[*k] {
                if !is_live[*a] {
                    is_live[*a] = true;
                    live += 1;
                }
            }
            most = most.max(live);
            live -= self.of[*k].iter().filter(|a| last[**a] == at).count();
            if last[*k] != usize::MAX {
                is_live[*k] = true;
                live += 1;
            }
        }
        most
    }

    /// Returns an instruction order that computes one result after another; of the operands of an
    /// instruction, the one that needs most values comes first (Sethi and Ullman 1970).
    fn depth_first_order(&self, program: &Program) -> Vec<usize> {
        let n = self.of.len();
        let mut need = vec![1_usize; n];
        for k in 0..n {
            let mut list: Vec<usize> = self.of[k].iter().filter(|a| **a < n).map(|a| need[*a]).collect();
            list.sort_unstable_by(|a, b| b.cmp(a));
            need[k] = list.iter().enumerate().map(|(at, need)| at + need).max().unwrap_or(1);
        }
        let mut order = Vec::with_capacity(n);
        let mut is_done = vec![false; n];
        for result in self.results.iter().copied().chain((0..n).filter(|k| program.uses[*k] == 0)) {
            let mut stack = vec![(result, false)];
            while let Some((k, is_ready)) = stack.pop() {
                if is_done[k] {
                    continue;
                }
                if is_ready {
                    is_done[k] = true;
                    order.push(k);
                    continue;
                }
                stack.push((k, true));
                let mut list: Vec<usize> =
                    self.of[k].iter().copied().filter(|a| *a < n && !is_done[*a]).collect();
                list.sort_by_key(|a| need[*a]);
                stack.extend(list.into_iter().map(|a| (a, false)));
            }
        }
        order
    }

    /// Returns an instruction order chosen from the last instruction to the first, such that each instruction
    /// adds the fewest live values.
    fn schedule_backwards(&self) -> Vec<usize> {
        let n = self.of.len();
        let mut users = vec![0_usize; self.count];
        self.of.iter().flatten().for_each(|a| users[*a] += 1);
        let mut since = vec![0_usize; self.count];
        let mut rank = vec![0_usize; n];
        for (at, k) in self.results.iter().enumerate() {
            rank[*k] = at;
        }
        let mut ready: Vec<usize> = (0..n).filter(|k| users[*k] == 0).collect();
        let mut order = Vec::with_capacity(n);
        while !ready.is_empty() {
            let pressure_key = |k: usize| {
                let added = self.of[k].iter().filter(|a| since[**a] == 0).count() as isize;
                (added - isize::from(since[k] > 0), usize::MAX - since[k], usize::MAX - rank[k])
            };
            let Some(at) = (0..ready.len()).min_by_key(|at| pressure_key(ready[*at])) else { break };
            let k = ready.swap_remove(at);
            order.push(k);
            for a in &self.of[k] {
                if since[*a] == 0 {
                    since[*a] = order.len();
                }
                users[*a] -= 1;
                if users[*a] == 0 && *a < n {
                    ready.push(*a);
                }
            }
        }
        order.reverse();
        order
    }
}
