//! Representation of printed sums of products, and the order of their terms and factors.

use super::polynomial::{Atom, AtomRank, Monomial, Polynomial, Ring, Term, Wave};
use std::cmp::Reverse;

/// Relative difference below which coefficients count as equal.
const ROUNDING: f64 = 1e-9;

/// A term of a printed sum: `coefficient × factor × sums`.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintedTerm {
    /// Numeric factor of a printed product.
    pub coefficient: f64,
    /// Product of the factors that are atoms.
    pub factor: Monomial,
    /// Factors of a product that are sums in parentheses.
    pub sums: Vec<SumFactor>,
}

/// A sum in parentheses that is a factor of an item.
#[derive(Clone, Debug, PartialEq)]
pub struct SumFactor {
    /// Summands of a sum in parentheses, at least two.
    pub items: Vec<PrintedTerm>,
    /// Exponent of the sum in parentheses: one, or two for a square.
    pub power: u8,
}

impl PrintedTerm {
    /// Returns a product of a number and atoms, without sums.
    pub fn from_monomial(coefficient: f64, factor: Monomial) -> PrintedTerm {
        PrintedTerm { coefficient, factor, sums: Vec::new() }
    }
}

/// Order of the factors and terms of printed polynomials.
pub struct PrintOrder {
    /// All atoms of the ring, in the order in which factors are printed.
    pub atoms: Vec<usize>,
    /// Mask of the atoms that are velocities, functions of velocities, accelerations or inputs.
    pub rates: Monomial,
    /// Mask of the atoms that are generalized accelerations.
    pub accelerations: Monomial,
    /// Mask of the atoms that are functions of positions.
    pub functions: Monomial,
    /// Mask of the atoms of rank `Position`: coordinates and other symbols that vary in time.
    pub positions: Monomial,
    parameters: Monomial,
    /// For each atom, the number of names, numbers and functions in its printed form.
    sizes: Vec<usize>,
}

/// Returns the sort key of an atom: first its rank; then symbols before waves, which are sorted by angle,
/// before all other atoms. The inverse of a single atom has the key of that atom.
fn sort_key_of_atom(ring: &Ring, atom: usize) -> (AtomRank, u8, Vec<usize>) {
    let rank = ring.ranks[atom];
    match &ring.atoms[atom] {
        Atom::Symbol(s) => (rank, 0, vec![s.0 as usize]),
        Atom::Wave(w) => {
            let first = w.angle.iter().position(|n| *n != 0).unwrap_or(0);
            let rest = w.angle.iter().map(|n| usize::from(n.unsigned_abs()));
            let angle = std::iter::once(first).chain(rest).chain([usize::from(w.cosine)]);
            (rank, 1, angle.collect())
        }
        Atom::Inverse(p) => match p.terms.as_slice() {
            [t] => t
                .monomial
                .atoms_with_powers()
                .next()
                .map_or((rank, 2, vec![atom]), |(k, _)| sort_key_of_atom(ring, k)),
            _ => (rank, 2, vec![atom]),
        },
        _ => (rank, 2, vec![atom]),
    }
}

impl PrintOrder {
    /// Creates the printing order of the atoms of a ring.
    pub fn new(ring: &Ring) -> PrintOrder {
        let mut atoms: Vec<usize> = (0..ring.atoms.len()).collect();
        atoms.sort_by_cached_key(|k| sort_key_of_atom(ring, *k));
        PrintOrder {
            atoms,
            rates: ring.mask_of_selected_atoms(|_, rank| rank >= AtomRank::Rate),
            accelerations: ring.mask_of_selected_atoms(|_, rank| rank == AtomRank::Acceleration),
            functions: ring.mask_of_selected_atoms(|_, rank| rank == AtomRank::Function),
            positions: ring.mask_of_selected_atoms(|_, rank| rank == AtomRank::Position),
            parameters: ring.mask_of_selected_atoms(|_, rank| rank == AtomRank::Parameter),
            sizes: printed_atom_lengths(ring),
        }
    }

    /// Returns true if all factors of a sum are parameters.
    pub fn contains_only_parameters(&self, items: &[PrintedTerm]) -> bool {
        items.iter().all(|item| {
            item.factor.clear_mask(self.parameters) == Monomial::ONE
                && item.sums.iter().all(|sum| self.contains_only_parameters(&sum.items))
        })
    }

    /// Returns the printed length of a sum: the number of names, numbers and functions. Signs, exponents and
    /// parentheses do not count.
    pub fn printed_length(&self, items: &[PrintedTerm]) -> usize {
        items.iter().map(|item| self.printed_item_length(item)).sum()
    }

    fn printed_item_length(&self, item: &PrintedTerm) -> usize {
        let of_sums = item.sums.iter().map(|sum| self.printed_length(&sum.items)).sum::<usize>();
        let factors = printed_length_of_monomial(&self.sizes, item.factor) + of_sums;
        factors + usize::from(factors == 0 || !is_close(item.coefficient.abs(), 1.0))
    }

