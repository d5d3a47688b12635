//! A polynomial as a person groups it: by rates, then by functions, each with the parameters' factors in front. Decides
//! the order in which terms and factors are read; makes no text.

use super::polynomial::{Atom, Monomial, Polynomial, Rank, Ring, Term};
use std::cmp::Reverse;

/// Relative difference of coefficients that are taken to be equal.
const ROUNDING: f64 = 1e-9;
/// Coefficients this much smaller than others of their kind are rounding.
const NOISE: f64 = 1e-11;

/// `coefficient × factor × (sum)^power`; no sum stands for one.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Numeric factor.
    pub coefficient: f64,
    /// Common factors.
    pub factor: Monomial,
    /// Two items or more, or none.
    pub sum: Vec<Item>,
    /// One, or two for a square.
    pub power: u8,
}

impl Item {
    /// One term.
    fn single(coefficient: f64, factor: Monomial) -> Item {
        Item { coefficient, factor, sum: Vec::new(), power: 1 }
    }
}

/// The order of reading.
pub struct Order {
    /// All atoms, from left to right.
    pub atoms: Vec<usize>,
    rates: Monomial,
    functions: Monomial,
    positions: Monomial,
    parameters: Monomial,
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
            functions: ring.mask(|_, rank| rank == Rank::Function),
            positions: ring.mask(|_, rank| rank == Rank::Position),
            parameters: ring.mask(|_, rank| rank == Rank::Parameter),
        }
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
    fn sort(&self, terms: &mut [Term]) {
        terms.sort_by_cached_key(|t| {
            let powers: Vec<Reverse<u8>> = self.atoms.iter().map(|k| Reverse(t.monomial.power(*k))).collect();
            (t.monomial.only(self.functions).degree(), powers)
        });
    }

    /// Accelerations first, then rates, then positions; high powers first.
    fn sort_groups(&self, ring: &Ring, groups: &mut [(Monomial, Vec<Term>)]) {
        groups.sort_by_cached_key(|(key, _)| {
            let rank = key.factors().map(|(k, _)| ring.ranks[k]).max();
            let powers: Vec<Reverse<u8>> = self.atoms.iter().map(|k| Reverse(key.power(*k))).collect();
            (Reverse(rank), Reverse(key.only(self.rates).degree()), powers)
        });
    }
}

/// A polynomial without terms that are only rounding: small against those with the same parameters and as many rates.
pub fn without_noise(ring: &Ring, p: &Polynomial) -> Polynomial {
    let parameters = ring.mask(|_, rank| rank == Rank::Parameter);
    let rates = ring.mask(|_, rank| rank >= Rank::Rate);
    let accelerations = ring.mask(|_, rank| rank == Rank::Acceleration);
    let kind = |t: &Term| {
        let rates = t.monomial.only(rates);
        (t.monomial.only(parameters), rates.degree(), rates.meets(accelerations))
    };
    let mut largest: Vec<((Monomial, u32, bool), f64)> = Vec::new();
    for term in &p.terms {
        let (kind, size) = (kind(term), term.coefficient.abs());
        match largest.iter_mut().find(|(k, _)| *k == kind) {
            Some((_, largest)) => *largest = largest.max(size),
            None => largest.push((kind, size)),
        }
    }
    let keep = |t: &&Term| {
        let kind = kind(t);
        largest.iter().all(|(k, size)| *k != kind || t.coefficient.abs() > NOISE * size)
    };
    Polynomial { terms: p.terms.iter().filter(keep).copied().collect() }
}

/// The items of a polynomial in the order of reading.
pub fn items(ring: &Ring, order: &Order, p: &Polynomial) -> Vec<Item> {
    let mut items = Vec::new();
    let mut groups = grouped(&p.terms, order.rates);
    order.sort_groups(ring, &mut groups);
    for (rates, terms) in groups {
        if rates != Monomial::ONE {
            items.push(item(order, &terms));
            continue;
        }
        let mut groups = grouped(&terms, order.functions);
        order.sort_groups(ring, &mut groups);
        groups.sort_by_key(|(functions, _)| *functions != Monomial::ONE);
        for (functions, terms) in groups {
            match functions {
                Monomial::ONE => plain_items(order, terms, &mut items),
                _ => items.push(item(order, &terms)),
            }
        }
    }
    items
}

/// Terms by the part of them that is in a mask.
fn grouped(terms: &[Term], mask: Monomial) -> Vec<(Monomial, Vec<Term>)> {
    let mut groups: Vec<(Monomial, Vec<Term>)> = Vec::new();
    for term in terms {
        let key = term.monomial.only(mask);
        match groups.iter_mut().find(|(k, _)| *k == key) {
            Some((_, group)) => group.push(*term),
            None => groups.push((key, vec![*term])),
        }
    }
    groups
}

