//! Extraction of factors that are common to several terms of a sum: `a b + a c` becomes `a (b + c)`, with one
//! multiplication less. The number of instructions stays the same where products are fused into sums.

use super::terms::{LONGEST, Term};
use super::{Op, Operand, Program};

impl Program {
    /// Extracts common factors from the sums of a program.
    pub(super) fn factor_sums(self) -> Program {
        let inner = self.inner_addition_flags();
        let sums = (0..self.instructions.len()).filter(|k| !inner[*k]);
        let mut groups =
            sums.filter_map(|k| Some((k, self.group_by_common_factor(self.terms_of_sum(k)?)?))).peekable();
        if groups.peek().is_none() {
            drop(groups);
            return self;
        }
        let mut out = Program { tuples: self.tuples.clone(), ..Program::default() };
        let mut values: Vec<Operand> = Vec::with_capacity(self.instructions.len());
        for (k, op) in self.instructions.iter().enumerate() {
            values.push(match groups.next_if(|(sum, _)| *sum == k) {
                Some((_, groups)) => {
                    out.add_sum_of_factored_groups(&groups, &|o| o.operand_in_other_program(&values))
                }
                None => out.append_instruction(op.map_operands(|o| o.operand_in_other_program(&values))),
            });
        }
        drop(groups);
        out.outputs = self.outputs.iter().map(|o| o.operand_in_other_program(&values)).collect();
        out.gathers = self.gathers;
        out.remove_unused_instructions();
        out
    }

    fn append_instruction(&mut self, op: Op) -> Operand {
        self.instructions.push(op);
        Operand::Value(self.instructions.len() - 1)
    }

    /// Returns for each instruction whether it is an addition whose only use is another addition.
    fn inner_addition_flags(&self) -> Vec<bool> {
        let mut inner = vec![false; self.instructions.len()];
        for op in &self.instructions {
            for term in op.addition_terms().into_iter().flatten() {
                if let Operand::Value(k) = term.operand {
                    inner[k] = self.terms_of_single_use_addition(term.operand).is_some();
                }
            }
        }
        inner
    }

    /// Returns the terms of the sum that ends with instruction `k`, from left to right.
    fn terms_of_sum(&self, k: usize) -> Option<Vec<Term>> {
        let mut terms = Vec::new();
        let [a, b] = self.instructions[k].addition_terms()?;
        let mut todo = vec![b, a];
        while let Some(term) = todo.pop() {
            if terms.len() + todo.len() > LONGEST {
                return None;
            }
            match self.terms_of_single_use_addition(term.operand) {
                Some([a, b]) => todo.extend([
                    b.multiplied_by_sum_sign(term.negative),
                    a.multiplied_by_sum_sign(term.negative),
                ]),
                None => terms.push(term),
            }
        }
        Some(terms)
    }

    /// Groups the terms of a sum by common factors. Returns `None` if no factor is common to two terms.
    fn group_by_common_factor(&self, mut open: Vec<Term>) -> Option<Vec<FactorGroup>> {
        if !self.may_share_factors(&open) {
            return None;
        }
        let mut groups = Vec::new();
        let mut saved = false;
        while let Some(factor) = self.most_common_factor(&open) {
            saved = true;
            let mut others = Vec::new();
            open.retain(|t| match self.cofactor_of_term(*t, factor) {
                Some(other) => {
                    others.push(other);
                    false
                }
                None => true,
            });
            groups.push(FactorGroup { factor: Some(factor), others });
        }
        // A term without common factor forms a group of its own.
        groups.extend(open.into_iter().map(|t| match self.factors_of_single_use_product(t.operand) {
            Some((a, b)) => FactorGroup { factor: Some(a), others: vec![Term { operand: b, ..t }] },
            None => FactorGroup { factor: None, others: vec![t] },
        }));
        // Groups are ordered by when their values are computed.
        groups.sort_by_key(|g| g.others.iter().map(|t| t.operand.instruction_index()).max());
        saved.then_some(groups)
    }

    /// Returns false if no two terms have a factor in common: a cheap test.
    fn may_share_factors(&self, terms: &[Term]) -> bool {
        let mut factors: Vec<u64> = Vec::new();
        for term in terms {
            let Some((a, b)) = self.factors_of_single_use_product(term.operand) else { continue };
            let [a, b] = [a, b].map(sign_independent_key);
            if factors.contains(&a) || factors.contains(&b) {
                return true;
            }
            factors.extend([a, b]);
        }
        false
    }

