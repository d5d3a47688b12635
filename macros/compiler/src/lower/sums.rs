//! Sums that have terms in common. All sums of a program are written out, as far as they are short, so that what
//! cancels goes and constants meet; then the two terms that most of them share become a sum of their own, again and
//! again (the greedy elimination of common subexpressions of linear systems, as for digital filters: Hartley 1996).
//! What comes of it is kept if it takes fewer instructions.

use super::lanes::Lanes;
use super::{Op, Operand, Program};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Largest program that is looked at, in instructions.
const MOST_INSTRUCTIONS: usize = 3000;
/// Most times that sums are shared again where that has helped.
const ROUNDS: usize = 3;
/// Longest sum that is looked at as one: there are as many pairs as half its square.
const LONGEST: usize = 32;
/// Longest sum that is written out.
const MOST_TERMS: usize = 8;
/// Up to how many terms a sum is written out in another, and whether also if products would not fuse into it any more:
/// each is tried.
const SHORT: [(usize, bool); 5] = [(1, true), (2, true), (4, true), (2, false), (4, false)];

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
    /// By atom: a product that is used once.
    lone_products: Vec<bool>,
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
        for _ in 0..ROUNDS {
            if !self.share_sums() {
                break;
            }
        }
        self
    }

    /// Shares sums in the way that takes the fewest instructions; false if all take more than before.
    fn share_sums(&mut self) -> bool {
        let plain = self.unfused();
        let mut better = false;
        for (short, products) in SHORT {
            let mut sums = Sums::of(&plain);
            sums.write_out(short, products);
            sums.share();
            // Sums are as cheap with the opposite sign.
            let mut program = plain.with_sums(&sums).with_cheap_signs();
            program.counts = program.count();
            let program = program.fused();
            let cost = |p: &Program| (p.instructions.len(), p.counts.total());
            if cost(&program) < cost(self) && program.counts.total() <= self.counts.total() {
                *self = Program { in_lanes: self.in_lanes.take(), ..program };
                better = true;
            }
        }
        better
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
            let op = op.mapped(|o| o.among(&values));
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
        program.outputs = self.outputs.iter().map(|o| o.among(&values)).collect();
        program.sweep();
        program
    }

    /// The same program with other sums.
    fn with_sums(&self, sums: &Sums) -> Program {
        let mut out = Writer {
            sums,
            instructions: Vec::new(),
            lanes: Lanes::of_inputs(self),
            values: Vec::new(),
            written: vec![None; sums.sums.len()],
        };
        for (k, op) in self.instructions.iter().enumerate() {
            let value = match sums.ends[k] {
                Some(sum) => out.sum(sum),
                None => {
                    let values = &out.values;
                    // What had lanes may have lost them with the terms that cancel.
                    match op.mapped(|o| o.among(values)) {
                        Op::Lane(_, a) if out.lanes.width(a) == 1 => a,
                        Op::Sum(n, a) => out.push(out.lanes.sum(n, a)),
                        op => out.push(op),
                    }
                }
            };
            out.values.push(value);
        }
        let outputs = self.outputs.iter().map(|o| o.among(&out.values)).collect();
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
        let mut sums =
            Sums { atoms: Vec::new(), lone_products: Vec::new(), sums: Vec::new(), ends: vec![None; n] };
        let mut known: BTreeMap<(u8, u64), usize> = BTreeMap::new();
        for (k, op) in program.instructions.iter().enumerate() {
            let Some(signed) = op.terms() else { continue };
            let mut terms = Terms::new();
            for term in signed {
                let sign = if term.negative { -1.0 } else { 1.0 };
                let key = match term.operand {
                    Operand::Const(c) => {
                        add(&mut terms, Key::One, sign * c);
                        continue;
                    }
                    // A sum that is used here alone is a part of this one.
                    Operand::Value(a) => match sums.ends[a] {
                        Some(sum) if program.uses[a] == 1 && sums.sums[sum].len() + terms.len() < LONGEST => {
                            let inner = std::mem::take(&mut sums.sums[sum]);
                            inner.iter().for_each(|(key, c)| add(&mut terms, *key, sign * c));
                            continue;
                        }
                        Some(sum) => Key::Sum(sum),
                        None => sums.atom(term.operand, &mut known),
                    },
                    o => sums.atom(o, &mut known),
                };
                add(&mut terms, key, sign);
            }
            sums.ends[k] = Some(sums.sums.len());
            sums.sums.push(terms);
        }
        let lone = |o: &Operand| program.lone_product(*o).is_some();
        sums.lone_products = sums.atoms.iter().map(lone).collect();
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
    fn write_out(&mut self, short: usize, products: bool) {
        let fuses = |key: &Key| matches!(key, Key::Atom(a) if self.lone_products[*a]);
        let keeps: Vec<bool> =
            self.sums.iter().map(|terms| !products && terms.iter().any(|(key, _)| fuses(key))).collect();
        for k in 0..self.sums.len() {
            let mut terms = Terms::new();
            for (key, c) in &self.sums[k] {
                match *key {
                    Key::Sum(inner) if self.sums[inner].len() <= short && !keeps[inner] => {
                        self.sums[inner].iter().for_each(|(key, d)| add(&mut terms, *key, c * d));
                    }
                    key => add(&mut terms, key, *c),
                }
            }
            let is_value = |(key, c): &(Key, f64)| *key != Key::One && *c > 0.0;
            if terms.len() <= MOST_TERMS && terms.iter().any(is_value) {
                self.sums[k] = terms;
            }
        }
    }

    /// Makes sums of the pairs of terms that are shared most.
    fn share(&mut self) {
        let mut pairs = Pairs::default();
        for (k, terms) in self.sums.iter().enumerate() {
            pairs_of(terms).for_each(|pair| pairs.add(pair, k));
        }
        while let Some((pair, list)) = pairs.take_most_shared() {
            let new = Key::Sum(self.sums.len());
            self.sums.push(pair.terms());
            for k in list {
                let terms = &mut self.sums[k];
                let Some(c) = terms.iter().find(|(key, _)| *key == pair.first).map(|(_, c)| *c) else {
                    continue;
                };
                let gone = |key: Key| key == pair.first || key == pair.second;
                pairs_of(terms).filter(|p| gone(p.first) || gone(p.second)).for_each(|p| pairs.remove(p, k));
                terms.retain(|(key, _)| !gone(*key));
                terms.push((new, c));
                pairs_of(terms).filter(|p| p.first == new || p.second == new).for_each(|p| pairs.add(p, k));
            }
        }
    }
}

