//! Choice between computing `x` and `−x`. A difference costs the same either way, and a constant factor can
//! have either sign, so most negations can be avoided by computing the negatives of some values.
//!
//! Every value is stored with a sign: plus if the value itself is stored, minus if its negative is. The signs
//! of differences and of multiples are free; those of other values follow from their operands. An output must
//! be stored with plus and costs a negation otherwise. The search starts with all free signs plus and changes
//! single signs while that saves negations.

use super::hoist::{self, is_constant_or_hoisted};
use super::terms::Term;
use super::{Op, Operand, Program};
use crate::expr::Function;
use std::collections::BTreeSet;

/// Number of operand levels in which free signs are searched for a negated value.
const DEPTH: usize = 6;
/// Maximum number of free signs that are changed together to remove one negation.
const TRIES: usize = 6;
/// Maximum number of values that a changed sign may affect; a change with more effects is rejected.
const REACH: usize = 400;

impl Program {
    /// Removes negations by the choice of signs. Angles `c - q` become `q - c` if that needs at most one more
    /// negation: the offsets of all angles are then one vector addition.
    pub(super) fn choose_signs_with_fewest_negations(self) -> Program {
        let reversed = self.constant_minus_angle_values();
        if reversed.is_empty() && !self.instructions.iter().any(|op| matches!(op, Op::Neg(_))) {
            return self;
        }
        let best = StoredSigns::optimise_signs(&self, &[]);
        if reversed.is_empty() {
            return best.rewrite_program();
        }
        let other = StoredSigns::optimise_signs(&self, &reversed);
        if other.negation_count() <= best.negation_count() + 1 {
            other.rewrite_program()
        } else {
            best.rewrite_program()
        }
    }

    /// Returns values `c - q` that are used by sines and cosines alone.
    fn constant_minus_angle_values(&self) -> Vec<usize> {
        let is_reversed =
            |op: &Op| matches!(op, Op::Sub(c, Operand::Symbol(_)) if is_constant_or_hoisted(*c));
        let mut uses = vec![0; self.instructions.len()];
        for op in &self.instructions {
            if let Op::Call(Function::Sin | Function::Cos, Operand::Value(k)) = *op {
                uses[k] += 1;
            }
        }
        let all = 0..self.instructions.len();
        all.filter(|k| uses[*k] > 0 && uses[*k] == self.uses[*k] && is_reversed(&self.instructions[*k]))
            .collect()
    }
}

/// Signs with which the values of a program are stored.
struct StoredSigns<'a> {
    program: &'a Program,
    users: Vec<Vec<usize>>,
    /// True for values that must be stored with their own sign.
    sink: Vec<bool>,
    /// Chosen sign of each value whose sign is free; true for minus.
    choice: Vec<bool>,
    /// True for values with a free sign whose choice is final.
    fixed: Vec<bool>,
    /// Whether each value is stored with a minus sign.
    negative: Vec<bool>,
}