    /// Returns the factor that most terms of a sum have, if at least two have it.
    fn most_common_factor(&self, terms: &[Term]) -> Option<Operand> {
        let mut best: Option<(usize, Operand)> = None;
        for term in terms {
            let Some((a, b)) = self.factors_of_single_use_product(term.operand) else { continue };
            for factor in [a, b] {
                let count = terms.iter().filter(|t| self.cofactor_of_term(**t, factor).is_some()).count();
                if count > best.map_or(1, |(most, _)| most) {
                    best = Some((count, factor));
                }
            }
        }
        best.map(|(_, factor)| factor)
    }

    /// Returns the other factor of a term that is a product with this factor.
    fn cofactor_of_term(&self, term: Term, factor: Operand) -> Option<Term> {
        let (a, b) = self.factors_of_single_use_product(term.operand)?;
        let negation_relative_to_factor = |x: Operand| match (x, factor) {
            (Operand::Const(x), Operand::Const(f)) if x == -f => Some(true),
            (x, f) if x == f => Some(false),
            _ => None,
        };
        let (other, opposite) = negation_relative_to_factor(a)
            .map(|o| (b, o))
            .or_else(|| negation_relative_to_factor(b).map(|o| (a, o)))?;
        Some(Term { operand: other, negative: term.negative != opposite })
    }

    /// Adds the instructions for a sum of groups, each a factor times a sum.
    fn add_sum_of_factored_groups(
        &mut self,
        groups: &[FactorGroup],
        at: &dyn Fn(Operand) -> Operand,
    ) -> Operand {
        let mut sum: Option<Term> = None;
        for group in groups {
            let mut value = self.append_sum_instructions(&group.others, at);
            if let Some(factor) = group.factor {
                value.operand = self.append_instruction(Op::Mul(at(factor), value.operand));
            }
            sum = Some(sum.map_or(value, |sum| self.append_sum_of_two_terms(sum, value)));
        }
        match sum {
            Some(Term { operand, negative: true }) => self.append_instruction(Op::Neg(operand)),
            Some(Term { operand, negative: false }) => operand,
            None => Operand::Const(0.0),
        }
    }

    /// Appends the instructions for a sum of terms to a program.
    fn append_sum_instructions(&mut self, terms: &[Term], at: &dyn Fn(Operand) -> Operand) -> Term {
        let known: f64 = terms.iter().filter_map(signed_constant).sum();
        let is_known = terms.iter().any(|t| signed_constant(t).is_some());
        let constant = is_known.then_some(Term::positive_term(Operand::Const(known)));
        let rest = terms.iter().filter(|t| signed_constant(t).is_none());
        let mut all = rest.map(|t| Term { operand: at(t.operand), ..*t }).chain(constant);
        let first = all.next().unwrap_or(Term::positive_term(Operand::Const(0.0)));
        all.fold(first, |sum, term| self.append_sum_of_two_terms(sum, term))
    }

    /// Appends the instruction for a sum of two terms to a program.
    fn append_sum_of_two_terms(&mut self, a: Term, b: Term) -> Term {
        let (op, negative) = Term::addition_operation(a, b);
        Term { operand: self.append_instruction(op), negative }
    }
}

/// Terms of a sum that have a common factor, divided by the factor; terms without a factor form a separate
/// group.
struct FactorGroup {
    factor: Option<Operand>,
    others: Vec<Term>,
}

/// Returns a key of an operand that is independent of the operand's sign.
fn sign_independent_key(o: Operand) -> u64 {
    match o {
        Operand::Const(c) => c.abs().to_bits(),
        Operand::Symbol(s) => 1 << 32 | u64::from(s.0),
        Operand::Value(k) => 2 << 32 | k as u64,
        Operand::Tuple(k) => 3 << 32 | k as u64,
        Operand::Gather(k) => 4 << 32 | k as u64,
    }
}

/// Returns the value of a term if it is a constant, with its sign.
fn signed_constant(term: &Term) -> Option<f64> {
    match term.operand {
        Operand::Const(c) => Some(if term.negative { -c } else { c }),
        _ => None,
    }
}
