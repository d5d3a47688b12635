//! Sharing of terms that several sums have in common. First, short sums are expanded into the sums that
//! contain them, so that terms cancel and constants combine. Then the pair of terms that the most sums share
//! becomes a sum of its own, repeatedly (greedy elimination of common subexpressions of linear systems, as
//! for digital filters: Hartley 1996). The result is used if it has fewer instructions.

use super::lanes::ValueLaneCounts;
use super::{Op, Operand, Program};
use std::collections::BTreeMap;

mod pairs;

use pairs::{SharedPairs, TermPair};

/// Maximum size of a program to which the pass applies, in instructions.
const MOST_INSTRUCTIONS: usize = 3000;
/// Maximum size of a program, in instructions, for which all expansions with the fewest operations are tried.
const EXHAUSTIVE_INSTRUCTIONS: usize = 1000;
/// Maximum number of repetitions of the pass while it shortens the program.
const ROUNDS: usize = 5;
/// Maximum length of a sum into which inner sums are merged. The number of pairs grows as half the square of
/// the length.
const LONGEST: usize = 32;
/// Maximum number of terms of a sum after expansion.
const MOST_TERMS: usize = 8;
/// Expansions of inner sums that are tried: the maximum number of terms, and whether sums are expanded whose
/// products could then no longer be fused.
const SHORT: [(usize, bool); 5] = [(1, true), (2, true), (4, true), (2, false), (4, false)];

/// Term of a sum without its coefficient: the number 1, a value that is not a sum, or a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TermWithoutCoefficient {
    One,
    Atom(usize),
    Sum(usize),
}

impl TermWithoutCoefficient {
    /// Returns the number of a term's key: zero for the number 1, then the values, then the sums.
    fn term_key_index(self) -> u32 {
        match self {
            TermWithoutCoefficient::One => 0,
            TermWithoutCoefficient::Atom(a) => 1 + a as u32,
            TermWithoutCoefficient::Sum(s) => FIRST_SUM | s as u32,
        }
    }
}

/// Number of the first sum, larger than that of any value.
const FIRST_SUM: u32 = 1 << 31;

/// Terms of a sum: keys of the operands with their coefficients.
type Terms = Vec<(TermWithoutCoefficient, f64)>;

/// Sums of a program as lists of terms, for the search of common subsums.
#[derive(Clone)]
struct SumTable {
    /// Operands that are not sums themselves.
    atoms: Vec<Operand>,
    /// True for each atom that is a product with a single use.
    lone_products: Vec<bool>,
    /// Terms of each sum of the program.
    sums: Vec<Terms>,
    /// Index of the sum that ends with each instruction.
    ends: Vec<Option<usize>>,
    /// Indices of the sums whose values instructions or outputs use.
    wanted: Vec<usize>,
}

impl Program {
    /// Computes terms that several sums have in common only once.
    pub(super) fn with_shared_sums(mut self) -> Program {
        let mut length = self.instruction_count_after_fusion();
        for _ in 0..=ROUNDS {
            if length > MOST_INSTRUCTIONS {
                break;
            }
            let Some((shorter, program)) = self.program_with_shared_sums(length) else { break };
            (length, self) = (shorter, program);
        }
        self
    }

    /// Returns a program with shared sums and its length after fusing: for a small program the best one,
    /// otherwise the first improvement. Returns `None` if none is shorter than `length`.
    fn program_with_shared_sums(&self, length: usize) -> Option<(usize, Program)> {
        let all = SumTable::from_program(self);
        let is_small = self.instructions.len() <= EXHAUSTIVE_INSTRUCTIONS;
        let mut cost = (length, self.counts.total_operations());
        let mut best: Option<(usize, Program)> = None;
        let mut fewest = all.operation_count();
        let mut tried: Vec<Vec<Terms>> = Vec::new();
        for (short, products) in SHORT {
            let mut sums = all.clone();
            sums.expand_inner_sums(short, products);
            if tried.contains(&sums.sums) {
                continue;
            }
            tried.push(sums.sums.clone());
            sums.share_frequent_pairs();
            let operations = sums.operation_count();
            if operations > fewest || (operations == fewest && !is_small && tried.len() > 1) {
                continue;
            }
            fewest = operations;
            // Choose the signs of the new sums, and let sums begin with a product again.
            let mut program = self
                .program_with_rewritten_sums(&sums)
                .choose_signs_with_fewest_negations()
                .order_terms_for_fusion();
            program.counts = program.count_operations();
            let operations = program.counts.total_operations();
            if operations > cost.1 {
                continue;
            }
            let length = program.instruction_count_after_fusion();
            if (length, operations) < cost {
                cost = (length, operations);
                best = Some((length, program));
                if !is_small {
                    break;
                }
            }
        }
        best
    }