impl<'a> StoredSigns<'a> {
    /// Searches signs that need few negations, from all free signs plus, with some values fixed to minus.
    fn optimise_signs(program: &'a Program, negative: &[usize]) -> StoredSigns<'a> {
        let mut signs = StoredSigns::new(program, negative);
        signs.flip_signs_to_save_negations();
        signs
    }

    fn new(program: &'a Program, negative: &[usize]) -> StoredSigns<'a> {
        let n = program.instructions.len();
        let mut signs = StoredSigns {
            program,
            users: vec![Vec::new(); n],
            sink: vec![false; n],
            choice: vec![false; n],
            fixed: vec![false; n],
            negative: vec![false; n],
        };
        for &k in negative {
            signs.choice[k] = true;
            signs.fixed[k] = true;
        }
        for (k, op) in program.instructions.iter().enumerate() {
            let keeps = operands_accept_either_sign(op);
            op.visit_operands(|o| {
                if let Operand::Value(a) = o {
                    signs.users[a].push(k);
                    signs.sink[a] |= !keeps;
                }
            });
            signs.negative[k] = signs.is_value_stored_negated(k);
        }
        for output in &program.outputs {
            if let Operand::Value(a) = output {
                signs.sink[*a] = true;
            }
        }
        signs
    }

    /// Returns true if an operand is stored with a minus sign.
    fn is_operand_stored_negated(&self, o: Operand) -> bool {
        matches!(o, Operand::Value(a) if self.negative[a])
    }

    /// Returns the sign of a value from the signs of its operands, or the chosen sign if it is free.
    fn is_value_stored_negated(&self, k: usize) -> bool {
        match self.program.instructions[k] {
            _ if self.has_free_sign(k) => self.choice[k],
            Op::Neg(a) => !self.is_operand_stored_negated(a),
            Op::Add(a, _) | Op::Sub(a, _) => self.is_operand_stored_negated(a),
            Op::Mul(a, b) | Op::Div(a, b) => {
                self.is_operand_stored_negated(a) != self.is_operand_stored_negated(b)
            }
            Op::Call(f, a) => f.is_odd() && self.is_operand_stored_negated(a),
            Op::Sum(_, a) => self.is_operand_stored_negated(a),
            _ => false,
        }
    }

    /// Returns true if the sign of a value can be chosen.
    fn has_free_sign(&self, k: usize) -> bool {
        match self.program.instructions[k] {
            Op::Add(a, b) => {
                is_constant_or_hoisted(a)
                    || is_constant_or_hoisted(b)
                    || self.is_operand_stored_negated(a) != self.is_operand_stored_negated(b)
            }
            Op::Sub(a, b) => {
                is_constant_or_hoisted(a)
                    || is_constant_or_hoisted(b)
                    || self.is_operand_stored_negated(a) == self.is_operand_stored_negated(b)
            }
            Op::Mul(a, b) | Op::Div(a, b) => is_constant_or_hoisted(a) || is_constant_or_hoisted(b),
            _ => false,
        }
    }

    /// Returns the number of negations that the chosen signs cost.
    fn negation_count(&self) -> usize {
        self.sink.iter().zip(&self.negative).filter(|(sink, negative)| **sink && **negative).count()
    }

    /// Changes free signs as long as that reduces the number of negations.
    fn flip_signs_to_save_negations(&mut self) {
        for least in [1, 0, 1, 0, 1] {
            let mut better = false;
            for k in 0..self.negative.len() {
                if !(self.sink[k] && self.negative[k]) {
                    continue;
                }
                let mut paths = Vec::new();
                self.find_paths_to_free_signs(&mut vec![k], &mut paths);
                better |= paths.iter().any(|path| self.try_sign_change(path, least));
            }
            if !better {
                return;
            }
        }
    }

    /// Finds paths from the last value of `path` through operands to free values that its sign depends on.
    fn find_paths_to_free_signs(&self, path: &mut Vec<usize>, found: &mut Vec<Vec<usize>>) {
        let Some(k) = path.last().copied().filter(|_| found.len() < TRIES) else { return };
        if self.has_free_sign(k) && !self.fixed[k] {
            found.push(path.clone());
        } else if path.len() < DEPTH {
            self.program.instructions[k].visit_operands(|o| {
                if let Operand::Value(a) = o {
                    path.push(a);
                    self.find_paths_to_free_signs(path, found);
                    path.pop();
                }
            });
        }
    }

    /// Changes the signs along a path where they are free or become free, if that saves at least `least`
    /// negations.
    fn try_sign_change(&mut self, path: &[usize], least: isize) -> bool {
        let before: Vec<bool> = path.iter().map(|k| self.choice[*k]).collect();
        for &k in path {
            self.choice[k] = !self.negative[k];
        }
        let mut changed = Vec::new();
        if self.propagate_signs(path, &mut changed) >= least {
            return true;
        }
        for c in changed {
            self.negative[c] = !self.negative[c];
        }
        for (&k, choice) in path.iter().zip(before) {
            self.choice[k] = choice;
        }
        false
    }

    /// Updates the signs that depend on changed signs; returns the number of negations saved.
    fn propagate_signs(&mut self, from: &[usize], changed: &mut Vec<usize>) -> isize {
        let mut gain = 0;
        let mut todo: BTreeSet<usize> = from.iter().copied().collect();
        while let Some(k) = todo.pop_first() {
            let sign = self.is_value_stored_negated(k);
            if sign == self.negative[k] {
                continue;
            }
            // A partial update must be rejected.
            if changed.len() >= REACH {
                return isize::MIN;
            }
            self.negative[k] = sign;
            changed.push(k);
            if self.sink[k] {
                gain += if sign { -1 } else { 1 };
            }
            todo.extend(&self.users[k]);
        }
        gain
    }

    /// Rewrites the program such that its values are stored with the chosen signs.
    fn rewrite_program(&self) -> Program {
        let mut out = SignRewriter {
            signs: self,
            instructions: Vec::new(),
            tuples: self.program.tuples.clone(),
            stored: Vec::new(),
            positive: Vec::new(),
        };
        for k in 0..self.negative.len() {
            out.append_rewritten_instruction(k);
        }
        let outputs = self.program.outputs.iter().map(|o| out.operand_with_plus(*o)).collect();
        let mut program = Program {
            instructions: out.instructions,
            outputs,
            tuples: out.tuples,
            gathers: self.program.gathers.clone(),
            ..Program::default()
        };
        program.remove_unused_instructions();
        program
    }
}

/// Writer of the program in which values are stored with the chosen signs.
struct SignRewriter<'a> {
    signs: &'a StoredSigns<'a>,
    instructions: Vec<Op>,
    tuples: Vec<Vec<f64>>,
    /// Operand in which each value is stored, with its sign.
    stored: Vec<Operand>,
    /// Operand for each value with its own sign, if one exists.
    positive: Vec<Option<Operand>>,
}

impl SignRewriter<'_> {
    fn append_instruction(&mut self, op: Op) -> Operand {
        self.instructions.push(op);
        Operand::Value(self.instructions.len() - 1)
    }

