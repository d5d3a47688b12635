//! Sums that have terms in common. All sums of a program are written out, as far as they are short, so that what
//! cancels goes and constants meet; then the two terms that most of them share become a sum of their own, again and
//! again (the greedy elimination of common subexpressions of linear systems, as for digital filters: Hartley 1996).
//! What comes of it is kept if it takes fewer instructions.

use super::{Op, Operand, Program};
use std::collections::BTreeMap;

/// Largest program that is looked at, in instructions.
const MOST_INSTRUCTIONS: usize = 3000;
/// Longest sum that is written out.
const MOST_TERMS: usize = 8;
/// Up to how many terms a sum is written out in another: each is tried.
const SHORT: [usize; 4] = [1, 2, 3, 5];

/// What is summed: the number 1, a value that is no sum, or a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Key {
    One,
    Atom(usize),
    Sum(usize),
}

/// Terms with their coefficients, by key.
type Terms = Vec<(Key, f64)>;

/// The sums of a program.
struct Sums {
    atoms: Vec<Operand>,
    sums: Vec<Terms>,
    /// By instruction: the sum that it ends.
    ends: Vec<Option<usize>>,
}

impl Program {
    /// The same program, its products fused into sums as before, with the terms that its sums have in common summed once.
    pub fn with_shared_sums(mut self) -> Program {
        self.in_lanes = self.in_lanes.map(|program| Box::new(program.with_shared_sums()));
        if self.instructions.len() > MOST_INSTRUCTIONS {
            return self;
        }
        let plain = self.unfused();
        for short in SHORT {
            let mut sums = Sums::of(&plain);
            sums.write_out(short);
            sums.share();
            let mut program = plain.with_sums(&sums);
            program.counts = program.count();
            let program = program.fused();
            let cost = |p: &Program| (p.instructions.len(), p.counts.total());
            if cost(&program) < cost(&self) && program.counts.total() <= self.counts.total() {
                self = Program { in_lanes: self.in_lanes, ..program };
            }
        }
        self
    }

    /// The same program with products and sums apart.
    fn unfused(&self) -> Program {
        let mut program = Program {
            outputs: Vec::new(),
            tuples: self.tuples.clone(),
            gathers: self.gathers.clone(),
            ..Program::default()
        };
        let mut values = Vec::with_capacity(self.instructions.len());
        for op in &self.instructions {
            let op = op.mapped(|o| placed(o, &values));
            let mut product = |a, b| {
                program.instructions.push(Op::Mul(a, b));
                Operand::Value(program.instructions.len() - 1)
            };
            let op = match op {
                Op::MulAdd(a, b, c) => Op::Add(product(a, b), c),
                Op::MulSub(a, b, c) => Op::Sub(product(a, b), c),
                Op::NegMulAdd(a, b, c) => Op::Sub(c, product(a, b)),
                op => op,
            };
            program.instructions.push(op);
            values.push(Operand::Value(program.instructions.len() - 1));
        }
        program.outputs = self.outputs.iter().map(|o| placed(*o, &values)).collect();
        program.sweep();
        program
    }

    /// The same program with other sums.
    fn with_sums(&self, sums: &Sums) -> Program {
        let mut out = Writer {
            sums,
            instructions: Vec::new(),
            values: Vec::new(),
            written: vec![None; sums.sums.len()],
        };
        for (k, op) in self.instructions.iter().enumerate() {
            let value = match sums.ends[k] {
                Some(sum) => out.sum(sum),
                None => {
                    let values = &out.values;
                    let op = op.mapped(|o| placed(o, values));
                    out.push(op)
                }
            };
            out.values.push(value);
        }
        let outputs = self.outputs.iter().map(|o| placed(*o, &out.values)).collect();
        let mut program = Program {
            instructions: out.instructions,
            outputs,
            tuples: self.tuples.clone(),
            gathers: self.gathers.clone(),
            ..Program::default()
        };
        program.sweep();
        program
    }
}