    /// Returns the program in which the sums are computed as listed.
    fn program_with_rewritten_sums(&self, sums: &SumTable) -> Program {
        let mut out = SumWriter {
            sums,
            instructions: Vec::new(),
            lanes: ValueLaneCounts::program_input_lane_counts(self),
            values: Vec::new(),
            written: vec![None; sums.sums.len()],
        };
        for (k, op) in self.instructions.iter().enumerate() {
            let value = match sums.ends[k] {
                Some(sum) => out.write_sum_if_needed(sum),
                None => {
                    let values = &out.values;
                    // An operand may have become a scalar because its terms in lanes cancelled.
                    match op.map_operands(|o| o.operand_in_other_program(values)) {
                        Op::Lane(_, a) if out.lanes.lane_count(a) == 1 => a,
                        Op::Sum(n, a) => out.append_instruction(out.lanes.lane_sum_operation(n, a)),
                        op => out.append_instruction(op),
                    }
                }
            };
            out.values.push(value);
        }
        let outputs = self.outputs.iter().map(|o| o.operand_in_other_program(&out.values)).collect();
        let mut program = Program {
            instructions: out.instructions,
            outputs,
            tuples: self.tuples.clone(),
            gathers: self.gathers.clone(),
            ..Program::default()
        };
        program.remove_unused_instructions();
        program
    }
}

impl SumTable {
    fn from_program(program: &Program) -> SumTable {
        let n = program.instructions.len();
        let mut sums = SumTable {
            atoms: Vec::new(),
            lone_products: Vec::new(),
            sums: Vec::new(),
            ends: vec![None; n],
            wanted: Vec::new(),
        };
        let mut known = AtomNumbers { values: vec![None; n], others: BTreeMap::new() };
        for (k, op) in program.instructions.iter().enumerate() {
            let Some(signed) = op.addition_terms() else { continue };
            let mut terms = Terms::new();
            for term in signed {
                let sign = if term.negative { -1.0 } else { 1.0 };
                let key = match term.operand {
                    Operand::Const(c) => {
                        add_term_with_cancellation(&mut terms, TermWithoutCoefficient::One, sign * c);
                        continue;
                    }
                    // A sum with this single use is merged into this one.
                    Operand::Value(a) => match sums.ends[a] {
                        Some(sum) if program.uses[a] == 1 && sums.sums[sum].len() + terms.len() < LONGEST => {
                            let inner = std::mem::take(&mut sums.sums[sum]);
                            inner
                                .iter()
                                .for_each(|(key, c)| add_term_with_cancellation(&mut terms, *key, sign * c));
                            continue;
                        }
                        Some(sum) => TermWithoutCoefficient::Sum(sum),
                        None => sums.key_of_non_sum_operand(term.operand, &mut known),
                    },
                    o => sums.key_of_non_sum_operand(o, &mut known),
                };
                add_term_with_cancellation(&mut terms, key, sign);
            }
            sums.ends[k] = Some(sums.sums.len());
            sums.sums.push(terms);
        }
        let is_single_use_product = |o: &Operand| program.factors_of_single_use_product(*o).is_some();
        sums.lone_products = sums.atoms.iter().map(is_single_use_product).collect();
        let sum_ending_at = |o: Operand| match o {
            Operand::Value(k) => sums.ends[k],
            _ => None,
        };
        let mut wanted: Vec<usize> = program.outputs.iter().filter_map(|o| sum_ending_at(*o)).collect();
        for op in program.instructions.iter().filter(|op| op.addition_terms().is_none()) {
            op.visit_operands(|o| wanted.extend(sum_ending_at(o)));
        }
        sums.wanted = wanted;
        sums
    }

