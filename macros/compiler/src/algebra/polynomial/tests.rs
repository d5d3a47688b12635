//! Compares normal forms with the evaluated expressions, for selected and for random expressions.

use super::*;
use crate::algebra::normal::NormalFormCache;
use crate::algebra::trigonometry::simplify_trigonometry;
use crate::expr::eval::eval_one;
use crate::expr::{Expr, Graph};

/// Returns the rank of a symbol: the first three are parameters, all others positions.
pub fn rank_of_symbol(symbol: Symbol) -> AtomRank {
    if symbol.0 < 3 { AtomRank::Parameter } else { AtomRank::Position }
}

fn test_number_of_symbol(symbol: Symbol) -> f64 {
    0.37 + 0.61 * f64::from(symbol.0)
}

/// Reproducible pseudorandom generator (xorshift).
pub struct Random(pub u64);

impl Random {
    pub fn random_number_below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 20) % n
    }
}

fn random_expression<'g>(graph: &'g Graph, r: &mut Random, depth: u32, functions: bool) -> Expr<'g> {
    let pick = if depth == 0 { 0 } else { r.random_number_below(if functions { 12 } else { 9 }) };
    let random_subexpression = |r: &mut Random| random_expression(graph, r, depth - 1, functions);
    match pick {
        0 if r.random_number_below(4) == 0 => graph.num(r.random_number_below(9) as f64 - 4.0),
        0 => graph.symbol(Symbol(r.random_number_below(6) as u32)),
        1 | 2 => random_subexpression(r) + random_subexpression(r),
        3 | 4 => random_subexpression(r) - random_subexpression(r),
        5 | 6 => random_subexpression(r) * random_subexpression(r),
        7 | 8 => {
            let angle = graph.symbol(Symbol(3 + r.random_number_below(2) as u32));
            let angle = if r.random_number_below(3) == 0 { angle - graph.symbol(Symbol(5)) } else { angle };
            if r.random_number_below(2) == 0 { angle.sin() } else { angle.cos() }
        }
        9 => random_subexpression(r) / (random_subexpression(r).square() + graph.one()),
        10 => (random_subexpression(r).square() + graph.one()).sqrt(),
        _ => random_subexpression(r).apply_function(Function::Tanh),
    }
}

fn assert_near(a: f64, b: f64, what: &str) {
    assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{a} instead of {b}: {what}");
}

#[test]
fn normal_forms_keep_values_of_random_expressions() {
    let mut r = Random(0x9E37_79B9_7F4A_7C15);
    let mut found = 0;
    for _ in 0..400 {
        let graph = Graph::new();
        let e = random_expression(&graph, &mut r, 5, true);
        let expected = eval_one(e, &test_number_of_symbol);
        let mut normal = NormalFormCache::new(&graph, rank_of_symbol);
        let Some(p) = normal.normal_form(e) else { continue };
        assert_near(normal.ring.evaluate_polynomial(&p, &test_number_of_symbol), expected, &format!("{e:?}"));
        let Some(short) = simplify_trigonometry(&mut normal.ring, &p) else { continue };
        assert!(short.terms.len() <= p.terms.len());
        assert_near(
            normal.ring.evaluate_polynomial(&short, &test_number_of_symbol),
            expected,
            &format!("{e:?}"),
        );
        found += 1;
    }
    assert!(found > 300, "only {found} of 400 are within the limits");
}

/// The normal form of a normal form is identical to it.
#[test]
fn normal_form_is_idempotent() {
    let mut r = Random(77);
    for _ in 0..200 {
        let graph = Graph::new();
        let e = random_expression(&graph, &mut r, 5, false);
        let mut normal = NormalFormCache::new(&graph, rank_of_symbol);
        let Some(p) = normal.normal_form(e) else { continue };
        let Some(short) = simplify_trigonometry(&mut normal.ring, &p) else { continue };
        let again = normal.normal_form(polynomial_to_expression(&graph, &normal.ring, &short)).unwrap();
        assert_same_polynomial(&p, &again);
        let shorter = simplify_trigonometry(&mut normal.ring, &again).unwrap();
        assert_same_polynomial(&short, &shorter);
    }
}