/// Which sums have which pairs of terms.
#[derive(Default)]
struct Pairs {
    lists: BTreeMap<Pair, Vec<usize>>,
    /// Those of several sums, by how many.
    shared: BTreeSet<(usize, Reverse<Pair>)>,
}

impl Pairs {
    fn add(&mut self, pair: Pair, sum: usize) {
        let list = self.lists.entry(pair).or_default();
        list.push(sum);
        let n = list.len();
        self.count(pair, n - 1, n);
    }

    fn remove(&mut self, pair: Pair, sum: usize) {
        let Some(list) = self.lists.get_mut(&pair) else { return };
        let before = list.len();
        list.retain(|other| *other != sum);
        let n = list.len();
        self.count(pair, before, n);
    }

    fn count(&mut self, pair: Pair, before: usize, now: usize) {
        if before > 1 {
            self.shared.remove(&(before, Reverse(pair)));
        }
        if now > 1 {
            self.shared.insert((now, Reverse(pair)));
        }
    }

    /// The pair that most sums share, of equals the first in order, with those; none if no two share one.
    fn take_most_shared(&mut self) -> Option<(Pair, Vec<usize>)> {
        let (_, Reverse(pair)) = self.shared.pop_last()?;
        Some((pair, self.lists.remove(&pair)?))
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

fn pairs_of(terms: &Terms) -> impl Iterator<Item = Pair> {
    let all = terms.iter().enumerate().flat_map(|(i, a)| terms[i + 1..].iter().map(move |b| (a, b)));
    all.map(|(a, b)| {
        // The number comes second: a sum begins with a value.
        let (a, b) = if a.0 == Key::One || (b.0 != Key::One && b.0 < a.0) { (b, a) } else { (a, b) };
        Pair { first: a.0, second: b.0, ratio: (b.1 / a.1).to_bits() }
    })
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
    lanes: Lanes,
    /// By instruction of the first program.
    values: Vec<Operand>,
    /// By sum.
    written: Vec<Option<Operand>>,
}

impl Writer<'_> {
    fn push(&mut self, op: Op) -> Operand {
        self.lanes.push(&op);
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
                Key::Atom(a) => (self.sums.atoms[a].among(&self.values), *c),
                Key::Sum(s) => (self.written[s].unwrap_or(Operand::Const(0.0)), *c),
            });
        }
        // What is there first comes first, but not a negative one if there is another.
        terms.sort_by_key(|(o, c)| (*c < 0.0, o.number()));
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
