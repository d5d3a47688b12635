//! List scheduling of instructions by critical path. A processor looks a few hundred instructions ahead of
//! the oldest one that waits, so independent computations, such as bias forces and factors of the mass
//! matrix, overlap only if their instructions are interleaved. The next instruction is the one with the
//! longest remaining latency among those whose operands are available.

use super::times::{issue_slots, operation_latency};
use super::{Operand, Program};
use crate::machine::{CYCLE, MOST_PARALLELISM};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

impl Program {
    /// Orders the instructions by their latencies.
    pub(super) fn schedule_instructions(self) -> Program {
        match self.scheduled_order() {
            Some(order) => self.reorder_instructions(&order),
            None => self,
        }
    }

    /// Returns the estimated time of a call in half cycles: the number of instructions plus the cycles of the
    /// critical path, since consecutive calls overlap only in part.
    pub fn estimated_program_time(&self) -> usize {
        let fused = self.copy_with_fused_products();
        let longest =
            fused.latencies_to_program_end(&fused.users_of_values()).into_iter().max().unwrap_or(0) / CYCLE;
        fused.instructions.len() + longest as usize
    }

    /// Returns for each instruction the instructions that use its value, once per use.
    fn users_of_values(&self) -> Vec<Vec<usize>> {
        let mut users = vec![Vec::new(); self.instructions.len()];
        for (k, op) in self.instructions.iter().enumerate() {
            op.visit_operands(|o| {
                if let Operand::Value(a) = o {
                    users[a].push(k);
                }
            });
        }
        users
    }

    /// Returns the latency from the start of each instruction to the end of the program, in thirds of a
    /// cycle.
    fn latencies_to_program_end(&self, users: &[Vec<usize>]) -> Vec<u32> {
        let mut rest = vec![0; users.len()];
        for k in (0..users.len()).rev() {
            let after = users[k].iter().map(|u| rest[*u]).max().unwrap_or(0);
            rest[k] = after + operation_latency(&self.instructions[k]);
        }
        rest
    }

    /// Returns the schedule as indices of instructions, or `None` if the program has enough parallelism in
    /// any order.
    fn scheduled_order(&self) -> Option<Vec<usize>> {
        let n = self.instructions.len();
        let users = self.users_of_values();
        let mut missing = vec![0; n];
        users.iter().flatten().for_each(|k| missing[*k] += 1);
        let rest = self.latencies_to_program_end(&users);
        let cycles = f64::from(*rest.iter().max()?) / f64::from(CYCLE);
        if n as f64 > MOST_PARALLELISM * cycles {
            return None;
        }
        let mut ready = vec![0; n];
        let mut waiting: BinaryHeap<Reverse<(u32, usize)>> =
            (0..n).filter(|k| missing[*k] == 0).map(|k| Reverse((0, k))).collect();
        let mut able: BinaryHeap<(u32, Reverse<usize>)> = BinaryHeap::new();
        let (mut order, mut time) = (Vec::with_capacity(n), 0);
        loop {
            while let Some(&Reverse((_, k))) = waiting.peek().filter(|Reverse((at, _))| *at <= time) {
                waiting.pop();
                able.push((rest[k], Reverse(k)));
            }
            let Some((_, Reverse(k))) = able.pop() else {
                let Some(&Reverse((at, _))) = waiting.peek() else { return Some(order) };
                time = at;
                continue;
            };
            order.push(k);
            for &user in &users[k] {
                ready[user] = ready[user].max(time + operation_latency(&self.instructions[k]));
                missing[user] -= 1;
                if missing[user] == 0 {
                    waiting.push(Reverse((ready[user], user)));
                }
            }
            time += issue_slots(&self.instructions[k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Expr, Graph, Symbol};
    use crate::lower::pipeline::PART;
    use crate::lower::{Op, Operand, lower};

    /// Returns a long chain of operations, and a longer one that follows it in the program.
    fn long_operation_chains<'g>(g: &'g Graph) -> Vec<Expr<'g>> {
        let [x, y] = [0, 1].map(|k| g.symbol(Symbol(k)));
        let iterated_square_plus_product = |from: Expr<'g>, n: usize| (0..n).fold(from, |e, _| e * e + x * y);
        let first = iterated_square_plus_product(x + y, 8);
        vec![first, iterated_square_plus_product((x - y).sin() / y, 12)]
    }

    #[test]
    fn scheduling_preserves_values_and_uses() {
        let g = Graph::new();
        let before = lower(&long_operation_chains(&g)).run_passes(PART);
        let after = before.clone().schedule_instructions();
        let test_number_of_symbol = |s: Symbol| 0.3 + 0.1 * f64::from(s.0);
        assert_eq!(
            before.interpret_program(&test_number_of_symbol),
            after.interpret_program(&test_number_of_symbol)
        );
        assert_eq!(after.counts, before.counts);
        let mut uses = vec![0; after.instructions.len()];
        for (k, op) in after.instructions.iter().enumerate() {
            op.visit_operands(|o| {
                if let Operand::Value(a) = o {
                    assert!(a < k, "{a} is used by {k}");
                    uses[a] += 1;
                }
            });
        }
        for output in &after.outputs {
            if let Operand::Value(a) = output {
                uses[*a] += 1;
            }
        }
        assert_eq!(after.uses, uses);
    }

    #[test]
    fn longest_dependency_chain_is_scheduled_first() {
        let g = Graph::new();
        let index_of_division = |program: &crate::lower::Program| {
            program.instructions.iter().position(|op| matches!(op, Op::Div(..))).expect("there is a quotient")
        };
        let program = lower(&long_operation_chains(&g)).run_passes(PART);
        assert!(index_of_division(&program) > 8, "the quotient comes after the other chain");
        assert!(
            index_of_division(&program.schedule_instructions()) < 6,
            "the quotient begins the longest chain"
        );
    }
}