fn assert_same_polynomial(a: &Polynomial, b: &Polynomial) {
    assert_eq!(a.terms.len(), b.terms.len(), "{a:?} {b:?}");
    for (s, t) in a.terms.iter().zip(&b.terms) {
        assert_eq!(s.monomial, t.monomial);
        assert_near(s.coefficient, t.coefficient, "coefficient");
    }
}

fn assert_term_counts_are_zero(build: impl Fn(&Graph, [Expr<'_>; 3]) -> Vec<usize>) {
    let graph = Graph::new();
    let symbols = [3, 4, 5].map(|k| graph.symbol(Symbol(k)));
    assert!(build(&graph, symbols).iter().all(|terms| *terms == 0));
}

#[test]
fn algebraic_identities_reduce_to_zero() {
    assert_term_counts_are_zero(|graph, [x, y, z]| {
        let zeros = [
            (x + y) * (x - y) - (x.square() - y.square()),
            (x + y).pow(graph.num(3.0)) - (x * x * x + x * x * y * 3.0 + x * y * y * 3.0 + y * y * y),
            x.sin().square() + x.cos().square() - graph.one(),
            (x + y).sin() - x.sin() * y.cos() - x.cos() * y.sin(),
            (x - y + z).cos().square() + (x - y + z).sin().square() - graph.one(),
            (x * 2.0).sin() - x.sin() * x.cos() * 2.0,
            (x + graph.num(0.3)).sin().square() + (x + graph.num(0.3)).cos().square() - graph.one(),
            x * y / (x * z) - y / z,
            (x.square() + y).sqrt().square() - x.square() - y,
            graph.num(0.1) * x + graph.num(0.2) * x - graph.num(0.3) * x,
        ];
        let mut normal = NormalFormCache::new(graph, rank_of_symbol);
        zeros.iter().map(|e| normal.normal_form(*e).unwrap().terms.len()).collect()
    });
}

#[test]
fn monomial_products_and_quotients_add_exponents() {
    let (x, y) = (Monomial::first_power_of_atom(2), Monomial::first_power_of_atom(40));
    let product = x.checked_product(x).and_then(|m| m.checked_product(y)).unwrap();
    assert_eq!(product.atoms_with_powers().collect::<Vec<_>>(), [(2, 2), (40, 1)]);
    assert_eq!(product.quotient(x), x.checked_product(y).unwrap());
    assert!(
        x.is_divisor_of(product)
            && !product.is_divisor_of(x)
            && !Monomial::first_power_of_atom(3).is_divisor_of(product)
    );
    assert_eq!(
        product.greatest_common_divisor(x.checked_product(Monomial::first_power_of_atom(3)).unwrap()),
        x
    );
    assert_eq!(product.degree(), 3);
    assert_eq!((0..8).try_fold(Monomial::ONE, |m, _| m.checked_product(x)), None);
}

#[test]
fn polynomials_beyond_the_limits_are_abandoned() {
    let graph = Graph::new();
    let sum = (0..6).fold(graph.one(), |s, k| s + graph.symbol(Symbol(k)));
    let mut normal = NormalFormCache::new(&graph, rank_of_symbol);
    assert_eq!(normal.normal_form(sum).unwrap().terms.len(), 7);
    assert!(normal.normal_form(sum.pow(graph.num(7.0))).is_none());
    let atoms = (0..70).fold(graph.one(), |s, k| s + graph.symbol(Symbol(k)));
    assert!(NormalFormCache::new(&graph, rank_of_symbol).normal_form(atoms).is_none());
    let angles = (0..9).fold(graph.one(), |s, k| s + graph.symbol(Symbol(k)).sin());
    assert!(NormalFormCache::new(&graph, rank_of_symbol).normal_form(angles).is_none());
    assert!(NormalFormCache::new(&graph, rank_of_symbol).normal_form(graph.one() / graph.zero()).is_none());
}
