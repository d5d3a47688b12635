//! Sums that keep others waiting, put in the order in which their terms become known. The longest chain of a program goes
//! through sums, and where a term that is known late is added first, all others are added while nothing else goes on. The
//! numbers of multiplications and additions stay the same.
//!
//! Sums that nothing waits for stay as they are: what is added early waits in a register until the last term comes.

use super::schedule::{CYCLE, latency};
use super::terms::{LONGEST, Sum, Term};
use super::{Op, Operand, Program};

/// How long sines and cosines take: all of them are evaluated at the beginning.
const WAVE: u32 = 60 * CYCLE;
/// How long an addition takes, and one with a product that fuses.
const ADDED: u32 = 3 * CYCLE;
const FUSED: u32 = 4 * CYCLE;

/// When the values of instructions are known at the earliest, in thirds of a cycle, if products fuse.
struct Times<'a> {
    program: &'a Program,
    known: Vec<u32>,
}

impl Program {
    /// The same program, its products fused into sums as before, with its sums in order; and so what it has in lanes.
    #[must_use]
    pub fn with_late_terms_last(mut self) -> Program {
        self.in_lanes = self.in_lanes.map(|program| Box::new(program.with_late_terms_last()));
        match self.unfused().in_order() {
            Some(program) => {
                let program = program.with_fused_products();
                Program { in_lanes: self.in_lanes, counts: self.counts, ..program }
            }
            None => self,
        }
    }

    /// The same with products and sums apart. `None` if nothing changes.
    fn in_order(mut self) -> Option<Program> {
        let sums = self.sums();
        let lanes = self.lanes();
        let is_wide = |o: Operand| match o {
            Operand::Value(a) => lanes[a] > 1,
            Operand::Tuple(_) | Operand::Gather(_) => true,
            _ => false,
        };
        let mut times = Times { program: &self, known: Vec::with_capacity(self.instructions.len()) };
        let mut ordered: Vec<Option<Sum>> = Vec::with_capacity(sums.len());
        for (k, sum) in sums.into_iter().enumerate() {
            let before = times.of(k);
            let sum = sum.map(|sum| times.ordered(sum, &is_wide));
            let sum = sum.map(|sum| (times.chain(&sum.terms), sum)).filter(|(time, _)| *time <= before);
            let (time, sum) = sum.map_or((before, None), |(time, sum)| (time, Some(sum)));
            times.known.push(time);
            ordered.push(sum);
        }
        let end = times.known.iter().copied().max().unwrap_or(0);
        let rest = times.rest(&ordered);
        // Rewritten additions stand where their sum is used, since they need all that it does.
        let mut late = vec![false; self.instructions.len()];
        let mut rewritten = Vec::new();
        times.known.clear();
        for (k, sum) in ordered.iter().enumerate() {
            let before = times.of(k);
            times.known.push(before);
            let Some(sum) = sum.as_ref().filter(|_| before + rest[k] > end) else { continue };
            let time = times.chain(&sum.terms);
            let Some(ops) = sum.chain().filter(|_| time <= before) else { continue };
            times.known[k] = time;
            for (at, op) in sum.additions.iter().zip(ops) {
                rewritten.push((*at, op));
                late[*at] = *at != k;
            }
        }
        for (at, op) in rewritten {
            self.instructions[at] = op;
        }
        late.contains(&true).then(|| self.placed(&late))
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

impl Times<'_> {
    fn value(&self, o: Operand) -> u32 {
        match o {
            Operand::Value(k) => self.known.get(k).copied().unwrap_or(0),
            _ => 0,
        }
    }

    /// That of instruction `k`.
    fn of(&self, k: usize) -> u32 {
        let op = &self.program.instructions[k];
        if let Some([a, b]) = op.terms() {
            return self.chain(&[a, b]);
        }
        let mut start = 0;
        op.operands(|o| start = start.max(self.value(o)));
        start + if matches!(op, Op::Call(..)) { WAVE } else { latency(op) }
    }

    /// When a term can be added, and whether it is a product that fuses: that can be as soon as its factors are known.
    fn term(&self, term: Term) -> (u32, bool) {
        match self.program.lone_product(term.operand) {
            Some((a, b)) => (self.value(a).max(self.value(b)), true),
            None => (self.value(term.operand), false),
        }
    }

    /// When terms have been added one after another.
    fn chain(&self, terms: &[Term]) -> u32 {
        let mut times = terms.iter().map(|term| self.term(*term));
        let (Some(first), Some(second)) = (times.next(), times.next()) else { return 0 };
        let start = match (first, second) {
            // Of two products the earlier is one.
            ((a, true), (b, true)) => (a.min(b) + FUSED).max(a.max(b)) + FUSED,
            ((a, false), (b, false)) => a.max(b) + ADDED,
            ((a, _), (b, _)) => a.max(b) + FUSED,
        };
        times.fold(start, |sum, (time, fuses)| sum.max(time) + if fuses { FUSED } else { ADDED })
    }

    /// The sum with its terms as they become known, those that have no lanes before those that do, and one that is no product
    /// among the first two.
    fn ordered(&self, mut sum: Sum, is_wide: &dyn Fn(Operand) -> bool) -> Sum {
        sum.terms.sort_by_key(|term| (is_wide(term.operand), self.term(*term).0, term.operand.number()));
        let single = sum.terms.iter().position(|term| !self.term(*term).1);
        if let Some(k) = single.filter(|k| *k > 1) {
            sum.terms[..=k].rotate_right(1);
        }
        sum
    }

    /// By instruction: how long after it the last of what hangs on it is known, with its sums in order.
    fn rest(&self, sums: &[Option<Sum>]) -> Vec<u32> {
        let program = self.program;
        let mut rest = vec![0; program.instructions.len()];
        let mut is_part = vec![false; program.instructions.len()];
        let raise = |rest: &mut Vec<u32>, o: Operand, to: u32| {
            if let Operand::Value(a) = o {
                rest[a] = rest[a].max(to);
            }
        };
        for k in (0..program.instructions.len()).rev() {
            if is_part[k] {
                continue;
            }
            let op = &program.instructions[k];
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
                    time += FUSED;
                }
                match program.lone_product(term.operand) {
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
        let fused = program.fused().with_late_terms_last();
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
