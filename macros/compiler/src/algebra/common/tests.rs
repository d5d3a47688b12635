//! Tests of factored sums against the polynomials that they represent.

use super::*;
use crate::algebra::factor::items;
use crate::algebra::polynomial::tests::Random;
use crate::algebra::polynomial::{Atom, Polynomial, Rank, Ring, Term};
use crate::expr::node::Symbol;

/// Returns a ring with four parameters, two positions, two rates and an acceleration.
fn ring() -> Ring {
    let mut ring = Ring::new(|s| match s.0 {
        0..4 => Rank::Parameter,
        4..6 => Rank::Position,
        6..8 => Rank::Rate,
        _ => Rank::Acceleration,
    });
    (0..9).for_each(|k| _ = ring.atom(Atom::Symbol(Symbol(k))).unwrap());
    ring
}

fn value(items: &[Item], atoms: &[f64]) -> f64 {
    let power_of_atom = |(k, n): (usize, u8)| atoms[k].powi(n.into());
    let item_value = |item: &Item| {
        let sums = item.sums.iter().map(|sum| value(&sum.items, atoms).powi(sum.power.into()));
        item.coefficient * item.factor.factors().map(power_of_atom).product::<f64>() * sums.product::<f64>()
    };
    items.iter().map(item_value).sum()
}

fn times(ring: &mut Ring, all: &[&Polynomial]) -> Polynomial {
    let one = Polynomial::number(1.0);
    all.iter().fold(one, |p, factor| ring.times(&p, factor).unwrap())
}

/// Returns a random polynomial with at most `most` terms and small integer coefficients.
fn random(r: &mut Random, most: u64) -> Polynomial {
    let terms = (0..1 + r.number_below(most)).map(|_| {
        let atoms = (0..1 + r.number_below(3)).map(|_| Monomial::atom(r.number_below(9) as usize));
        let monomial = atoms.fold(Monomial::ONE, |m, atom| m.times(atom).unwrap());
        Term { monomial, coefficient: [1.0, -1.0, 2.0, 0.5, -3.0][r.number_below(5) as usize] }
    });
    Polynomial::sum(terms.collect())
}

#[test]
fn factored_sums_are_what_they_were() {
    let mut ring = ring();
    let mut r = Random(77);
    let (mut shorter, atoms) = (0, [0.3, 1.7, -0.9, 2.2, 0.7, -1.3, 1.1, 0.6, -0.4]);
    for _ in 0..300 {
        let (a, b, c) = (random(&mut r, 4), random(&mut r, 4), random(&mut r, 6));
        let product = times(&mut ring, &[&a, &b]);
        let p = ring.plus(&product, &c).unwrap();
        let expected = ring.evaluate(&p, &|s| atoms[s.0 as usize]);
        let order = Order::new(&ring);
        let plain: usize =
            p.terms.iter().map(|t| order.size(&[Item::single(t.coefficient, t.monomial)])).sum();
        for scope in [FactorScope::All, FactorScope::Kinds, FactorScope::None] {
            let found = items(&ring, &order, &p, scope);
            let size = p.terms.iter().map(|t| t.coefficient.abs()).sum::<f64>().max(1.0);
            assert!((value(&found, &atoms) - expected).abs() < 1e-10 * size, "{found:?}");
            assert!(order.size(&found) <= plain, "{found:?}");
            assert!(found.iter().all(|item| nested(item) <= NESTED), "{found:?}");
            shorter += usize::from(order.size(&found) < plain);
        }
    }
    assert!(shorter > 600, "{shorter}");
}

/// Expands `(a + b) (c + d)` and recovers the factors.
#[test]
fn products_of_sums_are_found() {
    let mut ring = ring();
    let sum_of_two_terms = |i, j, sign| Polynomial::sum(vec![term(i, 1.0), term(j, sign)]);
    let p = times(&mut ring, &[&sum_of_two_terms(0, 1, 1.0), &sum_of_two_terms(2, 3, -1.0)]);
    let found = items(&ring, &Order::new(&ring), &p, FactorScope::All);
    assert!(found.len() == 1 && found[0].sums.len() == 2, "{found:?}");
}

fn term(atom: usize, coefficient: f64) -> Term {
    Term { monomial: Monomial::atom(atom), coefficient }
}

/// Kinetic and potential energy have no common factors taken out, nor have the coefficients of a linear form.
#[test]
fn what_is_apart_stays_apart() {
    let mut ring = ring();
    let [m, g, x, v] = [0, 1, 4, 6].map(|k| Polynomial::sum(vec![term(k, 1.0)]));
    let kinetic = times(&mut ring, &[&m, &v, &v]);
    let potential = times(&mut ring, &[&m, &g, &x]);
    let energy = kinetic.plus(&potential);
    let order = Order::new(&ring);
    assert_eq!(items(&ring, &order, &energy, FactorScope::Kinds).len(), 2);
    assert_eq!(items(&ring, &order, &energy, FactorScope::None).len(), 2);
    assert_eq!(items(&ring, &order, &energy, FactorScope::All).len(), 1);
}
