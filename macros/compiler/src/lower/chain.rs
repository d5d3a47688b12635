//! Sums put in the order in which their products fuse. A sum of two products is a product and a fused one; where it is
//! added to something else by an addition of its own, as in `a + (b c + d e)`, beginning with that saves an instruction:
//! `(a + b c) + d e`. The numbers of multiplications and additions stay the same. Where `a` is known too late, the sum
//! would have to wait for it: then it stays as it is.

use super::terms::{LONGEST, Sum, Term};
use super::times::Times;
use super::{Operand, Program};
use crate::machine::{ADD, MULTIPLY};

impl Program {
    /// Puts the terms of sums in the order in which most products fuse.
    pub(super) fn chained(mut self) -> Program {
        // Rewritten additions stand where their sum is used, since they need all that it does.
        let mut late = vec![false; self.instructions.len()];
        let mut times = Times::default();
        for k in 0..self.instructions.len() {
            let before = times.of(&self, k);
            times.known.push(before);
            let Some((sum, ops)) = self.sum_to_chain(k).and_then(|sum| sum.chain().map(|ops| (sum, ops)))
            else {
                continue;
            };
            let time = times.chain(&self, &sum.terms);
            // An instruction less is worth that each term may take as much longer as an addition with a product does.
            if time > before + (MULTIPLY - ADD) * sum.terms.len() as u32 {
                continue;
            }
            times.known[k] = time;
            for (at, op) in sum.additions.iter().zip(ops) {
                self.instructions[*at] = op;
                late[*at] = *at != k;
            }
        }
        let program = if late.contains(&true) { self.sorted(&late) } else { self };
        program.with_products_at_their_sums()
    }

    /// The sum that ends with instruction `k`, if another order of its terms saves an instruction.
    fn sum_to_chain(&self, k: usize) -> Option<Sum> {
        let ends = self.instructions[k].terms()?;
        // With a product among its terms it is fused as it stands.
        if ends.iter().any(|t| self.fuses(*t)) {
            return None;
        }
        let joined = |from: usize| {
            let mut sum = Sum { additions: vec![k], terms: Vec::new() };
            self.descend(ends[1 - from], &mut sum).then(|| {
                sum.additions.reverse();
                sum.terms.push(ends[from]);
                sum.terms.reverse();
                sum
            })
        };
        joined(0).or_else(|| joined(1))
    }

    /// Collects the terms of a sum from the last to the first, which is a product; false if it is none or too long.
    fn descend(&self, top: Term, sum: &mut Sum) -> bool {
        let Some(terms) = self.lone_addition(top.operand).filter(|_| sum.additions.len() < LONGEST) else {
            return false;
        };
        let mut terms = terms.map(|t| t.within(top.negative));
        sum.additions.push(top.operand.number());
        let products = terms.map(|t| self.fuses(t));
        match products {
            [true, true] => {
                // The earlier one is there first.
                if terms[0].operand.number() > terms[1].operand.number() {
                    terms.swap(0, 1);
                }
                sum.terms.extend([terms[1], terms[0]]);
                true
            }
            [true, false] | [false, true] => {
                let rest = usize::from(products[0]);
                sum.terms.push(terms[1 - rest]);
                self.descend(terms[rest], sum)
            }
            [false, false] => [0, 1].into_iter().any(|rest| {
                let before = (sum.additions.len(), sum.terms.len());
                sum.terms.push(terms[1 - rest]);
                let found = self.descend(terms[rest], sum);
                if !found {
                    sum.additions.truncate(before.0);
                    sum.terms.truncate(before.1);
                }
                found
            }),
        }
    }

    /// True for a product whose only use is here.
    fn fuses(&self, term: Term) -> bool {
        self.lone_product(term.operand).is_some()
    }

    /// The same instructions with operands before operations, those that are `late` not before they are needed.
    fn sorted(self, late: &[bool]) -> Program {
        let n = self.instructions.len();
        let mut is_placed = vec![false; n];
        let mut order = Vec::with_capacity(n);
        let mut todo = Vec::new();
        for k in (0..n).filter(|k| !late[*k]) {
            todo.push(k);
            while let Some(&top) = todo.last() {
                let before = todo.len();
                self.instructions[top].operands(|o| match o {
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
        self.reordered(&order)
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Symbol};
    use crate::lower::lower;
    use crate::lower::pipeline::PART;

    /// Tens of thousands of terms, of which two products come first or last, with the small stack of a test's thread.
    #[test]
    fn long_sums_need_no_stack() {
        let g = Graph::new();
        let symbols: Vec<_> = (0..40_000).map(|k| g.symbol(Symbol(k))).collect();
        let products = symbols[0] * symbols[1] + symbols[2] * symbols[3];
        let rest = symbols[5..].iter().fold(symbols[4], |sum, s| sum + *s);
        let first = symbols[4..].iter().fold(products, |sum, s| sum + *s);
        for (sum, fused) in [(first, 2), (rest + products, 1)] {
            let program = lower(&[sum]).through(PART);
            assert_eq!(program.instructions.len() + fused, program.counts.total());
            // As many of each of 0, 1, … 7, where 0 · 1 + 2 · 3 stands for the sum of the four.
            assert_eq!(program.run(&|s| f64::from(s.0 % 8)), [140_000.0]);
        }
    }
}
