//! Tests of factored sums against the polynomials that they represent.

use super::*;
use crate::algebra::factor::items_of_polynomial;
use crate::algebra::polynomial::tests::Random;
use crate::algebra::polynomial::{Atom, AtomRank, Polynomial, Ring, Term};
use crate::expr::node::Symbol;

/// Returns a ring with four parameters, two positions, two rates and an acceleration.
fn ring_with_nine_atoms() -> Ring {
    let mut ring = Ring::new(|s| match s.0 {
        0..4 => AtomRank::Parameter,
        4..6 => AtomRank::Position,
        6..8 => AtomRank::Rate,
        _ => AtomRank::Acceleration,
    });
    (0..9).for_each(|k| _ = ring.intern_atom_as_monomial(Atom::Symbol(Symbol(k))).unwrap());
    ring
}

fn value_of_items(items: &[PrintedTerm], atoms: &[f64]) -> f64 {
    let value_of_atom_power = |(k, n): (usize, u8)| atoms[k].powi(n.into());
    let item_value = |item: &PrintedTerm| {
        let sums = item.sums.iter().map(|sum| value_of_items(&sum.items, atoms).powi(sum.power.into()));
        item.coefficient
            * item.factor.atoms_with_powers().map(value_of_atom_power).product::<f64>()
            * sums.product::<f64>()
    };
    items.iter().map(item_value).sum()
}

fn product_of_polynomials(ring: &mut Ring, all: &[&Polynomial]) -> Polynomial {
    let one = Polynomial::from_number(1.0);
    all.iter().fold(one, |p, factor| ring.multiply_and_reduce(&p, factor).unwrap())
}

/// Returns a random polynomial with at most `most` terms and small integer coefficients.
fn random_polynomial(r: &mut Random, most: u64) -> Polynomial {
    let terms = (0..1 + r.random_number_below(most)).map(|_| {
        let atoms = (0..1 + r.random_number_below(3))
            .map(|_| Monomial::first_power_of_atom(r.random_number_below(9) as usize));
        let monomial = atoms.fold(Monomial::ONE, |m, atom| m.checked_product(atom).unwrap());
        Term { monomial, coefficient: [1.0, -1.0, 2.0, 0.5, -3.0][r.random_number_below(5) as usize] }
    });
    Polynomial::sum_of_terms(terms.collect())
}

#[test]
fn factored_sums_keep_their_values() {
    let mut ring = ring_with_nine_atoms();
    let mut r = Random(77);
    let (mut shorter, atoms) = (0, [0.3, 1.7, -0.9, 2.2, 0.7, -1.3, 1.1, 0.6, -0.4]);
    for _ in 0..300 {
        let (a, b, c) =
            (random_polynomial(&mut r, 4), random_polynomial(&mut r, 4), random_polynomial(&mut r, 6));
        let product = product_of_polynomials(&mut ring, &[&a, &b]);
        let p = ring.add_within_limits(&product, &c).unwrap();
        let expected = ring.evaluate_polynomial(&p, &|s| atoms[s.0 as usize]);
        let order = PrintOrder::new(&ring);
        let plain: usize = p
            .terms
            .iter()
            .map(|t| order.printed_length(&[PrintedTerm::from_monomial(t.coefficient, t.monomial)]))
            .sum();
        for scope in [FactorScope::All, FactorScope::Kinds, FactorScope::None] {
            let found = items_of_polynomial(&ring, &order, &p, scope);
            let size = p.terms.iter().map(|t| t.coefficient.abs()).sum::<f64>().max(1.0);
            assert!((value_of_items(&found, &atoms) - expected).abs() < 1e-10 * size, "{found:?}");
            assert!(order.printed_length(&found) <= plain, "{found:?}");
            assert!(found.iter().all(|item| nesting_depth(item) <= NESTED), "{found:?}");
            shorter += usize::from(order.printed_length(&found) < plain);
        }
    }
    assert!(shorter > 600, "{shorter}");
}

/// Expands `(a + b) (c + d)` and recovers the factors.
#[test]
fn factors_of_expanded_products_are_recovered() {
    let mut ring = ring_with_nine_atoms();
    let sum_of_two_terms =
        |i, j, sign| Polynomial::sum_of_terms(vec![term_of_atom(i, 1.0), term_of_atom(j, sign)]);
    let p = product_of_polynomials(&mut ring, &[&sum_of_two_terms(0, 1, 1.0), &sum_of_two_terms(2, 3, -1.0)]);
    let found = items_of_polynomial(&ring, &PrintOrder::new(&ring), &p, FactorScope::All);
    assert!(found.len() == 1 && found[0].sums.len() == 2, "{found:?}");
}

fn term_of_atom(atom: usize, coefficient: f64) -> Term {
    Term { monomial: Monomial::first_power_of_atom(atom), coefficient }
}

/// Kinetic and potential energy have no common factors taken out, nor have the coefficients of a linear form.
#[test]
fn factor_scope_limits_common_factors() {
    let mut ring = ring_with_nine_atoms();
    let [m, g, x, v] = [0, 1, 4, 6].map(|k| Polynomial::sum_of_terms(vec![term_of_atom(k, 1.0)]));
    let kinetic = product_of_polynomials(&mut ring, &[&m, &v, &v]);
    let potential = product_of_polynomials(&mut ring, &[&m, &g, &x]);
    let energy = kinetic.plus(&potential);
    let order = PrintOrder::new(&ring);
    assert_eq!(items_of_polynomial(&ring, &order, &energy, FactorScope::Kinds).len(), 2);
    assert_eq!(items_of_polynomial(&ring, &order, &energy, FactorScope::None).len(), 2);
    assert_eq!(items_of_polynomial(&ring, &order, &energy, FactorScope::All).len(), 1);
}
