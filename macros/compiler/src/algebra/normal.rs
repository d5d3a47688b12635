//! Conversion of expressions to polynomials in normal form. Products are expanded; sines and cosines of sums
//! are expressed in those of the summands.

use super::polynomial::{Atom, AtomRank, Monomial, Polynomial, Ring, Term};
use crate::expr::diff::TINY;
use crate::expr::node::{Function, Id, Node, Symbol};
use crate::expr::{Expr, Graph};

const UNKNOWN: u32 = u32::MAX;
/// Largest multiple of an angle whose sine and cosine are expanded in those of the angle itself.
const MULTIPLE: f64 = 4.0;

/// Cache of the polynomial normal forms of the expressions of one graph.
pub struct NormalFormCache<'g> {
    graph: &'g Graph,
    /// Ring of all cached polynomials.
    pub ring: Ring,
    /// Index in `polynomials` of each node, `UNKNOWN` if not yet computed.
    known: Vec<u32>,
    polynomials: Vec<Polynomial>,
}

impl<'g> NormalFormCache<'g> {
    /// Creates an empty cache. `rank` returns the rank of a symbol.
    pub fn new(graph: &'g Graph, rank: fn(Symbol) -> AtomRank) -> NormalFormCache<'g> {
        NormalFormCache { graph, ring: Ring::new(rank), known: Vec::new(), polynomials: Vec::new() }
    }

    /// Returns the normal form of `e`, `None` if it exceeds the limits of the ring.
    pub fn normal_form(&mut self, e: Expr<'g>) -> Option<Polynomial> {
        self.known.resize(self.known.len().max(e.id() as usize + 1), UNKNOWN);
        // Operands before operations, without recursion: a deep chain must not exhaust the stack.
        let mut todo = vec![e.id()];
        while let Some(&id) = todo.last() {
            if self.known[id as usize] != UNKNOWN {
                todo.pop();
                continue;
            }
            let before = todo.len();
            self.graph.node(id).visit_operands(|a| {
                if self.known[a as usize] == UNKNOWN {
                    todo.push(a);
                }
            });
            if todo.len() == before {
                self.ring.spend_steps(1)?;
                let polynomial = self.expand_node_to_polynomial(id)?;
                self.known[id as usize] = self.polynomials.len() as u32;
                self.polynomials.push(polynomial);
                todo.pop();
            }
        }
        Some(self.polynomials[self.known[e.id() as usize] as usize].clone())
    }

    fn expand_node_to_polynomial(&mut self, id: Id) -> Option<Polynomial> {
        let polynomial_of_node = |id: Id| &self.polynomials[self.known[id as usize] as usize];
        let atom = match self.graph.node(id) {
            // This constant only prevents NaN for the direction of a zero-length vector. The equations do not
            // contain it.
            Node::Const(c) if c == TINY => return Some(Polynomial::default()),
            Node::Const(c) => return c.is_finite().then(|| Polynomial::from_number(c)),
            Node::Neg(a) => return Some(polynomial_of_node(a).multiplied_by_number(-1.0)),
            Node::Add(a, b) => {
                return self.ring.add_within_limits(polynomial_of_node(a), polynomial_of_node(b));
            }
            Node::Sub(a, b) => {
                return self.ring.add_within_limits(
                    polynomial_of_node(a),
                    &polynomial_of_node(b).multiplied_by_number(-1.0),
                );
            }
            Node::Mul(a, b) => {
                return self.ring.multiply_and_reduce(polynomial_of_node(a), polynomial_of_node(b));
            }
            Node::Div(a, b) => {
                let inverse = inverse_of_polynomial(&mut self.ring, polynomial_of_node(b))?;
                return self.ring.multiply_and_reduce(polynomial_of_node(a), &inverse);
            }
            Node::Call(Function::Sin, a) => {
                return expand_sine_or_cosine(&mut self.ring, polynomial_of_node(a), false);
            }
            Node::Call(Function::Cos, a) => {
                return expand_sine_or_cosine(&mut self.ring, polynomial_of_node(a), true);
            }
            Node::Symbol(s) => Atom::Symbol(s),
            Node::Call(f, a) => Atom::Call(f, polynomial_of_node(a).clone()),
            Node::Atan2(a, b) => Atom::Atan2(polynomial_of_node(a).clone(), polynomial_of_node(b).clone()),
            Node::Extreme(f, a, b) => {
                Atom::Extreme(f, polynomial_of_node(a).clone(), polynomial_of_node(b).clone())
            }
            Node::Table(lookup, a, b, c) => {
                let arguments = [a, b, c].into_iter().take(lookup.variable_count());
                Atom::Table(
                    self.graph.table_name(lookup),
                    lookup,
                    arguments.map(|a| polynomial_of_node(a).clone()).collect(),
                )
            }
            Node::Pow(a, b) => Atom::Power(polynomial_of_node(a).clone(), polynomial_of_node(b).clone()),
            Node::Tuple(_) | Node::Gather(_) | Node::Sum(..) | Node::Lane(..) | Node::Join(..) => {
                return None;
            }
        };
        Some(Polynomial::from_term(self.ring.intern_atom_as_monomial(atom)?, 1.0))
    }
}

/// Expands the sine or cosine of a sum of angles: rotates a point on the unit circle by one angle after
/// another.
fn expand_sine_or_cosine(ring: &mut Ring, argument: &Polynomial, cosine: bool) -> Option<Polynomial> {
    let (mut cos, mut sin) = (Polynomial::from_number(1.0), Polynomial::default());
    for term in &argument.terms {
        let size = term.coefficient.abs();
        let whole = size.fract() == 0.0 && size <= MULTIPLE && term.monomial != Monomial::ONE;
        let (scale, times) = if whole { (1.0, size as usize) } else { (size, 1) };
        let angle = ring.find_or_add_angle(Term { coefficient: scale, ..*term })?;
        let c = Polynomial::from_term(ring.sine_or_cosine(angle, true)?, 1.0);
        let s = Polynomial::from_term(ring.sine_or_cosine(angle, false)?, term.coefficient.signum());
        for _ in 0..times {
            let (cc, ss) = (ring.multiply_and_reduce(&cos, &c)?, ring.multiply_and_reduce(&sin, &s)?);
            let (cs, sc) = (ring.multiply_and_reduce(&cos, &s)?, ring.multiply_and_reduce(&sin, &c)?);
            (cos, sin) = (
                ring.add_within_limits(&cc, &ss.multiplied_by_number(-1.0))?,
                ring.add_within_limits(&cs, &sc)?,
            );
        }
    }
    Some(if cosine { cos } else { sin })
}

/// Returns `1 / p`. The common factors of all terms are inverted one by one; if several terms remain after
/// that, the inverse of their sum is one atom.
pub fn inverse_of_polynomial(ring: &mut Ring, p: &Polynomial) -> Option<Polynomial> {
    let first = *p.terms.first()?;
    let common = p.terms.iter().fold(first.monomial, |m, t| m.greatest_common_divisor(t.monomial));
    let mut product = Monomial::ONE;
    for (atom, power) in common.atoms_with_powers() {
        let inverse = monomial_of_inverse_atom(ring, atom)?;
        for _ in 0..power {
            product = product.checked_product(inverse)?;
        }
    }
    if p.terms.len() > 1 {
        let rest = p.terms.iter().map(|t| Term {
            monomial: t.monomial.quotient(common),
            coefficient: t.coefficient / first.coefficient,
        });
        let rest = Polynomial { terms: rest.collect() };
        product = product.checked_product(ring.intern_atom_as_monomial(Atom::Inverse(rest))?)?;
    }
    Some(Polynomial::from_term(product, 1.0 / first.coefficient))
}

fn monomial_of_inverse_atom(ring: &mut Ring, atom: usize) -> Option<Monomial> {
    if let Some(Atom::Inverse(p)) = ring.atoms.get(atom)
        && let [term] = p.terms.as_slice()
    {
        return Some(term.monomial);
    }
    ring.intern_atom_as_monomial(Atom::Inverse(Polynomial::from_term(
        Monomial::first_power_of_atom(atom),
        1.0,
    )))
}
