//! Simplification of polynomials on a unit sphere: the squares of some symbols, such as the components of a
//! unit quaternion, sum to one. Terms with a common factor and all four squares therefore reduce to that
//! factor.

use super::polynomial::{Atom, Monomial, Polynomial, Ring, Term};
use crate::expr::node::Symbol;

/// Relative difference below which coefficients count as equal.
const ROUNDING: f64 = 1e-11;

/// Returns a polynomial that equals `p` where the squares of `symbols` sum to one, with fewer terms if one is
/// found. Returns `p` itself if the ring lacks one of the symbols, and `None` if the work limit of the ring
/// is exceeded.
pub fn simplify_on_unit_sphere(ring: &mut Ring, p: &Polynomial, symbols: &[Symbol]) -> Option<Polynomial> {
    let index_of_symbol_atom = |s: &Symbol| ring.atoms.iter().position(|atom| *atom == Atom::Symbol(*s));
    let Some(atoms) = symbols.iter().map(index_of_symbol_atom).collect::<Option<Vec<usize>>>() else {
        return Some(p.clone());
    };
    let squares: Option<Vec<Monomial>> = atoms
        .iter()
        .map(|k| Monomial::first_power_of_atom(*k).checked_product(Monomial::first_power_of_atom(*k)))
        .collect();
    let (squares, mut terms) = (squares?, p.terms.clone());
    loop {
        let heads = terms.iter().flat_map(|t| {
            squares.iter().filter(|s| s.is_divisor_of(t.monomial)).map(|s| t.monomial.quotient(*s))
        });
        let mut heads: Vec<Monomial> = heads.collect();
        heads.sort_unstable();
        heads.dedup();
        ring.spend_steps(heads.len() * terms.len())?;
        let Some(shorter) = heads.iter().find_map(|head| shorten_by_unit_norm(&terms, *head, &squares))
        else {
            return Some(Polynomial::sum_of_terms(terms));
        };
        terms = shorter;
    }
}

/// Returns the terms with a multiple of `h (1 − x² − y² − …)` added, where `h` is `head`, if that leaves
/// fewer terms. The terms affected are `a h x² + b h y² + … + c h`.
fn shorten_by_unit_norm(terms: &[Term], head: Monomial, squares: &[Monomial]) -> Option<Vec<Term>> {
    let places: Vec<Monomial> =
        squares.iter().filter_map(|s| head.checked_product(*s)).chain([head]).collect();
    let coefficient_of_monomial =
        |m: &Monomial| terms.iter().find(|t| t.monomial == *m).map_or(0.0, |t| t.coefficient);
    let before: Vec<f64> = places.iter().map(coefficient_of_monomial).collect();
    let count_nonzero = |list: &[f64]| list.iter().filter(|c| **c != 0.0).count();
    let size = before.iter().fold(0.0, |size: f64, c| size.max(c.abs()));
    let round_noise_to_zero = |c: f64| if c.abs() <= ROUNDING * size { 0.0 } else { c };
    let last = before.len().checked_sub(1)?;
    let tries = before.iter().enumerate().map(|(k, c)| if k == last { -c } else { *c });
    let moved = tries.map(|shift| -> Vec<f64> {
        let all = before.iter().enumerate();
        all.map(|(k, c)| round_noise_to_zero(if k == last { c + shift } else { c - shift })).collect()
    });
    let best = moved
        .min_by_key(|list| count_nonzero(list))
        .filter(|list| count_nonzero(list) < count_nonzero(&before))?;
    let mut out: Vec<Term> = terms.iter().filter(|t| !places.contains(&t.monomial)).copied().collect();
    let kept = places.iter().zip(best).filter(|(_, coefficient)| *coefficient != 0.0);
    out.extend(kept.map(|(monomial, coefficient)| Term { monomial: *monomial, coefficient }));
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::polynomial::AtomRank;

    /// Checks simplifications of polynomials in the four components of a unit quaternion.
    #[test]
    fn unit_quaternion_norm_simplifies_polynomials() {
        let mut ring = Ring::new(|_| AtomRank::Position);
        let symbols = [0, 1, 2, 3].map(Symbol);
        let q = symbols.map(|s| ring.intern_atom_as_monomial(Atom::Symbol(s)).unwrap());
        let quaternion_monomial =
            |list: &[usize]| list.iter().try_fold(Monomial::ONE, |m, k| m.checked_product(q[*k])).unwrap();
        let polynomial_in_quaternion = |list: &[(f64, &[usize])]| {
            let terms = list.iter().map(|(c, m)| Term { monomial: quaternion_monomial(m), coefficient: *c });
            Polynomial::sum_of_terms(terms.collect())
        };
        for (from, to) in [
            (
                polynomial_in_quaternion(&[(2.0, &[0, 0]), (2.0, &[1, 1]), (2.0, &[2, 2]), (2.0, &[3, 3])]),
                polynomial_in_quaternion(&[(2.0, &[])]),
            ),
            (
                polynomial_in_quaternion(&[
                    (8.0, &[0, 0, 0, 1]),
                    (8.0, &[0, 1, 1, 1]),
                    (8.0, &[0, 1, 2, 2]),
                    (5.0, &[0, 1, 3, 3]),
                    (1.0, &[2]),
                ]),
                polynomial_in_quaternion(&[(8.0, &[0, 1]), (-3.0, &[0, 1, 3, 3]), (1.0, &[2])]),
            ),
            // One minus three of the squares is the fourth.
            (
                polynomial_in_quaternion(&[(1.0, &[]), (-1.0, &[0, 0]), (-1.0, &[1, 1]), (-1.0, &[2, 2])]),
                polynomial_in_quaternion(&[(1.0, &[3, 3])]),
            ),
            (
                polynomial_in_quaternion(&[(1.0, &[]), (-2.0, &[0, 0]), (-2.0, &[1, 1])]),
                polynomial_in_quaternion(&[(1.0, &[]), (-2.0, &[0, 0]), (-2.0, &[1, 1])]),
            ),
        ] {
            assert_eq!(simplify_on_unit_sphere(&mut ring, &from, &symbols), Some(to));
        }
    }
}
