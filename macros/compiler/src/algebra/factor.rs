//! Grouping of polynomials as in textbooks: by rates, then by functions of positions, with parameters as
//! common factors. Decides the order in which terms and factors are printed, but produces no text.

use super::common::{FactorScope, extract_common_factors_of_sum};
use super::item::{PrintOrder, PrintedTerm, SumFactor, common_number_factor, is_close};
use super::polynomial::{AtomRank, Monomial, Polynomial, Ring, Term};

/// Relative magnitude below which a coefficient counts as rounding error among similar terms.
const NOISE: f64 = 1e-11;

/// Removes terms that are rounding error: their coefficients are small relative to other terms with the same
/// parameters and the same degrees in velocities and accelerations.
pub fn remove_rounding_noise(ring: &Ring, p: &Polynomial) -> Polynomial {
    let parameters = ring.mask_of_selected_atoms(|_, rank| rank == AtomRank::Parameter);
    let rates = ring.mask_of_selected_atoms(|_, rank| rank >= AtomRank::Rate);
    let accelerations = ring.mask_of_selected_atoms(|_, rank| rank == AtomRank::Acceleration);
    let parameters_and_rate_degree = |t: &Term| {
        let rates = t.monomial.restrict_to_mask(rates);
        (t.monomial.restrict_to_mask(parameters), rates.degree(), rates.intersects_mask(accelerations))
    };
    let mut largest: Vec<((Monomial, u32, bool), f64)> = Vec::new();
    for term in &p.terms {
        let (kind, size) = (parameters_and_rate_degree(term), term.coefficient.abs());
        match largest.iter_mut().find(|(k, _)| *k == kind) {
            Some((_, largest)) => *largest = largest.max(size),
            None => largest.push((kind, size)),
        }
    }
    let is_above_rounding_noise = |t: &&Term| {
        let kind = parameters_and_rate_degree(t);
        largest.iter().all(|(k, size)| *k != kind || t.coefficient.abs() > NOISE * size)
    };
    Polynomial { terms: p.terms.iter().filter(is_above_rounding_noise).copied().collect() }
}

/// Returns the items of a polynomial in printing order. `scope` selects the items from which common factors
/// are taken out.
pub fn items_of_polynomial(
    ring: &Ring,
    order: &PrintOrder,
    p: &Polynomial,
    scope: FactorScope,
) -> Vec<PrintedTerm> {
    let mut items = Vec::new();
    let mut groups = group_terms_by_masked_factors(&p.terms, order.rates);
    order.sort_term_groups(ring, &mut groups);
    for (rates, terms) in groups {
        if rates != Monomial::ONE {
            items.push(factored_item(order, &terms));
            continue;
        }
        let mut groups = group_terms_by_masked_factors(&terms, order.functions);
        order.sort_term_groups(ring, &mut groups);
        groups.sort_by_key(|(functions, _)| *functions != Monomial::ONE);
        for (functions, terms) in groups {
            match functions {
                Monomial::ONE => append_rate_free_items(order, terms, &mut items),
                _ => items.push(factored_item(order, &terms)),
            }
        }
    }
    extract_common_factors_of_sum(order, items, scope)
}

/// Groups terms by the factors that are in a mask.
fn group_terms_by_masked_factors(terms: &[Term], mask: Monomial) -> Vec<(Monomial, Vec<Term>)> {
    let mut groups: Vec<(Monomial, Vec<Term>)> = Vec::new();
    for term in terms {
        let key = term.monomial.restrict_to_mask(mask);
        match groups.iter_mut().find(|(k, _)| *k == key) {
            Some((_, group)) => group.push(*term),
            None => groups.push((key, vec![*term])),
        }
    }
    groups
}

