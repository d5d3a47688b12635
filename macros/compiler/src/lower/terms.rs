//! Sums as the passes see them: additions with the terms that they add.

use super::{Op, Operand, Program};

/// Longest sum that a pass looks at as one; it bounds the time that long sums take.
pub(super) const LONGEST: usize = 64;

/// A term of a sum.
#[derive(Clone, Copy)]
pub(super) struct Term {
    pub operand: Operand,
    pub negative: bool,
}

impl Term {
    pub fn positive(operand: Operand) -> Term {
        Term { operand, negative: false }
    }

    /// The same term where what it is a part of has this sign.
    pub fn within(self, negative: bool) -> Term {
        Term { negative: self.negative != negative, ..self }
    }

    /// The addition of two terms, and whether its result is meant negative, which it is if both are.
    pub fn sum(a: Term, b: Term) -> (Op, bool) {
        let op = match (a.negative, b.negative) {
            (false, false) | (true, true) => Op::Add(a.operand, b.operand),
            (false, true) => Op::Sub(a.operand, b.operand),
            (true, false) => Op::Sub(b.operand, a.operand),
        };
        (op, a.negative && b.negative)
    }
}

/// A sum of several terms: the additions that are its own, innermost first, and the terms in the order in which they are
/// added.
pub(super) struct Sum {
    pub additions: Vec<usize>,
    pub terms: Vec<Term>,
}

impl Sum {
    /// An addition for each of its places: terms are added one after another, the first one last if both of the first
    /// two are negative. `None` if all are.
    pub fn chain(&self) -> Option<Vec<Op>> {
        let mut ops = Vec::with_capacity(self.additions.len());
        let mut sum = *self.terms.first()?;
        for (term, at) in self.terms[1..].iter().zip(&self.additions) {
            let (op, negative) = Term::sum(sum, *term);
            ops.push(op);
            sum = Term { operand: Operand::Value(*at), negative };
        }
        (!sum.negative).then_some(ops)
    }
}

impl Op {
    /// The two terms of an addition or a subtraction.
    pub(super) fn terms(&self) -> Option<[Term; 2]> {
        match *self {
            Op::Add(a, b) => Some([Term::positive(a), Term::positive(b)]),
            Op::Sub(a, b) => Some([Term::positive(a), Term { operand: b, negative: true }]),
            _ => None,
        }
    }
}

impl Program {
    /// The terms of an addition whose only use is here.
    pub(super) fn lone_addition(&self, o: Operand) -> Option<[Term; 2]> {
        self.lone(o)?.terms()
    }

    /// The factors of a product whose only use is here.
    pub(super) fn lone_product(&self, o: Operand) -> Option<(Operand, Operand)> {
        match *self.lone(o)? {
            Op::Mul(a, b) => Some((a, b)),
            _ => None,
        }
    }

    fn lone(&self, o: Operand) -> Option<&Op> {
        match o {
            Operand::Value(k) if self.uses[k] == 1 => Some(&self.instructions[k]),
            _ => None,
        }
    }
}