    fn rewritten_operand(&self, o: Operand) -> Operand {
        match o {
            Operand::Value(a) => self.stored[a],
            other => other,
        }
    }

    /// Returns an operand with plus; adds a negation if it is stored with minus.
    fn operand_with_plus(&mut self, o: Operand) -> Operand {
        let Operand::Value(a) = o else { return o };
        if let Some(found) = self.positive[a] {
            return found;
        }
        let negated = self.append_instruction(Op::Neg(self.stored[a]));
        self.positive[a] = Some(negated);
        negated
    }

    fn append_rewritten_instruction(&mut self, k: usize) {
        let (signs, negative) = (self.signs, self.signs.negative[k]);
        let stored = match signs.program.instructions[k] {
            // The sign of the value records the negation.
            Op::Neg(a) => self.rewritten_operand(a),
            Op::Mul(a, b) => {
                let (a, b) = self.factors_of_signed_product(
                    a,
                    b,
                    (signs.is_operand_stored_negated(a) != signs.is_operand_stored_negated(b)) != negative,
                );
                self.append_instruction(Op::Mul(a, b))
            }
            Op::Div(a, b) => {
                let (a, b) = self.factors_of_signed_product(
                    a,
                    b,
                    (signs.is_operand_stored_negated(a) != signs.is_operand_stored_negated(b)) != negative,
                );
                self.append_instruction(Op::Div(a, b))
            }
            Op::Call(f, a) if f.is_odd() || f.is_even() => {
                let a = self.rewritten_operand(a);
                self.append_instruction(Op::Call(f, a))
            }
            Op::Sum(n, a) => {
                let a = self.rewritten_operand(a);
                self.append_instruction(Op::Sum(n, a))
            }
            op => match op.addition_terms() {
                Some(terms) => self.add_signed_sum_instruction(terms.map(|t| {
                    t.multiplied_by_sum_sign(signs.is_operand_stored_negated(t.operand) != negative)
                })),
                None => {
                    let op = op.map_operands(|o| self.operand_with_plus(o));
                    self.append_instruction(op)
                }
            },
        };
        self.stored.push(stored);
        self.positive.push((!negative).then_some(stored));
    }