/// Parameters and positions alone: squares of linear forms; then what has all its positions in common, and what has any
/// factor in common.
fn plain_items(order: &Order, mut terms: Vec<Term>, items: &mut Vec<Item>) {
    order.sort(&mut terms);
    while let Some(square) = terms.iter().find_map(|t| square(order, t, &terms)) {
        let all = expanded(&square);
        terms.retain(|t| !all.iter().any(|s| s.monomial == t.monomial));
        items.push(square);
    }
    let (alike, mut terms): (Vec<_>, Vec<_>) = grouped(&terms, order.positions)
        .into_iter()
        .partition(|(positions, group)| *positions != Monomial::ONE && group.len() > 1);
    items.extend(alike.iter().map(|(_, group)| item(order, group)));
    let mut terms: Vec<Term> = terms.drain(..).flat_map(|(_, group)| group).collect();
    while let Some(first) = terms.first().copied() {
        let count = |k: usize| terms.iter().filter(|t| t.monomial.power(k) > 0).count();
        let of_first = order.factors(first.monomial).into_iter().map(|(k, _)| k);
        let best = of_first.rev().max_by_key(|k| count(*k));
        let (group, rest) =
            terms.iter().copied().partition(|t| *t == first || best.is_some_and(|k| t.monomial.power(k) > 0));
        let group: Vec<Term> = group;
        items.push(item(order, &group));
        terms = rest;
    }
}

/// The square of a sum that starts with the position whose square is in `leading`, if all of it is there.
fn square(order: &Order, leading: &Term, terms: &[Term]) -> Option<Item> {
    let positions = leading.monomial.only(order.positions);
    let (x, _) = positions.factors().find(|(_, power)| *power == 2)?;
    let rest = leading.monomial.over(Monomial::atom(x));
    let mut sum = vec![Item::single(1.0, Monomial::atom(x))];
    for t in terms.iter().filter(|t| *t != leading && rest.divides(t.monomial)) {
        let coefficient = 0.5 * t.coefficient / leading.coefficient;
        sum.push(Item::single(coefficient, t.monomial.over(rest)));
    }
    let factor = rest.over(Monomial::atom(x));
    let square = Item { coefficient: leading.coefficient, factor, sum, power: 2 };
    let there =
        |s: &Term| terms.iter().any(|t| t.monomial == s.monomial && near(t.coefficient, s.coefficient));
    (square.sum.len() > 1 && expanded(&square).iter().all(there)).then_some(square)
}

/// The terms of a square of single terms.
fn expanded(square: &Item) -> Vec<Term> {
    let mut terms = Vec::new();
    for (i, a) in square.sum.iter().enumerate() {
        for (j, b) in square.sum.iter().enumerate().skip(i) {
            let twice = if i == j { 1.0 } else { 2.0 };
            let product = a.factor.times(b.factor).and_then(|m| m.times(square.factor));
            if let Some(monomial) = product {
                let coefficient = twice * square.coefficient * a.coefficient * b.coefficient;
                terms.push(Term { monomial, coefficient });
            }
        }
    }
    terms
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * b.abs()
}

/// What all terms have in common, times what is left. What is left is grouped once more by functions.
fn item(order: &Order, terms: &[Term]) -> Item {
    let first = terms.first().map_or(Monomial::ONE, |t| t.monomial);
    let factor = terms.iter().fold(first, |m, t| m.common(t.monomial));
    if let [only] = terms {
        return Item::single(only.coefficient, factor);
    }
    let mut terms = terms.to_vec();
    order.sort(&mut terms);
    let coefficient = common_number(&terms);
    for t in &mut terms {
        *t = Term { monomial: t.monomial.over(factor), coefficient: t.coefficient / coefficient };
    }
    let mut sum = Vec::new();
    for (functions, group) in grouped(&terms, order.functions) {
        if functions != Monomial::ONE && group.len() < terms.len() {
            sum.push(item(order, &group));
        } else {
            sum.extend(group.iter().map(|t| Item::single(t.coefficient, t.monomial)));
        }
    }
    // A sum in parentheses starts with something positive.
    if let Some(positive) = sum.iter().position(|t| t.coefficient > 0.0) {
        sum[..=positive].rotate_right(1);
    }
    Item { coefficient, factor, sum, power: 1 }
}

/// The number to take out of a sum: its sign if all agree, and its size where that leaves simpler numbers.
fn common_number(terms: &[Term]) -> f64 {
    let sign = if terms.iter().all(|t| t.coefficient < 0.0) { -1.0 } else { 1.0 };
    let size = terms.first().map_or(1.0, |t| t.coefficient.abs());
    if terms.iter().all(|t| near(t.coefficient.abs(), size)) {
        return sign * size;
    }
    let mut common: Option<(u32, u32)> = None;
    for t in terms {
        let Some((p, q)) = fraction(t.coefficient.abs()) else { return sign };
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
