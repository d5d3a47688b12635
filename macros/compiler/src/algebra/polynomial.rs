//! Polynomials over atoms, the form in which small expressions are printed: sums of monomials with numeric
//! coefficients. An atom is a symbol, a sine or cosine, an inverse, or another function, which is opaque.
//! Squares of sines and of square roots are replaced as soon as they occur, so that equal expressions get
//! equal polynomials. Number of terms, atoms and steps are bounded: functions return `None` beyond these
//! limits.

use crate::expr::node::{Extreme, Function, Lookup, Symbol};

mod expression;
mod monomial;
#[cfg(test)]
pub(crate) mod tests;

pub use expression::polynomial_to_expression;
pub use monomial::{ATOMS, Monomial};

/// Maximum number of terms of a polynomial.
pub const TERMS: usize = 400;
/// Maximum number of distinct angles of a ring.
pub const ANGLES: usize = 8;
/// Maximum number of steps of a whole derivation. A step takes about a microsecond in an unoptimised build.
const WORK: usize = 40_000;
/// Factor by which the limits are raised for equations that the user requests.
const MORE: usize = 20;
/// A sum is rounding error, and set to zero, if its magnitude relative to its summands is at most this.
const ROUNDING: f64 = 1e-13;

/// Term of a polynomial: a monomial with its coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Product of powers of atoms in the term.
    pub monomial: Monomial,
    /// Coefficient of the term, never zero.
    pub coefficient: f64,
}

/// A sum of terms, sorted by monomial. No monomial occurs twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    /// Terms in ascending order of their monomials, without zeros.
    pub terms: Vec<Term>,
}

/// The sine or cosine of a sum of integer multiples of the ring's angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Wave {
    /// Integer multiple of each angle. The first one that is not zero is positive.
    pub angle: [i8; ANGLES],
    /// True for the cosine of an angle, false for the sine.
    pub cosine: bool,
}

/// Indivisible factor of monomials.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it all")]
pub enum Atom {
    Symbol(Symbol),
    Wave(Wave),
    Inverse(Polynomial),
    Call(Function, Polynomial),
    Atan2(Polynomial, Polynomial),
    Power(Polynomial, Polynomial),
    Extreme(Extreme, Polynomial, Polynomial),
    Table(String, Lookup, Vec<Polynomial>),
}

/// Position of an atom in a printed product, in ascending order from left to right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AtomRank {
    /// Constant in time: a parameter, or a function of parameters.
    Parameter,
    /// A position, or another symbol that varies in time.
    Position,
    /// Function of coordinates, such as a sine.
    Function,
    /// Velocity, or a function of velocities.
    Rate,
    /// Generalized acceleration.
    Acceleration,
    /// Input of the mechanism, such as a force.
    Input,
}

/// Atoms of a family of polynomials, with the rewrite rules for their products.
pub struct Ring {
    /// The atoms. The arguments of an atom contain earlier atoms only.
    pub atoms: Vec<Atom>,
    /// Printing rank of each atom.
    pub ranks: Vec<AtomRank>,
    /// For each atom, the number of terms written in its arguments.
    written: Vec<usize>,
    /// The angles whose sines and cosines occur: a coefficient times a monomial each.
    pub angles: Vec<Term>,
    rank: fn(Symbol) -> AtomRank,
    /// Atoms whose squares are replaced, with the polynomial that replaces the square.
    squares: Vec<(usize, Polynomial)>,
    /// Mask of all powers above one of the atoms in `squares`: a monomial that intersects the mask contains
    /// such a square.
    squared: Monomial,
    /// Pairs of atoms whose product is one, such as a root and its inverse.
    inverses: Vec<(usize, usize)>,
    /// Atoms `1 / sin` of an angle, each followed by the atoms of the cosine and the sine of the angle.
    cosecants: Vec<[usize; 3]>,
    work: usize,
    /// Current limit on the number of terms of a polynomial.
    terms: usize,
}

