//! Reordering of sums so that more products fuse. A sum of two products takes a product and a fused
//! instruction. If it is then added to another value, as in `a + (b c + d e)`, the order `(a + b c) + d e`
//! saves an instruction. The numbers of multiplications and additions stay the same. The sum keeps its order
//! if `a` is computed so late that the sum would wait.

use super::terms::{LONGEST, Sum, Term};
use super::times::InstructionTimes;
use super::{Operand, Program};
use crate::machine::{ADD, MULTIPLY};

impl Program {
    /// Puts the terms of sums in the order in which most products fuse.
    pub(super) fn order_terms_for_fusion(mut self) -> Program {
        // Rewritten additions move to where their sum is used, after all its operands.
        let mut late = vec![false; self.instructions.len()];
        let mut times = InstructionTimes::default();
        for k in 0..self.instructions.len() {
            let before = times.instruction_finish_time(&self, k);
            times.known.push(before);
            let Some((sum, ops)) =
                self.sum_to_reorder(k).and_then(|sum| sum.operations_adding_terms().map(|ops| (sum, ops)))
            else {
                continue;
            };
            let time = times.time_of_ordered_sum(&self, &sum.terms);
            // One instruction less is worth the longer latency of a fused addition for each term.
            if time > before + (MULTIPLY - ADD) * sum.terms.len() as u32 {
                continue;
            }
            times.known[k] = time;
            for (at, op) in sum.additions.iter().zip(ops) {
                self.instructions[*at] = op;
                late[*at] = *at != k;
            }
        }
        let program = if late.contains(&true) { self.sort_instructions(&late) } else { self };
        program.move_products_next_to_sums()
    }

    /// Returns the sum that ends with instruction `k`, if another order of its terms saves an instruction.
    fn sum_to_reorder(&self, k: usize) -> Option<Sum> {
        let ends = self.instructions[k].addition_terms()?;
        // With a product among its terms the last addition is fused already.
        if ends.iter().any(|t| self.is_fusable_product(*t)) {
            return None;
        }
        let sum_starting_with_end = |from: usize| {
            let mut sum = Sum { additions: vec![k], terms: Vec::new() };
            self.collect_terms(ends[1 - from], &mut sum).then(|| {
                sum.additions.reverse();
                sum.terms.push(ends[from]);
                sum.terms.reverse();
                sum
            })
        };
        sum_starting_with_end(0).or_else(|| sum_starting_with_end(1))
    }

    /// Collects the terms of a sum from the last to the first, which must be a product; returns false if it
    /// is not, or if the sum is too long.
    fn collect_terms(&self, top: Term, sum: &mut Sum) -> bool {
        let Some(terms) =
            self.terms_of_single_use_addition(top.operand).filter(|_| sum.additions.len() < LONGEST)
        else {
            return false;
        };
        let mut terms = terms.map(|t| t.multiplied_by_sum_sign(top.negative));
        sum.additions.push(top.operand.instruction_index());
        let products = terms.map(|t| self.is_fusable_product(t));
        match products {
            [true, true] => {
                // The product that is computed first comes first.
                if terms[0].operand.instruction_index() > terms[1].operand.instruction_index() {
                    terms.swap(0, 1);
                }
                sum.terms.extend([terms[1], terms[0]]);
                true
            }
            [true, false] | [false, true] => {
                let rest = usize::from(products[0]);
                sum.terms.push(terms[1 - rest]);
                self.collect_terms(terms[rest], sum)
            }
            [false, false] => [0, 1].into_iter().any(|rest| {
                let before = (sum.additions.len(), sum.terms.len());
                sum.terms.push(terms[1 - rest]);
                let found = self.collect_terms(terms[rest], sum);
                if !found {
                    sum.additions.truncate(before.0);
                    sum.terms.truncate(before.1);
                }
                found
            }),
        }
    }

    /// Returns true for a product whose only use is this term.
    fn is_fusable_product(&self, term: Term) -> bool {
        self.factors_of_single_use_product(term.operand).is_some()
    }

    /// Sorts the instructions so that operands precede operations; `late` instructions come right before
    /// their first use.
    fn sort_instructions(self, late: &[bool]) -> Program {
        let n = self.instructions.len();
        let mut is_placed = vec![false; n];
        let mut order = Vec::with_capacity(n);
        let mut todo = Vec::new();
        for k in (0..n).filter(|k| !late[*k]) {
            todo.push(k);
            while let Some(&top) = todo.last() {
                let before = todo.len();
                self.instructions[top].visit_operands(|o| match o {
                    Operand::Value(a) if !is_placed[a] => todo.push(a),
                    _ => {}
                });
                if todo.len() == before {
                    todo.pop();
                    if !std::mem::replace(&mut is_placed[top], true) {
                        order.push(top);
                    }
                }
            }
        }
        self.reorder_instructions(&order)
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Symbol};
    use crate::lower::lower;
    use crate::lower::pipeline::PART;

    /// Sums of tens of thousands of terms with two products at the beginning or at the end, on the small
    /// stack of a test thread.
    #[test]
    fn long_sums_do_not_overflow_the_stack() {
        let g = Graph::new();
        let symbols: Vec<_> = (0..40_000).map(|k| g.symbol(Symbol(k))).collect();
        let products = symbols[0] * symbols[1] + symbols[2] * symbols[3];
        let rest = symbols[5..].iter().fold(symbols[4], |sum, s| sum + *s);
        let first = symbols[4..].iter().fold(products, |sum, s| sum + *s);
        for (sum, fused) in [(first, 2), (rest + products, 1)] {
            let program = lower(&[sum]).run_passes(PART);
            assert_eq!(program.instructions.len() + fused, program.counts.total_operations());
            // Each of 0, 1, … 7 occurs equally often; 0 · 1 + 2 · 3 equals 0 + 1 + 2 + 3.
            assert_eq!(program.interpret_program(&|s| f64::from(s.0 % 8)), [140_000.0]);
        }
    }
}
