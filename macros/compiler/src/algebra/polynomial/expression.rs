//! Conversion of polynomials to expressions.

use super::{Atom, Polynomial, Ring, Wave};
use crate::expr::{Expr, Graph};

/// Converts a polynomial to an expression of `graph`.
pub fn polynomial_to_expression<'g>(graph: &'g Graph, ring: &Ring, p: &Polynomial) -> Expr<'g> {
    let mut sum = graph.zero();
    for term in &p.terms {
        let mut product = graph.num(term.coefficient);
        for (atom, power) in term.monomial.atoms_with_powers() {
            let base = match &ring.atoms[atom] {
                Atom::Symbol(s) => graph.symbol(*s),
                Atom::Wave(w) => {
                    let angle = wave_angle(graph, ring, w);
                    if w.cosine { angle.cos() } else { angle.sin() }
                }
                Atom::Inverse(p) => graph.one() / polynomial_to_expression(graph, ring, p),
                Atom::Call(f, p) => polynomial_to_expression(graph, ring, p).apply_function(*f),
                Atom::Atan2(y, x) => {
                    polynomial_to_expression(graph, ring, y).atan2(polynomial_to_expression(graph, ring, x))
                }
                Atom::Power(a, b) => {
                    polynomial_to_expression(graph, ring, a).pow(polynomial_to_expression(graph, ring, b))
                }
                Atom::Table(_, lookup, x) => {
                    let table_argument_or_zero = |k: usize| {
                        x.get(k).map_or(graph.zero(), |x| polynomial_to_expression(graph, ring, x))
                    };
                    graph.table_lookup(
                        *lookup,
                        [table_argument_or_zero(0), table_argument_or_zero(1), table_argument_or_zero(2)],
                    )
                }
                Atom::Extreme(f, a, b) => polynomial_to_expression(graph, ring, a)
                    .minimum_or_maximum(*f, polynomial_to_expression(graph, ring, b)),
            };
            product = (0..power).fold(product, |p, _| p * base);
        }
        sum += product;
    }
    sum
}

fn wave_angle<'g>(graph: &'g Graph, ring: &Ring, wave: &Wave) -> Expr<'g> {
    let angles = ring.angles.iter().zip(wave.angle).filter(|(_, n)| *n != 0);
    angles.fold(graph.zero(), |sum, (angle, n)| {
        let angle = Polynomial { terms: vec![*angle] };
        sum + polynomial_to_expression(graph, ring, &angle) * f64::from(n)
    })
}