/// Appends the items of terms in parameters and positions alone: first squares of linear forms, then groups
/// with identical positions, then groups with any common factor.
fn append_rate_free_items(order: &PrintOrder, mut terms: Vec<Term>, items: &mut Vec<PrintedTerm>) {
    order.sort_terms_for_printing(&mut terms);
    while let Some(square) = terms.iter().find_map(|t| find_squared_sum(order, t, &terms)) {
        let all = expand_square(&square);
        terms.retain(|t| !all.iter().any(|s| s.monomial == t.monomial));
        items.push(square);
    }
    let (factored, mut terms): (Vec<_>, Vec<_>) = group_terms_by_masked_factors(&terms, order.positions)
        .into_iter()
        .partition(|(positions, group)| *positions != Monomial::ONE && group.len() > 1);
    items.extend(factored.iter().map(|(_, group)| factored_item(order, group)));
    let mut terms: Vec<Term> = terms.drain(..).flat_map(|(_, group)| group).collect();
    while let Some(first) = terms.first().copied() {
        let count_terms_with_atom =
            |k: usize| terms.iter().filter(|t| t.monomial.power_of_atom(k) > 0).count();
        let of_first = order.factors_in_printing_order(first.monomial).into_iter().map(|(k, _)| k);
        let best = of_first.rev().max_by_key(|k| count_terms_with_atom(*k));
        let (group, rest) = terms
            .iter()
            .copied()
            .partition(|t| *t == first || best.is_some_and(|k| t.monomial.power_of_atom(k) > 0));
        let group: Vec<Term> = group;
        items.push(factored_item(order, &group));
        terms = rest;
    }
}

/// Returns the square of a sum whose first summand is the squared position in `leading`, if all terms of the
/// expanded square are among `terms`.
fn find_squared_sum(order: &PrintOrder, leading: &Term, terms: &[Term]) -> Option<PrintedTerm> {
    let positions = leading.monomial.restrict_to_mask(order.positions);
    let (x, _) = positions.atoms_with_powers().find(|(_, power)| *power == 2)?;
    let rest = leading.monomial.quotient(Monomial::first_power_of_atom(x));
    let mut sum = vec![PrintedTerm::from_monomial(1.0, Monomial::first_power_of_atom(x))];
    for t in terms.iter().filter(|t| *t != leading && rest.is_divisor_of(t.monomial)) {
        let coefficient = 0.5 * t.coefficient / leading.coefficient;
        sum.push(PrintedTerm::from_monomial(coefficient, t.monomial.quotient(rest)));
    }
    let factor = rest.quotient(Monomial::first_power_of_atom(x));
    let sums = vec![SumFactor { items: sum, power: 2 }];
    let square = PrintedTerm { coefficient: leading.coefficient, factor, sums };
    let is_term_of_sum =
        |s: &Term| terms.iter().any(|t| t.monomial == s.monomial && is_close(t.coefficient, s.coefficient));
    let several = square.sums.iter().all(|sum| sum.items.len() > 1);
    (several && expand_square(&square).iter().all(is_term_of_sum)).then_some(square)
}

/// Expands the square of a sum of single terms.
fn expand_square(square: &PrintedTerm) -> Vec<Term> {
    let mut terms = Vec::new();
    let sum = square.sums.first().map_or(&[][..], |sum| &sum.items);
    for (i, a) in sum.iter().enumerate() {
        for (j, b) in sum.iter().enumerate().skip(i) {
            let twice = if i == j { 1.0 } else { 2.0 };
            let product = a.factor.checked_product(b.factor).and_then(|m| m.checked_product(square.factor));
            if let Some(monomial) = product {
                let coefficient = twice * square.coefficient * a.coefficient * b.coefficient;
                terms.push(Term { monomial, coefficient });
            }
        }
    }
    terms
}

/// Returns the common factor of all terms times the sum of the quotients, which is grouped by functions of
/// positions once more.
fn factored_item(order: &PrintOrder, terms: &[Term]) -> PrintedTerm {
    let first = terms.first().map_or(Monomial::ONE, |t| t.monomial);
    let factor = terms.iter().fold(first, |m, t| m.greatest_common_divisor(t.monomial));
    if let [only] = terms {
        return PrintedTerm::from_monomial(only.coefficient, factor);
    }
    let mut terms = terms.to_vec();
    order.sort_terms_for_printing(&mut terms);
    let coefficient = common_number_factor(terms.iter().map(|t| t.coefficient));
    for t in &mut terms {
        *t = Term { monomial: t.monomial.quotient(factor), coefficient: t.coefficient / coefficient };
    }
    let mut sum = Vec::new();
    for (functions, group) in group_terms_by_masked_factors(&terms, order.functions) {
        if functions != Monomial::ONE && group.len() < terms.len() {
            sum.push(factored_item(order, &group));
        } else {
            sum.extend(group.iter().map(|t| PrintedTerm::from_monomial(t.coefficient, t.monomial)));
        }
    }
    // A sum in parentheses starts with a positive term.
    if let Some(positive) = sum.iter().position(|t| t.coefficient > 0.0) {
        sum[..=positive].rotate_right(1);
    }
    PrintedTerm { coefficient, factor, sums: vec![SumFactor { items: sum, power: 1 }] }
}