impl Polynomial {
    /// Returns a constant polynomial.
    pub fn from_number(value: f64) -> Polynomial {
        Polynomial::from_term(Monomial::ONE, value)
    }

    /// Returns the polynomial of one term, which is zero if the coefficient is zero.
    pub fn from_term(monomial: Monomial, coefficient: f64) -> Polynomial {
        let terms = if coefficient == 0.0 { Vec::new() } else { vec![Term { monomial, coefficient }] };
        Polynomial { terms }
    }

    /// Adds terms in any order; terms with equal monomials are merged.
    pub fn sum_of_terms(mut terms: Vec<Term>) -> Polynomial {
        terms.sort_by_key(|t| t.monomial);
        let mut sum: Vec<Term> = Vec::with_capacity(terms.len());
        for term in terms {
            match sum.last_mut() {
                Some(last) if last.monomial == term.monomial => {
                    last.coefficient = add_without_rounding_noise(last.coefficient, term.coefficient);
                }
                _ => sum.push(term),
            }
        }
        sum.retain(|t| t.coefficient != 0.0);
        Polynomial { terms: sum }
    }

    /// Adds two polynomials.
    pub fn plus(&self, other: &Polynomial) -> Polynomial {
        let (a, b) = (&self.terms, &other.terms);
        let mut terms = Vec::with_capacity(a.len() + b.len());
        let (mut i, mut j) = (0, 0);
        while i < a.len() && j < b.len() {
            let (s, t) = (a[i], b[j]);
            if s.monomial == t.monomial {
                let coefficient = add_without_rounding_noise(s.coefficient, t.coefficient);
                if coefficient != 0.0 {
                    terms.push(Term { coefficient, ..s });
                }
                (i, j) = (i + 1, j + 1);
            } else if s.monomial < t.monomial {
                terms.push(s);
                i += 1;
            } else {
                terms.push(t);
                j += 1;
            }
        }
        terms.extend_from_slice(&a[i..]);
        terms.extend_from_slice(&b[j..]);
        Polynomial { terms }
    }

    /// Multiplies a polynomial by a number.
    pub fn multiplied_by_number(&self, factor: f64) -> Polynomial {
        let scale_term = |t: &Term| Term { coefficient: t.coefficient * factor, ..*t };
        Polynomial { terms: self.terms.iter().map(scale_term).collect() }
    }

    /// Multiplies a polynomial by one term. This preserves the order of the monomials. `None` if a power
    /// overflows.
    fn multiply_by_term(&self, factor: &Term) -> Option<Polynomial> {
        let mut terms = Vec::with_capacity(self.terms.len());
        for t in &self.terms {
            let monomial = t.monomial.checked_product(factor.monomial)?;
            terms.push(Term { monomial, coefficient: t.coefficient * factor.coefficient });
        }
        Some(Polynomial { terms })
    }
}

/// Adds two numbers. Returns zero if the sum is only rounding error.
fn add_without_rounding_noise(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if sum.abs() <= ROUNDING * a.abs().max(b.abs()) { 0.0 } else { sum }
}

impl Ring {
    /// Creates a ring without atoms. `rank` returns the rank of a symbol.
    pub fn new(rank: fn(Symbol) -> AtomRank) -> Ring {
        Ring {
            atoms: Vec::new(),
            ranks: Vec::new(),
            written: Vec::new(),
            angles: Vec::new(),
            rank,
            squares: Vec::new(),
            squared: Monomial::ONE,
            inverses: Vec::new(),
            cosecants: Vec::new(),
            work: WORK,
            terms: TERMS,
        }
    }

    /// Raises the limits of the ring to those for equations that the user requests.
    pub fn raise_term_limits(&mut self) {
        (self.work, self.terms) = (MORE * WORK, MORE * TERMS);
    }

    /// Subtracts steps from the remaining work. `None` if fewer remain.
    pub fn spend_steps(&mut self, steps: usize) -> Option<()> {
        self.work = self.work.checked_sub(steps)?;
        Some(())
    }

