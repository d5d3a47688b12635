//! Sums that keep others waiting, put in the order in which their terms become known. The longest chain of a program goes
//! through sums, and where a term that is known late is added first, all others are added while nothing else goes on. The
//! numbers of multiplications and additions stay the same.
//!
//! Sums that nothing waits for stay as they are: what is added early waits in a register until the last term comes.

use super::terms::{LONGEST, Sum};
use super::times::{Times, latency};
use super::{Operand, Program};
use crate::machine::MULTIPLY;

impl Program {
    /// Puts the terms of sums on the longest chain in the order in which they become known.
    pub(super) fn with_late_terms_last(mut self) -> Program {
        let sums = self.sums();
        let lanes = self.lanes();
        let is_wide = |o: Operand| match o {
            Operand::Value(a) => lanes[a] > 1,
            Operand::Tuple(_) | Operand::Gather(_) => true,
            _ => false,
        };
        let mut times = Times::default();
        let mut ordered: Vec<Option<Sum>> = Vec::with_capacity(sums.len());
        for (k, sum) in sums.into_iter().enumerate() {
            let before = times.of(&self, k);
            let sum = sum.map(|sum| times.ordered(&self, sum, &is_wide));
            let sum =
                sum.map(|sum| (times.chain(&self, &sum.terms), sum)).filter(|(time, _)| *time <= before);
            let (time, sum) = sum.map_or((before, None), |(time, sum)| (time, Some(sum)));
            times.known.push(time);
            ordered.push(sum);
        }
        let end = times.known.iter().copied().max().unwrap_or(0);
        let rest = self.rest_in_order(&ordered);
        // Rewritten additions stand where their sum is used, since they need all that it does.
        let mut late = vec![false; self.instructions.len()];
        let mut rewritten = Vec::new();
        times.known.clear();
        for (k, sum) in ordered.iter().enumerate() {
            let before = times.of(&self, k);
            times.known.push(before);
            let Some(sum) = sum.as_ref().filter(|_| before + rest[k] > end) else { continue };
            let time = times.chain(&self, &sum.terms);
            let Some(ops) = sum.chain().filter(|_| time <= before) else { continue };
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
        self.placed(&late)
    }

    /// By instruction: the sum of three terms or more that ends with it.
    fn sums(&self) -> Vec<Option<Sum>> {
        let mut sums: Vec<Option<Sum>> = self.instructions.iter().map(|_| None).collect();
        let mut inside = vec![false; self.instructions.len()];
        for k in (0..self.instructions.len()).rev() {
            let Some(ends) = self.instructions[k].terms().filter(|_| !inside[k]) else { continue };
            let mut sum = Sum { additions: vec![k], terms: Vec::new() };
            let mut todo = ends.to_vec();
            while let Some(term) = todo.pop() {
                let inner = self.lone_addition(term.operand);
                match inner.filter(|_| sum.terms.len() + todo.len() < LONGEST) {
                    Some(inner) => {
                        sum.additions.push(term.operand.number());
                        inside[term.operand.number()] = true;
                        todo.extend(inner.map(|t| t.within(term.negative)));
                    }
                    None => sum.terms.push(term),
                }
            }
            sum.additions.sort_unstable();
            sums[k] = Some(sum).filter(|sum| sum.terms.len() > 2);
        }
        sums
    }

    /// The same instructions with operands before operations, those that are `late` as soon as their operands are there.
    fn placed(self, late: &[bool]) -> Program {
        let n = self.instructions.len();
        let mut users = vec![Vec::new(); n];
        let mut missing = vec![0; n];
        for k in (0..n).filter(|k| late[*k]) {
            self.instructions[k].operands(|o| {
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
        self.reordered(&order)
    }
}

impl Times {
    /// The sum with its terms as they become known, those that have no lanes before those that do, and one that is no product
    /// among the first two.
    fn ordered(&self, program: &Program, mut sum: Sum, is_wide: &dyn Fn(Operand) -> bool) -> Sum {
        sum.terms
            .sort_by_key(|term| (is_wide(term.operand), self.term(program, *term).0, term.operand.number()));
        let single = sum.terms.iter().position(|term| !self.term(program, *term).1);
        if let Some(k) = single.filter(|k| *k > 1) {
            sum.terms[..=k].rotate_right(1);
        }
        sum
    }
}

impl Program {
    /// By instruction: how long after it the last of what hangs on it is known, with its sums in order.
    fn rest_in_order(&self, sums: &[Option<Sum>]) -> Vec<u32> {
        let mut rest = vec![0; self.instructions.len()];
        let mut is_part = vec![false; self.instructions.len()];
        let raise = |rest: &mut Vec<u32>, o: Operand, to: u32| {
            if let Operand::Value(a) = o {
                rest[a] = rest[a].max(to);
            }
        };
        for k in (0..self.instructions.len()).rev() {
            if is_part[k] {
                continue;
            }
            let op = &self.instructions[k];
            let pair = op.terms();
            let terms = match (&sums[k], &pair) {
                (Some(sum), _) => {
                    sum.additions.iter().for_each(|a| is_part[*a] = true);
                    sum.terms.as_slice()
                }
                (None, Some(pair)) => pair.as_slice(),
                (None, None) => {
                    let time = rest[k] + latency(op);
                    op.operands(|o| raise(&mut rest, o, time));
                    continue;
                }
            };
            let mut time = rest[k];
            for (place, term) in terms.iter().enumerate().rev() {
                // The first two are added by one addition.
                if place > 0 {
                    time += MULTIPLY;
                }
                match self.lone_product(term.operand) {
                    Some((a, b)) => {
                        is_part[term.operand.number()] = true;
                        raise(&mut rest, a, time);
                        raise(&mut rest, b, time);
                    }
                    None => raise(&mut rest, term.operand, time),
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

    /// A term that is known late, and some that are known at once.
    #[test]
    fn what_is_known_late_is_added_last() {
        let g = Graph::new();
        let x: Vec<_> = (0..12).map(|k| g.symbol(Symbol(k))).collect();
        let late = (0..6).fold(x[0], |e, _| e * e / x[1]);
        let sum = late * x[2] + x[3] * x[4] - x[5] * x[6] + x[7] + x[8] * x[9];
        let program = lower(&[sum]);
        let before = program.counts;
        let fused = program.with_late_terms_last().with_fused_products();
        assert_eq!(fused.counts, before);
        // Six quotients of squares, and four additions, of which the last has the late product fused into it.
        assert_eq!(fused.instructions.len(), 12 + 4);
        let symbol = |s: Symbol| 1.0 + 0.1 * f64::from(s.0);
        let value = |k: u32| symbol(Symbol(k));
        let expected = {
            let late = (0..6).fold(value(0), |e, _| e * e / value(1));
            late * value(2) + value(3) * value(4) - value(5) * value(6) + value(7) + value(8) * value(9)
        };
        assert!((fused.run(&symbol)[0] - expected).abs() < 1e-14);
        assert_eq!(fused.time(), 16 + 6 * (4 + 13) + 4);
    }
}
