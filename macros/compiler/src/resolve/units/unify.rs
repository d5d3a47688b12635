//! Dimensions with unknowns, and linear equations between them: unification over exponent vectors of length,
//! mass and time.

use crate::language::dimension::{Dimension, UnknownDimensionIndex};
use crate::language::ratio::Ratio;

/// Result of the addition of an equation to the system.
#[derive(Debug, PartialEq, Eq)]
pub enum EquationOutcome {
    /// The equation is consistent; the unknowns that it determined.
    Holds(Vec<UnknownDimensionIndex>),
    /// The equation contradicts earlier equations.
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
pub struct DimensionSystem {
    solution: Vec<Option<Dimension>>,
    /// For each unsolved unknown, the solved unknowns whose solutions contain it; the list may include
    /// solutions that no longer contain it.
    uses: Vec<Vec<UnknownDimensionIndex>>,
    work: usize,
}

impl DimensionSystem {
    /// Adds an unknown dimension to the system.
    pub fn add_unknown_dimension(&mut self) -> UnknownDimensionIndex {
        self.solution.push(None);
        self.uses.push(Vec::new());
        self.solution.len() - 1
    }

    /// Returns a dimension in terms of unsolved unknowns; `None` if the limit of work is exceeded.
    pub fn substitute_solved_unknowns(&mut self, dimension: &Dimension) -> Option<Dimension> {
        let mut sum = Dimension { unknown: Vec::new(), ..dimension.clone() };
        for (v, e) in &dimension.unknown {
            self.work += 1 + sum.unknown.len();
            if self.work > MAX_WORK {
                return None;
            }
            sum = match self.solution.get(*v)? {
                Some(known) => sum.times_power(known, *e)?,
                None => sum.times_power(&Dimension::unknown_dimension(*v), *e)?,
            };
        }
        Some(sum)
    }

    /// Adds the equation that two dimensions are equal.
    pub fn equate_dimensions(&mut self, a: &Dimension, b: &Dimension) -> EquationOutcome {
        let quotient =
            a.dimension_of_quotient(b).and_then(|quotient| self.substitute_solved_unknowns(&quotient));
        let Some(quotient) = quotient else { return EquationOutcome::LimitExceeded };
        match quotient.unknown.last() {
            None if quotient.is_plain() => EquationOutcome::Holds(Vec::new()),
            None => EquationOutcome::Contradicts,
            Some((pivot, exponent)) => self
                .solve_for_variable(*pivot, *exponent, &quotient)
                .map_or(EquationOutcome::LimitExceeded, EquationOutcome::Holds),
        }
    }

    /// Solves `quotient = 1` for one of its unknowns, and substitutes the solution.
    fn solve_for_variable(
        &mut self,
        pivot: UnknownDimensionIndex,
        exponent: Ratio,
        quotient: &Dimension,
    ) -> Option<Vec<UnknownDimensionIndex>> {
        let rest = quotient.times_power(&Dimension::unknown_dimension(pivot), exponent.negative_ratio())?;
        let value = rest.dimension_of_power(exponent.negative_ratio().inverse()?)?;
        let mut known = Vec::new();
        for v in std::mem::take(self.uses.get_mut(pivot)?) {
            let Some(old) = self.solution.get(v)?.clone() else { continue };
            let e = old.exponent_of_unknown(pivot);
            if e.is_zero() {
                continue;
            }
            self.work += old.unknown.len() + value.unknown.len();
            if self.work > MAX_WORK {
                return None;
            }
            let new = old
                .times_power(&Dimension::unknown_dimension(pivot), e.negative_ratio())?
                .times_power(&value, e)?;
            self.set_solved_dimension(v, new, &mut known);
        }
        self.set_solved_dimension(pivot, value, &mut known);
        Some(known)
    }

    fn set_solved_dimension(
        &mut self,
        v: UnknownDimensionIndex,
        value: Dimension,
        known: &mut Vec<UnknownDimensionIndex>,
    ) {
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
        let mut s = DimensionSystem::default();
        let [a, b, c] = [s.add_unknown_dimension(), s.add_unknown_dimension(), s.add_unknown_dimension()]
            .map(Dimension::unknown_dimension);
        assert_eq!(
            s.equate_dimensions(&a.dimension_of_product(&b).unwrap(), &c),
            EquationOutcome::Holds(Vec::new())
        );
        assert_eq!(s.equate_dimensions(&a, &b), EquationOutcome::Holds(Vec::new()));
        // The root of an area is a length.
        let area = LENGTH.dimension_of_product(&LENGTH).unwrap();
        let EquationOutcome::Holds(mut known) = s.equate_dimensions(&c, &area) else { panic!("it is known") };
        known.sort_unstable();
        assert_eq!(known, [0, 1, 2]);
        assert_eq!(s.substitute_solved_unknowns(&a), Some(LENGTH));
        assert_eq!(s.equate_dimensions(&a, &c), EquationOutcome::Contradicts);
        assert_eq!(s.equate_dimensions(&a, &LENGTH), EquationOutcome::Holds(Vec::new()));
    }

    #[test]
    fn exponents_may_be_fractions() {
        let mut s = DimensionSystem::default();
        let a = Dimension::unknown_dimension(s.add_unknown_dimension());
        s.equate_dimensions(&a.dimension_of_power(Ratio::from_integer(2)).unwrap(), &LENGTH);
        assert_eq!(s.substitute_solved_unknowns(&a).unwrap().base[0].numerator_and_denominator(), (1, 2));
    }

    #[test]
    fn unit_unification_work_is_bounded() {
        let mut s = DimensionSystem::default();
        let all: Vec<UnknownDimensionIndex> = (0..3000).map(|_| s.add_unknown_dimension()).collect();
        let product =
            Dimension { unknown: all.iter().map(|v| (*v, Ratio::ONE)).collect(), ..Dimension::new(0, 0, 0) };
        let limit_exceeded = (0..3000).any(|k| {
            let power =
                product.times_power(&Dimension::unknown_dimension(k), Ratio::from_integer(k as i64)).unwrap();
            s.equate_dimensions(&power, &LENGTH) == EquationOutcome::LimitExceeded
        });
        assert!(limit_exceeded);
    }
}
