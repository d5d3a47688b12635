//! Conversion of polynomials to expressions.

use super::{Atom, Polynomial, Ring, Wave};
use crate::expr::{Expr, Graph};

/// Builds a polynomial as an expression of `graph`.
pub fn expression<'g>(graph: &'g Graph, ring: &Ring, p: &Polynomial) -> Expr<'g> {
    let mut sum = graph.zero();
    for term in &p.terms {
        let mut product = graph.num(term.coefficient);
        for (atom, power) in term.monomial.factors() {
            let base = match &ring.atoms[atom] {
                Atom::Symbol(s) => graph.symbol(*s),
                Atom::Wave(w) => {
                    let angle = wave_angle(graph, ring, w);
                    if w.cosine { angle.cos() } else { angle.sin() }
                }
                Atom::Inverse(p) => graph.one() / expression(graph, ring, p),
                Atom::Call(f, p) => expression(graph, ring, p).call(*f),
                Atom::Atan2(y, x) => expression(graph, ring, y).atan2(expression(graph, ring, x)),
                Atom::Power(a, b) => expression(graph, ring, a).pow(expression(graph, ring, b)),
                Atom::Table(_, lookup, x) => {
                    let argument_expression =
                        |k: usize| x.get(k).map_or(graph.zero(), |x| expression(graph, ring, x));
                    graph.lookup(
                        *lookup,
                        [argument_expression(0), argument_expression(1), argument_expression(2)],
                    )
                }
                Atom::Extreme(f, a, b) => expression(graph, ring, a).extreme(*f, expression(graph, ring, b)),
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
        sum + expression(graph, ring, &angle) * f64::from(n)
    })
}
