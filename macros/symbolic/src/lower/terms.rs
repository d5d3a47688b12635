//! Sums of several terms, as the passes process them.

use super::{Op, Operand, Program};

/// Maximum number of terms that a pass processes as one sum, which bounds the time for long sums.
pub(super) const LONGEST: usize = 64;

/// Term of a sum: an operand with its sign.
#[derive(Clone, Copy)]
pub(super) struct Term {
    pub operand: Operand,
    pub negative: bool,
}

impl Term {
    pub fn positive_term(operand: Operand) -> Term {
        Term { operand, negative: false }
    }

    /// Returns the term of a sum that itself has this sign.
    pub fn multiplied_by_sum_sign(self, negative: bool) -> Term {
        Term { negative: self.negative != negative, ..self }
    }

    /// Returns the operation that adds two terms, and true if its result has to be negated: if both terms are
    /// negative.
    pub fn addition_operation(a: Term, b: Term) -> (Op, bool) {
        let op = match (a.negative, b.negative) {
            (false, false) | (true, true) => Op::Add(a.operand, b.operand),
            (false, true) => Op::Sub(a.operand, b.operand),
            (true, false) => Op::Sub(b.operand, a.operand),
        };
        (op, a.negative && b.negative)
    }
}

/// A sum of several terms: its additions, innermost first, and its terms in the order of addition.
pub(super) struct Sum {
    pub additions: Vec<usize>,
    pub terms: Vec<Term>,
}

impl Sum {
    /// Returns the operations that add the terms in order, or `None` if all terms are negative.
    pub fn operations_adding_terms(&self) -> Option<Vec<Op>> {
        let mut ops = Vec::with_capacity(self.additions.len());
        let mut sum = *self.terms.first()?;
        for (term, at) in self.terms[1..].iter().zip(&self.additions) {
            let (op, negative) = Term::addition_operation(sum, *term);
            ops.push(op);
            sum = Term { operand: Operand::Value(*at), negative };
        }
        (!sum.negative).then_some(ops)
    }
}

impl Op {
    /// Returns the two terms of an addition or a subtraction.
    pub(super) fn addition_terms(&self) -> Option<[Term; 2]> {
        match *self {
            Op::Add(a, b) => Some([Term::positive_term(a), Term::positive_term(b)]),
            Op::Sub(a, b) => Some([Term::positive_term(a), Term { operand: b, negative: true }]),
            _ => None,
        }
    }
}

impl Program {
    /// Returns the terms of an addition with a single use.
    pub(super) fn terms_of_single_use_addition(&self, o: Operand) -> Option<[Term; 2]> {
        self.single_use_operation(o)?.addition_terms()
    }

    /// Returns the factors of a product with a single use.
    pub(super) fn factors_of_single_use_product(&self, o: Operand) -> Option<(Operand, Operand)> {
        match *self.single_use_operation(o)? {
            Op::Mul(a, b) => Some((a, b)),
            _ => None,
        }
    }

    /// Returns the operation of a value with a single use.
    fn single_use_operation(&self, o: Operand) -> Option<&Op> {
        match o {
            Operand::Value(k) if self.uses[k] == 1 => Some(&self.instructions[k]),
            _ => None,
        }
    }
}