impl Sums {
    fn of(program: &Program) -> Sums {
        let n = program.instructions.len();
        let mut sums = Sums { atoms: Vec::new(), sums: Vec::new(), ends: vec![None; n] };
        let mut known: BTreeMap<(u8, u64), usize> = BTreeMap::new();
        for (k, op) in program.instructions.iter().enumerate() {
            let signed = match *op {
                Op::Add(a, b) => [(a, 1.0), (b, 1.0)],
                Op::Sub(a, b) => [(a, 1.0), (b, -1.0)],
                _ => continue,
            };
            let mut terms = Terms::new();
            for (o, sign) in signed {
                let key = match o {
                    Operand::Const(c) => {
                        add(&mut terms, Key::One, sign * c);
                        continue;
                    }
                    // A sum that is used here alone is a part of this one.
                    Operand::Value(a) => match sums.ends[a] {
                        Some(sum) if program.uses[a] == 1 => {
                            let inner = std::mem::take(&mut sums.sums[sum]);
                            inner.iter().for_each(|(key, c)| add(&mut terms, *key, sign * c));
                            continue;
                        }
                        Some(sum) => Key::Sum(sum),
                        None => sums.atom(o, &mut known),
                    },
                    _ => sums.atom(o, &mut known),
                };
                add(&mut terms, key, sign);
            }
            sums.ends[k] = Some(sums.sums.len());
            sums.sums.push(terms);
        }
        sums
    }

    fn atom(&mut self, o: Operand, known: &mut BTreeMap<(u8, u64), usize>) -> Key {
        let name = match o {
            Operand::Const(c) => (0, c.to_bits()),
            Operand::Symbol(s) => (1, s.0.into()),
            Operand::Value(k) => (2, k as u64),
            Operand::Tuple(k) => (3, k as u64),
            Operand::Gather(k) => (4, k as u64),
        };
        let atoms = &mut self.atoms;
        Key::Atom(*known.entry(name).or_insert_with(|| {
            atoms.push(o);
            atoms.len() - 1
        }))
    }

    /// Writes sums of up to so many terms out where they are terms of others.
    fn write_out(&mut self, short: usize) {
        for k in 0..self.sums.len() {
            let mut terms = Terms::new();
            for (key, c) in &self.sums[k] {
                match *key {
                    Key::Sum(inner) if self.sums[inner].len() <= short => {
                        self.sums[inner].iter().for_each(|(key, d)| add(&mut terms, *key, c * d));
                    }
                    key => add(&mut terms, key, *c),
                }
            }
            if terms.len() <= MOST_TERMS && !terms.is_empty() && terms.iter().any(|(_, c)| *c > 0.0) {
                self.sums[k] = terms;
            }
        }
    }

    /// Makes sums of the pairs of terms that are shared most.
    fn share(&mut self) {
        let mut pairs: BTreeMap<Pair, Vec<usize>> = BTreeMap::new();
        for (k, terms) in self.sums.iter().enumerate() {
            for pair in pairs_of(terms) {
                pairs.entry(pair).or_default().push(k);
            }
        }
        // Pairs once shared, so that what is new is looked for among what it can be in.
        let mut shared: Vec<Pair> =
            pairs.iter().filter(|(_, list)| list.len() > 1).map(|(p, _)| *p).collect();
        shared.sort_unstable();
        while let Some(at) = most_shared(&shared, &pairs) {
            let pair = shared[at];
            let list = pairs.remove(&pair).unwrap_or_default();
            shared.swap_remove(at);
            let new = Key::Sum(self.sums.len());
            self.sums.push(pair.terms());
            for k in list {
                let terms = &mut self.sums[k];
                for old in pairs_of(terms) {
                    if let Some(list) = pairs.get_mut(&old) {
                        list.retain(|other| *other != k);
                    }
                }
                let Some(at) = terms.iter().position(|(key, _)| *key == pair.first) else { continue };
                let c = terms[at].1;
                terms.retain(|(key, _)| *key != pair.first && *key != pair.second);
                terms.push((new, c));
                for next in pairs_of(terms) {
                    let list = pairs.entry(next).or_default();
                    list.push(k);
                    if list.len() == 2 && !shared.contains(&next) {
                        shared.push(next);
                    }
                }
            }
        }
    }
}

/// Two keys and the ratio of their coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Pair {
    first: Key,
    second: Key,
    ratio: u64,
}