    /// Returns the number of additions and multiplications of the sums.
    fn operation_count(&self) -> usize {
        let mut seen = vec![false; self.sums.len()];
        let mut todo = self.wanted.clone();
        let mut operations = 0;
        while let Some(k) = todo.pop() {
            if std::mem::replace(&mut seen[k], true) {
                continue;
            }
            operations += self.sums[k].len().saturating_sub(1);
            for (key, c) in &self.sums[k] {
                operations += usize::from(*key != TermWithoutCoefficient::One && c.abs() != 1.0);
                if let TermWithoutCoefficient::Sum(inner) = key {
                    todo.push(*inner);
                }
            }
        }
        operations
    }

    /// Returns the key of an operand that is not a sum.
    fn key_of_non_sum_operand(&mut self, o: Operand, known: &mut AtomNumbers) -> TermWithoutCoefficient {
        let place = match o {
            Operand::Value(k) => &mut known.values[k],
            Operand::Const(c) => known.others.entry((0, c.to_bits())).or_default(),
            Operand::Symbol(s) => known.others.entry((1, s.0.into())).or_default(),
            Operand::Tuple(k) => known.others.entry((2, k as u64)).or_default(),
            Operand::Gather(k) => known.others.entry((3, k as u64)).or_default(),
        };
        let atoms = &mut self.atoms;
        TermWithoutCoefficient::Atom(*place.get_or_insert_with(|| {
            atoms.push(o);
            atoms.len() - 1
        }))
    }

    /// Expands inner sums of up to `short` terms into the sums that contain them; unless `products` is set,
    /// sums with products that fuse are not expanded.
    fn expand_inner_sums(&mut self, short: usize, products: bool) {
        let is_fused_product = |key: &TermWithoutCoefficient| match key {
            TermWithoutCoefficient::Atom(a) => self.lone_products[*a],
            _ => false,
        };
        let keeps: Vec<bool> = self
            .sums
            .iter()
            .map(|terms| !products && terms.iter().any(|(key, _)| is_fused_product(key)))
            .collect();
        for k in 0..self.sums.len() {
            let mut terms = Terms::new();
            for (key, c) in &self.sums[k] {
                match *key {
                    TermWithoutCoefficient::Sum(inner)
                        if self.sums[inner].len() <= short && !keeps[inner] =>
                    {
                        self.sums[inner]
                            .iter()
                            .for_each(|(key, d)| add_term_with_cancellation(&mut terms, *key, c * d));
                    }
                    key => add_term_with_cancellation(&mut terms, key, *c),
                }
            }
            let is_nonconstant_positive_term =
                |(key, c): &(TermWithoutCoefficient, f64)| *key != TermWithoutCoefficient::One && *c > 0.0;
            if terms.len() <= MOST_TERMS && terms.iter().any(is_nonconstant_positive_term) {
                self.sums[k] = terms;
            }
        }
    }

    /// Replaces the pairs of terms that most sums share by sums of their own.
    fn share_frequent_pairs(&mut self) {
        let mut pairs = SharedPairs::from_sums(&self.sums, self.atoms.len());
        while let Some((pair, list)) = pairs.take_most_shared_pair() {
            let new = TermWithoutCoefficient::Sum(self.sums.len());
            let mut with_new = Vec::new();
            for &k in &list {
                let terms = &mut self.sums[k];
                let Some(c) = terms
                    .iter()
                    .find(|(key, _)| key.term_key_index() == pair.first_key_index())
                    .map(|(_, c)| *c)
                else {
                    continue;
                };
                let is_member_of_pair =
                    |key: u32| key == pair.first_key_index() || key == pair.second_key_index();
                for (i, a) in terms.iter().enumerate() {
                    for b in &terms[i + 1..] {
                        if is_member_of_pair(a.0.term_key_index()) || is_member_of_pair(b.0.term_key_index())
                        {
                            pairs.remove_sum_from_pair(TermPair::new(*a, *b), k);
                        }
                    }
                }
                terms.retain(|(key, _)| !is_member_of_pair(key.term_key_index()));
                with_new.extend(terms.iter().map(|term| (TermPair::new(*term, (new, c)), k)));
                terms.push((new, c));
            }
            pairs.add_new_pairs(with_new);
            let [a, b] = [pair.first_key_index(), pair.second_key_index()]
                .map(|number| self.term_key_from_index(number));
            self.sums.push(vec![(a, 1.0), (b, pair.coefficient_ratio())]);
        }
    }