    /// Returns the factors of a monomial, atom and power, in printing order.
    pub fn factors_in_printing_order(&self, m: Monomial) -> Vec<(usize, u8)> {
        let powers = self.atoms.iter().map(|k| (*k, m.power_of_atom(*k)));
        powers.filter(|(_, n)| *n > 0).collect()
    }

    /// Returns the parameters in a monomial with their powers.
    pub fn parameters_of_monomial(&self, m: Monomial) -> Monomial {
        m.restrict_to_mask(self.parameters)
    }

    /// Sorts terms: ascending degree in functions of positions, then by their factors, high powers first.
    pub fn sort_terms_for_printing(&self, terms: &mut [Term]) {
        terms.sort_by_cached_key(|t| {
            let powers: Vec<Reverse<u8>> =
                self.atoms.iter().map(|k| Reverse(t.monomial.power_of_atom(*k))).collect();
            (t.monomial.restrict_to_mask(self.functions).degree(), powers)
        });
    }

    /// Sorts groups of terms: accelerations first, then rates, then positions, and high powers first.
    pub fn sort_term_groups(&self, ring: &Ring, groups: &mut [(Monomial, Vec<Term>)]) {
        groups.sort_by_cached_key(|(key, _)| {
            let rank = key.atoms_with_powers().map(|(k, _)| ring.ranks[k]).max();
            let powers: Vec<Reverse<u8>> =
                self.atoms.iter().map(|k| Reverse(key.power_of_atom(*k))).collect();
            (Reverse(rank), Reverse(key.restrict_to_mask(self.rates).degree()), powers)
        });
    }
}

/// Returns the printed length of each atom: its number of names, numbers and functions.
fn printed_atom_lengths(ring: &Ring) -> Vec<usize> {
    let mut sizes = Vec::with_capacity(ring.atoms.len());
    for atom in &ring.atoms {
        let printed_length_of_polynomial = |p: &Polynomial| -> usize {
            let numeric_factor_count =
                |t: &Term| usize::from(t.monomial == Monomial::ONE || !is_close(t.coefficient.abs(), 1.0));
            p.terms
                .iter()
                .map(|t| printed_length_of_monomial(&sizes, t.monomial) + numeric_factor_count(t))
                .sum()
        };
        let angle_term_count =
            |w: &Wave| w.angle.iter().map(|n| usize::from(*n != 0) + usize::from(n.abs() > 1)).sum::<usize>();
        let size = match atom {
            Atom::Symbol(_) => 1,
            Atom::Wave(w) => 1 + angle_term_count(w),
            Atom::Inverse(p) => printed_length_of_polynomial(p),
            Atom::Call(_, p) => 1 + printed_length_of_polynomial(p),
            Atom::Atan2(a, b) | Atom::Power(a, b) | Atom::Extreme(_, a, b) => {
                1 + printed_length_of_polynomial(a) + printed_length_of_polynomial(b)
            }
            Atom::Table(_, _, arguments) => {
                1 + arguments.iter().map(printed_length_of_polynomial).sum::<usize>()
            }
        };
        sizes.push(size);
    }
    sizes
}

fn printed_length_of_monomial(sizes: &[usize], m: Monomial) -> usize {
    m.atoms_with_powers().map(|(k, _)| sizes.get(k).copied().unwrap_or(1)).sum()
}

/// Returns true if two numbers differ by rounding error only.
pub fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * b.abs()
}

/// Returns the number to factor out of a sum with these coefficients: the sign if all signs agree, times a
/// magnitude if that leaves simpler coefficients.
pub fn common_number_factor(coefficients: impl Iterator<Item = f64> + Clone) -> f64 {
    let sign = if coefficients.clone().all(|c| c < 0.0) { -1.0 } else { 1.0 };
    let size = coefficients.clone().next().map_or(1.0, f64::abs);
    if coefficients.clone().all(|c| is_close(c.abs(), size)) {
        return sign * size;
    }
    let mut common: Option<(u32, u32)> = None;
    for c in coefficients {
        let Some((p, q)) = fraction_of_number(c.abs()) else { return sign };
        common = Some(
            common.map_or((p, q), |(a, b)| (greatest_common_divisor(a, p), greatest_common_divisor(b, q))),
        );
    }
    sign * common.map_or(1.0, |(p, q)| f64::from(p) / f64::from(q))
}

/// Returns the greatest common divisor of two numbers.
pub fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// Returns numerator and denominator of a positive number that is, up to rounding, a fraction with a
/// denominator made up of factors two and three, at most 48. The numerator is below 1000.
pub fn fraction_of_number(size: f64) -> Option<(u32, u32)> {
    [1_u32, 2, 3, 4, 6, 8, 12, 16, 24, 48].into_iter().find_map(|q| {
        let p = size * f64::from(q);
        let whole = p.round();
        ((1.0..1000.0).contains(&whole) && (p - whole).abs() <= 1e-11 * whole).then_some((whole as u32, q))
    })
}
