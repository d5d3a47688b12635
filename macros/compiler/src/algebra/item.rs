//! Sums of products as they are read, and the order of reading.

use super::polynomial::{Atom, Monomial, Polynomial, Rank, Ring, Term, Wave};
use std::cmp::Reverse;

/// Relative difference of coefficients that are taken to be equal.
const ROUNDING: f64 = 1e-9;

/// `coefficient × factor × sums`.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Numeric factor.
    pub coefficient: f64,
    /// Factors that are atoms.
    pub factor: Monomial,
    /// Factors that are sums.
    pub sums: Vec<Sum>,
}

/// A sum as a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Sum {
    /// Two items or more.
    pub items: Vec<Item>,
    /// One, or two for a square.
    pub power: u8,
}

impl Item {
    /// One term.
    pub fn single(coefficient: f64, factor: Monomial) -> Item {
        Item { coefficient, factor, sums: Vec::new() }
    }
}

/// The order of reading.
pub struct Order {
    /// All atoms, from left to right.
    pub atoms: Vec<usize>,
    /// Everything that has to do with rates, accelerations among them.
    pub rates: Monomial,
    /// Accelerations.
    pub accelerations: Monomial,
    /// Functions of positions.
    pub functions: Monomial,
    /// Positions.
    pub positions: Monomial,
    parameters: Monomial,
    /// By atom, of how many symbols it is written.
    sizes: Vec<usize>,
}

/// Where an atom stands: by rank; symbols before waves in order of their angles, before all else. An inverse of an atom
/// stands where that atom does.
fn place(ring: &Ring, atom: usize) -> (Rank, u8, Vec<usize>) {
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
            [t] => t.monomial.factors().next().map_or((rank, 2, vec![atom]), |(k, _)| place(ring, k)),
            _ => (rank, 2, vec![atom]),
        },
        _ => (rank, 2, vec![atom]),
    }
}

impl Order {
    /// The order of the atoms of a ring.
    pub fn of(ring: &Ring) -> Order {
        let mut atoms: Vec<usize> = (0..ring.atoms.len()).collect();
        atoms.sort_by_cached_key(|k| place(ring, *k));
        Order {
            atoms,
            rates: ring.mask(|_, rank| rank >= Rank::Rate),
            accelerations: ring.mask(|_, rank| rank == Rank::Acceleration),
            functions: ring.mask(|_, rank| rank == Rank::Function),
            positions: ring.mask(|_, rank| rank == Rank::Position),
            parameters: ring.mask(|_, rank| rank == Rank::Parameter),
            sizes: sizes(ring),
        }
    }

    /// True if nothing but parameters stands in a sum.
    pub fn is_constant(&self, items: &[Item]) -> bool {
        items.iter().all(|item| {
            item.factor.without(self.parameters) == Monomial::ONE
                && item.sums.iter().all(|sum| self.is_constant(&sum.items))
        })
    }

    /// Of how many symbols a sum is written: names, numbers and functions, not signs, exponents and parentheses.
    pub fn size(&self, items: &[Item]) -> usize {
        items.iter().map(|item| self.size_of(item)).sum()
    }

    fn size_of(&self, item: &Item) -> usize {
        let of_sums = item.sums.iter().map(|sum| self.size(&sum.items)).sum::<usize>();
        let factors = size_of_monomial(&self.sizes, item.factor) + of_sums;
        factors + usize::from(factors == 0 || !near(item.coefficient.abs(), 1.0))
    }

    /// The factors of a monomial from left to right.
    pub fn factors(&self, m: Monomial) -> Vec<(usize, u8)> {
        let powers = self.atoms.iter().map(|k| (*k, m.power(*k)));
        powers.filter(|(_, n)| *n > 0).collect()
    }

    /// The parameters of a monomial.
    pub fn parameters(&self, m: Monomial) -> Monomial {
        m.only(self.parameters)
    }

    /// Terms without functions first, then in the order of their factors, high powers first.
    pub fn sort(&self, terms: &mut [Term]) {
        terms.sort_by_cached_key(|t| {
            let powers: Vec<Reverse<u8>> = self.atoms.iter().map(|k| Reverse(t.monomial.power(*k))).collect();
            (t.monomial.only(self.functions).degree(), powers)
        });
    }

    /// Accelerations first, then rates, then positions; high powers first.
    pub fn sort_groups(&self, ring: &Ring, groups: &mut [(Monomial, Vec<Term>)]) {
        groups.sort_by_cached_key(|(key, _)| {
            let rank = key.factors().map(|(k, _)| ring.ranks[k]).max();
            let powers: Vec<Reverse<u8>> = self.atoms.iter().map(|k| Reverse(key.power(*k))).collect();
            (Reverse(rank), Reverse(key.only(self.rates).degree()), powers)
        });
    }
}

/// By atom, of how many symbols it is written.
fn sizes(ring: &Ring) -> Vec<usize> {
    let mut sizes = Vec::with_capacity(ring.atoms.len());
    for atom in &ring.atoms {
        let of = |p: &Polynomial| -> usize {
            let number =
                |t: &Term| usize::from(t.monomial == Monomial::ONE || !near(t.coefficient.abs(), 1.0));
            p.terms.iter().map(|t| size_of_monomial(&sizes, t.monomial) + number(t)).sum()
        };
        let angle =
            |w: &Wave| w.angle.iter().map(|n| usize::from(*n != 0) + usize::from(n.abs() > 1)).sum::<usize>();
        let size = match atom {
            Atom::Symbol(_) => 1,
            Atom::Wave(w) => 1 + angle(w),
            Atom::Inverse(p) => of(p),
            Atom::Call(_, p) => 1 + of(p),
            Atom::Atan2(a, b) | Atom::Power(a, b) | Atom::Extreme(_, a, b) => 1 + of(a) + of(b),
            Atom::Table(_, _, arguments) => 1 + arguments.iter().map(of).sum::<usize>(),
        };
        sizes.push(size);
    }
    sizes
}

fn size_of_monomial(sizes: &[usize], m: Monomial) -> usize {
    m.factors().map(|(k, _)| sizes.get(k).copied().unwrap_or(1)).sum()
}

/// True if two numbers differ by rounding.
pub fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * b.abs()
}

/// The number to take out of a sum with these coefficients: its sign if all agree, and its size where that leaves simpler
/// numbers.
pub fn common_number(coefficients: impl Iterator<Item = f64> + Clone) -> f64 {
    let sign = if coefficients.clone().all(|c| c < 0.0) { -1.0 } else { 1.0 };
    let size = coefficients.clone().next().map_or(1.0, f64::abs);
    if coefficients.clone().all(|c| near(c.abs(), size)) {
        return sign * size;
    }
    let mut common: Option<(u32, u32)> = None;
    for c in coefficients {
        let Some((p, q)) = fraction(c.abs()) else { return sign };
        common = Some(common.map_or((p, q), |(a, b)| (gcd(a, p), gcd(b, q))));
    }
    sign * common.map_or(1.0, |(p, q)| f64::from(p) / f64::from(q))
}

/// The greatest common divisor.
pub fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Numerator and denominator of what looks like a fraction: of halves, thirds and their products.
pub fn fraction(size: f64) -> Option<(u32, u32)> {
    [1_u32, 2, 3, 4, 6, 8, 12, 16, 24, 48].into_iter().find_map(|q| {
        let p = size * f64::from(q);
        let whole = p.round();
        ((1.0..1000.0).contains(&whole) && (p - whole).abs() <= 1e-11 * whole).then_some((whole as u32, q))
    })
}