    /// Returns an atom as a monomial and adds the atom to the ring if it is new. `None` beyond the maximum
    /// number of atoms.
    pub fn intern_atom_as_monomial(&mut self, atom: Atom) -> Option<Monomial> {
        let known = self.atoms.iter().position(|a| *a == atom);
        let index = match known {
            Some(index) => index,
            None => self.add_atom(atom)?,
        };
        Some(Monomial::first_power_of_atom(index))
    }

    fn add_atom(&mut self, atom: Atom) -> Option<usize> {
        let index = self.atoms.len();
        if index == ATOMS {
            return None;
        }
        if let Atom::Call(Function::Sqrt, radicand) = &atom {
            self.squares.push((index, radicand.clone()));
            self.squared = self.squared.union_of_bits(Monomial::bits_above_first_power(index));
        }
        if let Atom::Inverse(p) = &atom
            && let [term] = p.terms.as_slice()
            && let Some(inverse) = term.monomial.atoms_with_powers().next()
        {
            self.inverses.push((inverse.0, index));
            if let Some(Atom::Wave(wave)) = self.atoms.get(inverse.0)
                && !wave.cosine
                && let Some(cosine) =
                    self.atoms.iter().position(|a| *a == Atom::Wave(Wave { cosine: true, ..*wave }))
            {
                self.cosecants.push([index, cosine, inverse.0]);
            }
        }
        self.ranks.push(self.rank_of_atom(&atom));
        self.written.push(self.count_printed_argument_terms(&atom));
        self.atoms.push(atom);
        Some(index)
    }

    /// Returns the number of terms of a polynomial in printed form. Terms in the arguments of functions, also
    /// nested ones, are counted at each occurrence. The count saturates.
    pub fn printed_term_count(&self, p: &Polynomial) -> usize {
        let nested =
            p.terms.iter().flat_map(|t| t.monomial.atoms_with_powers()).map(|(k, _)| self.written[k]);
        nested.fold(p.terms.len(), usize::saturating_add)
    }

    fn count_printed_argument_terms(&self, atom: &Atom) -> usize {
        match atom {
            Atom::Symbol(_) | Atom::Wave(_) => 0,
            Atom::Inverse(p) | Atom::Call(_, p) => self.printed_term_count(p),
            Atom::Atan2(p, q) | Atom::Power(p, q) | Atom::Extreme(_, p, q) => {
                self.printed_term_count(p).saturating_add(self.printed_term_count(q))
            }
            Atom::Table(.., arguments) => {
                arguments.iter().map(|p| self.printed_term_count(p)).fold(0, usize::saturating_add)
            }
        }
    }

    fn rank_of_atom(&self, atom: &Atom) -> AtomRank {
        let highest_rank_of_monomial = |m: Monomial| m.atoms_with_powers().map(|(k, _)| self.ranks[k]).max();
        let rank_of_polynomial =
            |p: &Polynomial| p.terms.iter().filter_map(|t| highest_rank_of_monomial(t.monomial)).max();
        let argument = match atom {
            Atom::Symbol(s) => return (self.rank)(*s),
            Atom::Inverse(p) => return rank_of_polynomial(p).unwrap_or(AtomRank::Parameter),
            Atom::Wave(w) => {
                let angles = self.angles.iter().zip(w.angle).filter(|(_, n)| *n != 0);
                angles.filter_map(|(a, _)| highest_rank_of_monomial(a.monomial)).max()
            }
            Atom::Call(_, p) => rank_of_polynomial(p),
            Atom::Table(.., arguments) => arguments.iter().filter_map(rank_of_polynomial).max(),
            Atom::Atan2(p, q) | Atom::Power(p, q) | Atom::Extreme(_, p, q) => {
                rank_of_polynomial(p).max(rank_of_polynomial(q))
            }
        };
        match argument {
            None | Some(AtomRank::Parameter) => AtomRank::Parameter,
            Some(AtomRank::Position | AtomRank::Function) => AtomRank::Function,
            Some(_) => AtomRank::Rate,
        }
    }