    /// Returns the key of the atom or sum with this number.
    fn term_key_from_index(&self, number: u32) -> TermWithoutCoefficient {
        match number {
            0 => TermWithoutCoefficient::One,
            n if n < FIRST_SUM => TermWithoutCoefficient::Atom(n as usize - 1),
            n => TermWithoutCoefficient::Sum((n - FIRST_SUM) as usize),
        }
    }
}

/// Indices of the atoms that have occurred so far in sums.
struct AtomNumbers {
    /// Index of the atom that each instruction computes.
    values: Vec<Option<usize>>,
    /// Atom of each operand that is not an instruction, by kind and number.
    others: BTreeMap<(u8, u64), Option<usize>>,
}

/// Adds a term to a sum and removes a term that cancels.
fn add_term_with_cancellation(terms: &mut Terms, key: TermWithoutCoefficient, c: f64) {
    match terms.iter().position(|(other, _)| *other == key) {
        Some(k) => {
            terms[k].1 += c;
            if terms[k].1 == 0.0 {
                terms.remove(k);
            }
        }
        None if c == 0.0 => {}
        None => terms.push((key, c)),
    }
}

/// Writer of the program in which sums are replaced by shared ones.
struct SumWriter<'a> {
    sums: &'a SumTable,
    instructions: Vec<Op>,
    lanes: ValueLaneCounts,
    /// New operand for each instruction of the original program.
    values: Vec<Operand>,
    /// New operand of each sum that is already written.
    written: Vec<Option<Operand>>,
}

/// Placeholder for a sum that was not written, which is an internal error: a program with it is rejected.
const LOST: Operand = Operand::Const(f64::NAN);

impl SumWriter<'_> {
    fn append_instruction(&mut self, op: Op) -> Operand {
        self.lanes.record_lane_count(&op);
        self.instructions.push(op);
        Operand::Value(self.instructions.len() - 1)
    }

    /// Returns the operand of a sum, which is written before its first use.
    fn write_sum_if_needed(&mut self, k: usize) -> Operand {
        // Iterative, because sums may be nested deeply.
        let mut todo = vec![k];
        while let Some(&top) = todo.last() {
            let inner = self.sums.sums[top].iter().filter_map(|(key, _)| match key {
                TermWithoutCoefficient::Sum(s) if self.written[*s].is_none() => Some(*s),
                _ => None,
            });
            let before = todo.len();
            let inner: Vec<usize> = inner.collect();
            todo.extend(inner);
            if todo.len() == before {
                todo.pop();
                if self.written[top].is_none() {
                    self.written[top] = Some(self.write_sum_instructions(top));
                }
            }
        }
        self.written[k].unwrap_or(LOST)
    }

    /// Writes the instructions of a sum whose inner sums are already written.
    fn write_sum_instructions(&mut self, k: usize) -> Operand {
        let mut terms: Vec<(Operand, f64)> = Vec::new();
        for (key, c) in &self.sums.sums[k] {
            terms.push(match *key {
                TermWithoutCoefficient::One => (Operand::Const(c.abs()), c.signum()),
                TermWithoutCoefficient::Atom(a) => {
                    (self.sums.atoms[a].operand_in_other_program(&self.values), *c)
                }
                TermWithoutCoefficient::Sum(s) => (self.written[s].unwrap_or(LOST), *c),
            });
        }
        // Terms are added in the order in which they are computed, positive ones before negative ones.
        terms.sort_by_key(|(o, c)| (*c < 0.0, o.instruction_index()));
        let mut sum: Option<Operand> = None;
        for (o, c) in terms {
            let size = c.abs();
            let term =
                if size == 1.0 { o } else { self.append_instruction(Op::Mul(Operand::Const(size), o)) };
            sum = Some(match (sum, c < 0.0) {
                (None, false) => term,
                (None, true) => self.append_instruction(Op::Neg(term)),
                (Some(sum), false) => self.append_instruction(Op::Add(sum, term)),
                (Some(sum), true) => self.append_instruction(Op::Sub(sum, term)),
            });
        }
        sum.unwrap_or(Operand::Const(0.0))
    }
}