    /// Adds the instruction for the sum of two terms; at most one term is negative, unless one is a constant.
    fn add_signed_sum_instruction(&mut self, terms: [Term; 2]) -> Operand {
        let mut terms = terms.map(|t| Term { operand: self.rewritten_operand(t.operand), ..t });
        if terms.iter().all(|t| t.negative) {
            let constant = usize::from(!is_constant_or_hoisted(terms[0].operand));
            terms[constant] = Term::positive_term(self.negate_constant(terms[constant].operand));
        }
        let [a, b] = terms;
        self.append_instruction(Term::addition_operation(a, b).0)
    }

    fn factors_of_signed_product(&mut self, a: Operand, b: Operand, negate: bool) -> (Operand, Operand) {
        let (a, b) = (self.rewritten_operand(a), self.rewritten_operand(b));
        match (negate, is_constant_or_hoisted(a)) {
            (false, _) => (a, b),
            (true, true) => (self.negate_constant(a), b),
            (true, false) => (a, self.negate_constant(b)),
        }
    }

    /// Returns the operand for the negative of a constant.
    fn negate_constant(&mut self, o: Operand) -> Operand {
        match o {
            Operand::Tuple(k) => {
                let negative: Vec<f64> = self.tuples[k].iter().map(|x| -x).collect();
                let known = self.tuples.iter().position(|t| *t == negative);
                Operand::Tuple(known.unwrap_or_else(|| {
                    self.tuples.push(negative);
                    self.tuples.len() - 1
                }))
            }
            known => hoist::negate_constant_or_hoisted(known),
        }
    }
}

/// Returns true for operations whose operands may be stored with either sign.
fn operands_accept_either_sign(op: &Op) -> bool {
    match op {
        Op::Neg(_) | Op::Add(..) | Op::Sub(..) | Op::Mul(..) | Op::Div(..) | Op::Sum(..) => true,
        Op::Call(f, _) => f.is_odd() || f.is_even(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Symbol};
    use crate::lower::lower;

    #[test]
    fn negated_outputs_cost_no_additional_instructions() {
        let g = Graph::new();
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| g.symbol(Symbol(k)));
        let difference = a - b;
        let product = difference * c;
        let sum = g.num(2.0) * a + g.num(3.0) * b;
        for outputs in [
            vec![-product, difference + d],
            vec![-(product * d), product * a * b],
            vec![-sum, sum * c + d, c - sum],
            vec![-a, c - a],
            vec![(b - a).sin() * c, -(g.num(2.0) * difference), difference.cos()],
        ] {
            let program = lower(&outputs);
            let values = program.interpret_program(&|s| f64::from(s.0) + 0.5);
            let expected = crate::expr::eval::eval(&outputs, &|s| f64::from(s.0) + 0.5);
            assert_eq!(values, expected);
            let negations = program.instructions.iter().filter(|op| matches!(op, super::Op::Neg(_)));
            assert!(negations.count() <= 1, "{:?}", program.instructions);
        }
    }

    #[test]
    fn product_with_both_signs_costs_one_negation() {
        let g = Graph::new();
        let (a, b) = (g.symbol(Symbol(0)), g.symbol(Symbol(1)));
        let program = lower(&[a * b, -(a * b)]);
        assert_eq!((program.counts.mul, program.counts.add), (1, 1));
    }
}