    /// Returns the index of an angle. A new angle is added to the ring with its sine and cosine; `None`
    /// beyond the maximum number of angles.
    pub fn find_or_add_angle(&mut self, angle: Term) -> Option<usize> {
        if let Some(index) = self.angles.iter().position(|a| *a == angle) {
            return Some(index);
        }
        let index = self.angles.len();
        if index == ANGLES {
            return None;
        }
        self.angles.push(angle);
        let sine = self.sine_or_cosine(index, false)?;
        let cosine = self.sine_or_cosine(index, true)?;
        let (sine, _) = sine.atoms_with_powers().next()?;
        let rest = Polynomial::sum_of_terms(vec![
            Term { monomial: Monomial::ONE, coefficient: 1.0 },
            Term { monomial: cosine.checked_product(cosine)?, coefficient: -1.0 },
        ]);
        self.squares.push((sine, rest));
        self.squared = self.squared.union_of_bits(Monomial::bits_above_first_power(sine));
        Some(index)
    }

    /// Returns the sine or cosine of the angle with this index as a monomial.
    pub fn sine_or_cosine(&mut self, index: usize, cosine: bool) -> Option<Monomial> {
        let mut angle = [0; ANGLES];
        angle[index] = 1;
        self.intern_atom_as_monomial(Atom::Wave(Wave { angle, cosine }))
    }

    /// Adds two polynomials. `None` if the sum exceeds the limits.
    pub fn add_within_limits(&mut self, a: &Polynomial, b: &Polynomial) -> Option<Polynomial> {
        self.spend_steps(a.terms.len() + b.terms.len())?;
        let sum = a.plus(b);
        (sum.terms.len() <= self.terms).then_some(sum)
    }

    /// Multiplies two polynomials and reduces the product. `None` beyond the limits.
    pub fn multiply_and_reduce(&mut self, a: &Polynomial, b: &Polynomial) -> Option<Polynomial> {
        let (few, many) = if a.terms.len() < b.terms.len() { (a, b) } else { (b, a) };
        let mut product = Polynomial::default();
        for (k, term) in few.terms.iter().enumerate() {
            self.spend_steps(many.terms.len())?;
            let row = many.multiply_by_term(term)?;
            product = if k == 0 { row } else { self.add_within_limits(&product, &row)? };
        }
        self.reduce_powers(product)
    }

    /// Replaces squares of sines and square roots, and products of an atom and its inverse, until none is
    /// left.
    fn reduce_powers(&mut self, mut p: Polynomial) -> Option<Polynomial> {
        loop {
            let is_reducible_term = |t: &Term| {
                t.monomial.intersects_mask(self.squared)
                    || self.cancelling_atom_pair(t.monomial).is_some()
                    || self.find_cosine_squared_over_sine(t.monomial).is_some()
            };
            if !p.terms.iter().any(is_reducible_term) {
                return (p.terms.len() <= self.terms).then_some(p);
            }
            let mut terms = Vec::with_capacity(p.terms.len() + 4);
            for term in &p.terms {
                terms.extend(self.rewrite_term(term)?.terms);
            }
            self.spend_steps(4 * terms.len())?;
            p = Polynomial::sum_of_terms(terms);
        }
    }

    fn cancelling_atom_pair(&self, m: Monomial) -> Option<Monomial> {
        let pair = self.inverses.iter().find(|(a, b)| m.power_of_atom(*a) > 0 && m.power_of_atom(*b) > 0)?;
        Monomial::first_power_of_atom(pair.0).checked_product(Monomial::first_power_of_atom(pair.1))
    }

    /// Returns the cosecant, cosine and sine atoms of a factor `cos² / sin` in `m`, which equals
    /// `1 / sin − sin`. Elsewhere squares of sines are replaced by squares of cosines, so that without this
    /// rule such terms would not cancel.
    fn find_cosine_squared_over_sine(&self, m: Monomial) -> Option<[usize; 3]> {
        self.cosecants
            .iter()
            .find(|[inverse, cosine, _]| m.power_of_atom(*inverse) > 0 && m.power_of_atom(*cosine) > 1)
            .copied()
    }

