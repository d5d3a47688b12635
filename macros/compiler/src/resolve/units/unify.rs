//! Dimensions with unknowns, and linear equations between them: unification over exponent vectors of length,
//! mass and time.

use crate::language::dimension::{Dimension, Variable};
use crate::language::ratio::Ratio;

/// Result of the addition of an equation to the system.
#[derive(Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The equation is consistent; it determined these unknowns.
    Holds(Vec<Variable>),
    /// The equation contradicts earlier ones.
    Contradicts,
    /// The limit of work or of exponents was exceeded; the result is undecided.
    LimitExceeded,
}

/// Maximum number of terms visited in total. A mechanism with thousands of parameters needs about a hundredth
/// of it.
const MAX_WORK: usize = 1_000_000;

/// System of equations between dimensions, in reduced row echelon form: every solved unknown in terms of
/// unsolved ones.
#[derive(Debug, Default)]
pub struct System {
    solution: Vec<Option<Dimension>>,
    /// For each unsolved unknown, the solved unknowns whose solutions contain it; the list may include
    /// solutions that no longer contain it.
    uses: Vec<Vec<Variable>>,
    work: usize,
}

impl System {
    /// Adds an unknown dimension to the system.
    pub fn variable(&mut self) -> Variable {
        self.solution.push(None);
        self.uses.push(Vec::new());
        self.solution.len() - 1
    }

    /// Returns a dimension in terms of unsolved unknowns; `None` if the limit of work is exceeded.
    pub fn resolve(&mut self, dimension: &Dimension) -> Option<Dimension> {
        let mut sum = Dimension { unknown: Vec::new(), ..dimension.clone() };
        for (v, e) in &dimension.unknown {
            self.work += 1 + sum.unknown.len();
            if self.work > MAX_WORK {
                return None;
            }
            sum = match self.solution.get(*v)? {
                Some(known) => sum.times_power(known, *e)?,
                None => sum.times_power(&Dimension::variable(*v), *e)?,
            };
        }
        Some(sum)
    }

    /// Adds the equation that two dimensions are equal.
    pub fn equate(&mut self, a: &Dimension, b: &Dimension) -> Outcome {
        let quotient = a.quotient(b).and_then(|quotient| self.resolve(&quotient));
        let Some(quotient) = quotient else { return Outcome::LimitExceeded };
        match quotient.unknown.last() {
            None if quotient.is_plain() => Outcome::Holds(Vec::new()),
            None => Outcome::Contradicts,
            Some((pivot, exponent)) => {
                self.solve(*pivot, *exponent, &quotient).map_or(Outcome::LimitExceeded, Outcome::Holds)
            }
        }
    }

    /// Solves `quotient = 1` for one of its unknowns, and substitutes the solution.
    fn solve(&mut self, pivot: Variable, exponent: Ratio, quotient: &Dimension) -> Option<Vec<Variable>> {
        let rest = quotient.times_power(&Dimension::variable(pivot), exponent.negated())?;
        let value = rest.power(exponent.negated().inverse()?)?;
        let mut known = Vec::new();
        for v in std::mem::take(self.uses.get_mut(pivot)?) {
            let Some(old) = self.solution.get(v)?.clone() else { continue };
            let e = old.exponent(pivot);
            if e.is_zero() {
                continue;
            }
            self.work += old.unknown.len() + value.unknown.len();
            if self.work > MAX_WORK {
                return None;
            }
            let new = old.times_power(&Dimension::variable(pivot), e.negated())?.times_power(&value, e)?;
            self.set(v, new, &mut known);
        }
        self.set(pivot, value, &mut known);
        Some(known)
    }

    fn set(&mut self, v: Variable, value: Dimension, known: &mut Vec<Variable>) {
        if value.is_known() {
            known.push(v);
        }
        for (u, _) in &value.unknown {
            if let Some(uses) = self.uses.get_mut(*u)
                && uses.last() != Some(&v)
            {
                uses.push(v);
            }
        }
        if let Some(slot) = self.solution.get_mut(v) {
            *slot = Some(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENGTH: Dimension = Dimension::new(1, 0, 0);

    #[test]
    fn equations_are_solved_in_any_order() {
        let mut s = System::default();
        let [a, b, c] = [s.variable(), s.variable(), s.variable()].map(Dimension::variable);
        assert_eq!(s.equate(&a.times(&b).unwrap(), &c), Outcome::Holds(Vec::new()));
        assert_eq!(s.equate(&a, &b), Outcome::Holds(Vec::new()));
        // The root of an area is a length.
        let area = LENGTH.times(&LENGTH).unwrap();
        let Outcome::Holds(mut known) = s.equate(&c, &area) else { panic!("it is known") };
        known.sort_unstable();
        assert_eq!(known, [0, 1, 2]);
        assert_eq!(s.resolve(&a), Some(LENGTH));
        assert_eq!(s.equate(&a, &c), Outcome::Contradicts);
        assert_eq!(s.equate(&a, &LENGTH), Outcome::Holds(Vec::new()));
    }

    #[test]
    fn exponents_may_be_fractions() {
        let mut s = System::default();
        let a = Dimension::variable(s.variable());
        s.equate(&a.power(Ratio::integer(2)).unwrap(), &LENGTH);
        assert_eq!(s.resolve(&a).unwrap().base[0].parts(), (1, 2));
    }

    #[test]
    fn work_is_bounded() {
        let mut s = System::default();
        let all: Vec<Variable> = (0..3000).map(|_| s.variable()).collect();
        let product =
            Dimension { unknown: all.iter().map(|v| (*v, Ratio::ONE)).collect(), ..Dimension::new(0, 0, 0) };
        let limit_exceeded = (0..3000).any(|k| {
            let power = product.times_power(&Dimension::variable(k), Ratio::integer(k as i64)).unwrap();
            s.equate(&power, &LENGTH) == Outcome::LimitExceeded
        });
        assert!(limit_exceeded);
    }
}