impl Pair {
    fn terms(self) -> Terms {
        vec![(self.first, 1.0), (self.second, f64::from_bits(self.ratio))]
    }
}

fn pairs_of(terms: &Terms) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (i, a) in terms.iter().enumerate() {
        for b in &terms[i + 1..] {
            // The number comes second: a sum begins with a value.
            let (a, b) = if a.0 == Key::One || (b.0 != Key::One && b.0 < a.0) { (b, a) } else { (a, b) };
            pairs.push(Pair { first: a.0, second: b.0, ratio: (b.1 / a.1).to_bits() });
        }
    }
    pairs
}

/// Where the pair is that most sums share, of equals the first in order; none if no two do.
fn most_shared(shared: &[Pair], pairs: &BTreeMap<Pair, Vec<usize>>) -> Option<usize> {
    let count = |pair: &Pair| pairs.get(pair).map_or(0, Vec::len);
    let all = shared.iter().enumerate().filter(|(_, pair)| count(pair) > 1);
    all.max_by_key(|(_, pair)| (count(pair), std::cmp::Reverse(**pair))).map(|(at, _)| at)
}

fn add(terms: &mut Terms, key: Key, c: f64) {
    match terms.iter_mut().find(|(other, _)| *other == key) {
        Some((_, sum)) => *sum += c,
        None => terms.push((key, c)),
    }
    terms.retain(|(_, c)| *c != 0.0);
}

/// A program with other sums, as far as it is written.
struct Writer<'a> {
    sums: &'a Sums,
    instructions: Vec<Op>,
    /// By instruction of the first program.
    values: Vec<Operand>,
    /// By sum.
    written: Vec<Option<Operand>>,
}

impl Writer<'_> {
    fn push(&mut self, op: Op) -> Operand {
        self.instructions.push(op);
        Operand::Value(self.instructions.len() - 1)
    }

    /// The value of a sum, written where it is first wanted.
    fn sum(&mut self, k: usize) -> Operand {
        // Without recursion: sums may be nested deeply.
        let mut todo = vec![k];
        while let Some(&top) = todo.last() {
            let inner = self.sums.sums[top].iter().filter_map(|(key, _)| match key {
                Key::Sum(s) if self.written[*s].is_none() => Some(*s),
                _ => None,
            });
            let before = todo.len();
            let inner: Vec<usize> = inner.collect();
            todo.extend(inner);
            if todo.len() == before {
                todo.pop();
                if self.written[top].is_none() {
                    self.written[top] = Some(self.written_out(top));
                }
            }
        }
        self.written[k].unwrap_or(Operand::Const(0.0))
    }

    fn written_out(&mut self, k: usize) -> Operand {
        let mut terms: Vec<(Operand, f64)> = Vec::new();
        for (key, c) in &self.sums.sums[k] {
            terms.push(match *key {
                Key::One => (Operand::Const(c.abs()), c.signum()),
                Key::Atom(a) => (placed(self.sums.atoms[a], &self.values), *c),
                Key::Sum(s) => (self.written[s].unwrap_or(Operand::Const(0.0)), *c),
            });
        }
        // What is there first comes first, but not a negative one if there is another.
        terms.sort_by_key(|(o, c)| (*c < 0.0, number(*o)));
        let mut sum: Option<Operand> = None;
        for (o, c) in terms {
            let size = c.abs();
            let term = if size == 1.0 { o } else { self.push(Op::Mul(Operand::Const(size), o)) };
            sum = Some(match (sum, c < 0.0) {
                (None, false) => term,
                (None, true) => self.push(Op::Neg(term)),
                (Some(sum), false) => self.push(Op::Add(sum, term)),
                (Some(sum), true) => self.push(Op::Sub(sum, term)),
            });
        }
        sum.unwrap_or(Operand::Const(0.0))
    }
}

fn placed(o: Operand, values: &[Operand]) -> Operand {
    match o {
        Operand::Value(k) => values[k],
        other => other,
    }
}

fn number(o: Operand) -> usize {
    match o {
        Operand::Value(k) => k,
        _ => 0,
    }
}