    /// Applies one rewrite rule to a term. Returns the term unchanged if no rule applies.
    fn rewrite_term(&self, term: &Term) -> Option<Polynomial> {
        let Term { monomial, coefficient } = *term;
        if let Some(one) = self.cancelling_atom_pair(monomial) {
            return Some(Polynomial::from_term(monomial.quotient(one), coefficient));
        }
        if let Some([inverse, cosine, sine]) = self.find_cosine_squared_over_sine(monomial) {
            let square = Monomial::first_power_of_atom(cosine)
                .checked_product(Monomial::first_power_of_atom(cosine))?;
            let one = monomial.quotient(square);
            let rest = one
                .quotient(Monomial::first_power_of_atom(inverse))
                .checked_product(Monomial::first_power_of_atom(sine))?;
            return Some(Polynomial::sum_of_terms(vec![
                Term { monomial: one, coefficient },
                Term { monomial: rest, coefficient: -coefficient },
            ]));
        }
        match self.squares.iter().find(|(atom, _)| monomial.power_of_atom(*atom) > 1) {
            Some((atom, square)) => {
                let atom = Monomial::first_power_of_atom(*atom);
                square.multiply_by_term(&Term {
                    monomial: monomial.quotient(atom.checked_product(atom)?),
                    coefficient,
                })
            }
            None => Some(Polynomial { terms: vec![*term] }),
        }
    }

    /// Returns a mask with all bits of the powers of the atoms for which `holds` is true.
    pub fn mask_of_selected_atoms(&self, holds: impl Fn(&Atom, AtomRank) -> bool) -> Monomial {
        let atoms = self.atoms.iter().zip(&self.ranks).enumerate();
        atoms
            .filter(|(_, (a, r))| holds(a, **r))
            .fold(Monomial::ONE, |m, (k, _)| m.union_of_bits(Monomial::power_mask_of_atom(k)))
    }

    /// Evaluates a polynomial at these values of the symbols.
    pub fn evaluate_polynomial(&self, p: &Polynomial, symbol: &dyn Fn(Symbol) -> f64) -> f64 {
        let mut values: Vec<f64> = Vec::with_capacity(self.atoms.len());
        for atom in &self.atoms {
            let value_of_polynomial = |p: &Polynomial| polynomial_value_at_atoms(p, &values);
            values.push(match atom {
                Atom::Symbol(s) => symbol(*s),
                Atom::Wave(w) => {
                    let angles = self.angles.iter().zip(w.angle).filter(|(_, n)| *n != 0);
                    let angle = angles.map(|(a, n)| f64::from(n) * term_value(a, &values)).sum::<f64>();
                    if w.cosine { libm::cos(angle) } else { libm::sin(angle) }
                }
                Atom::Inverse(p) => 1.0 / value_of_polynomial(p),
                Atom::Call(f, p) => f.evaluate_at(value_of_polynomial(p)),
                Atom::Atan2(y, x) => libm::atan2(value_of_polynomial(y), value_of_polynomial(x)),
                Atom::Power(a, b) => libm::pow(value_of_polynomial(a), value_of_polynomial(b)),
                Atom::Extreme(f, a, b) => f.evaluate_extreme(value_of_polynomial(a), value_of_polynomial(b)),
                Atom::Table(_, lookup, x) => lookup
                    .evaluate_surrogate(std::array::from_fn(|k| x.get(k).map_or(0.0, value_of_polynomial))),
            });
        }
        polynomial_value_at_atoms(p, &values)
    }
}

fn polynomial_value_at_atoms(p: &Polynomial, atoms: &[f64]) -> f64 {
    p.terms.iter().map(|t| term_value(t, atoms)).sum()
}

fn term_value(t: &Term, atoms: &[f64]) -> f64 {
    t.monomial.atoms_with_powers().fold(t.coefficient, |v, (k, n)| (0..n).fold(v, |v, _| v * atoms[k]))
}
