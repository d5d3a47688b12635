//! Extraction of common factors from the items of a sum, as long as it reduces the number of printed symbols.

use super::item::{PrintOrder, PrintedTerm, SumFactor, common_number_factor, is_close};
use super::polynomial::Monomial;

/// Maximum number of items of a sum that are searched for common factors: longer sums are not readable
/// anyway.
const MOST: usize = 200;

/// Maximum number of items for which every first extraction is tried.
const FEW: usize = 10;
/// Maximum nesting depth of parentheses that common factors introduce.
const NESTED: usize = 3;

/// Selection of the items of a sum from which common factors are taken out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactorScope {
    /// Common factors are extracted from all items, as for an equation.
    All,
    /// Common factors are extracted from items of the same nonzero degree in velocities, but never velocities
    /// and positions themselves, as for an energy.
    Kinds,
    /// No common factors are extracted from the sum; only its coefficients are shortened, as for a linear
    /// form.
    None,
}

/// Extracts common factors from a sum and from the sums in its items.
pub fn extract_common_factors_of_sum(
    order: &PrintOrder,
    mut items: Vec<PrintedTerm>,
    scope: FactorScope,
) -> Vec<PrintedTerm> {
    let kept =
        if scope == FactorScope::Kinds { order.rates.union_of_bits(order.positions) } else { Monomial::ONE };
    let rules = FactoringRules { order, kept, room: NESTED };
    factor_sums(&rules, &mut items);
    let degree_of_rates = |item: &PrintedTerm| item.factor.restrict_to_mask(order.rates).degree();
    let mut kinds: Vec<u32> = match scope {
        FactorScope::All => return factor_sum(&rules, items),
        FactorScope::Kinds => items.iter().map(degree_of_rates).collect(),
        FactorScope::None => return items,
    };
    kinds.dedup();
    let mut out = Vec::new();
    for n in kinds {
        let (of_degree, rest) = items.into_iter().partition(|item| degree_of_rates(item) == n);
        items = rest;
        out.extend(if n == 0 { of_degree } else { factor_sum(&rules, of_degree) });
    }
    out
}

/// Rules for extracting common factors from a sum.
struct FactoringRules<'a> {
    order: &'a PrintOrder,
    /// Mask of the atoms that must not be extracted as factors.
    kept: Monomial,
    /// Maximum nesting depth of parentheses within an item.
    room: usize,
}

impl FactoringRules<'_> {
    /// Returns the rules for a sum in parentheses, which may contain one level of parentheses less.
    fn rules_in_parentheses(&self) -> Self {
        FactoringRules { room: self.room.saturating_sub(1), ..*self }
    }
}

/// Extracts common factors from the sums within items.
fn factor_sums(rules: &FactoringRules<'_>, items: &mut [PrintedTerm]) {
    let inner = rules.rules_in_parentheses();
    for item in items {
        for sum in item.sums.iter_mut().filter(|sum| sum.power == 1) {
            let mut items = std::mem::take(&mut sum.items);
            factor_sums(&inner, &mut items);
            sum.items = factor_sum(&inner, items);
        }
        unwrap_single_sums(item);
    }
}

/// Merges sums of a single item into the item that they are a factor of.
fn unwrap_single_sums(item: &mut PrintedTerm) {
    for sum in std::mem::take(&mut item.sums) {
        match sum.items.as_slice() {
            [only]
                if sum.power == 1
                    && let Some(factor) = item.factor.checked_product(only.factor) =>
            {
                item.coefficient *= only.coefficient;
                item.factor = factor;
                item.sums.extend(only.sums.iter().cloned());
            }
            _ => item.sums.push(sum),
        }
    }
}

/// Extracts common factors from a sum, except the atoms in `rules.kept`. In a short sum, every group of items
/// is tried first, and the shortest result is used.
fn factor_sum(rules: &FactoringRules<'_>, items: Vec<PrintedTerm>) -> Vec<PrintedTerm> {
    let mut best = factor_greedily(rules, items.clone());
    if items.len() > FEW {
        return best;
    }
    for group in shortening_groups(rules, &items) {
        let found = factor_greedily(rules, replace_group(rules, items.clone(), group));
        if rules.order.printed_length(&found) < rules.order.printed_length(&best) {
            best = found;
        }
    }
    best
}

/// Repeatedly takes out the common factor that saves the most symbols.
fn factor_greedily(rules: &FactoringRules<'_>, mut items: Vec<PrintedTerm>) -> Vec<PrintedTerm> {
    while items.len() <= MOST {
        let mut best: Option<CommonFactorGroup> = None;
        for group in shortening_groups(rules, &items) {
            if best.as_ref().is_none_or(|best| group.saved > best.saved) {
                best = Some(group);
            }
        }
        let Some(group) = best else { break };
        items = replace_group(rules, items, group);
    }
    items
}

/// Group of items of a sum that have a common factor.
struct CommonFactorGroup {
    members: Vec<usize>,
    /// The sum of the members, with the common factor taken out.
    whole: PrintedTerm,
    /// Number of printed symbols that the extraction of the factor saves.
    saved: usize,
}

/// Replaces the members of a group by the factored item.
fn replace_group(
    rules: &FactoringRules<'_>,
    mut items: Vec<PrintedTerm>,
    group: CommonFactorGroup,
) -> Vec<PrintedTerm> {
    let CommonFactorGroup { members, mut whole, .. } = group;
    if let Some(last) = whole.sums.last_mut() {
        last.items = factor_greedily(&rules.rules_in_parentheses(), std::mem::take(&mut last.items));
    }
    unwrap_single_sums(&mut whole);
    let (mut k, first) = (0, members.first().copied());
    items.retain(|_| {
        k += 1;
        Some(k - 1) == first || !members.contains(&(k - 1))
    });
    if let Some(place) = first.and_then(|k| items.get_mut(k)) {
        *place = whole;
    }
    items
}

/// Returns the groups of items whose factored form is shorter than their sum, within the allowed nesting
/// depth.
fn shortening_groups(rules: &FactoringRules<'_>, items: &[PrintedTerm]) -> Vec<CommonFactorGroup> {
    let printed_length_of_items = |items: &[PrintedTerm]| rules.order.printed_length(items);
    let shortening_group_of_members = |members: Vec<usize>| {
        let before: Vec<PrintedTerm> = members.iter().filter_map(|k| items.get(*k)).cloned().collect();
        let whole = factored_sum_of_items(rules, &before, members.len() == items.len())?;
        let saved = printed_length_of_items(&before)
            .checked_sub(printed_length_of_items(std::slice::from_ref(&whole)))?;
        (saved > 0 && nesting_depth(&whole) <= rules.room).then_some(CommonFactorGroup {
            members,
            whole,
            saved,
        })
    };
    candidate_item_sets(rules, items).into_iter().filter_map(shortening_group_of_members).collect()
}

/// Returns the sets of at least two items that share an atom or a sum.
fn candidate_item_sets(rules: &FactoringRules<'_>, items: &[PrintedTerm]) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = Vec::new();
    let mut add_matching_item_set = |has: &dyn Fn(&PrintedTerm) -> bool| {
        let members: Vec<usize> = (0..items.len()).filter(|k| has(&items[*k])).collect();
        if members.len() > 1 && !found.contains(&members) {
            found.push(members);
        }
    };
    for atom in
        rules.order.atoms.iter().filter(|k| !Monomial::first_power_of_atom(**k).intersects_mask(rules.kept))
    {
        add_matching_item_set(&|item| item.factor.power_of_atom(*atom) > 0);
    }
    for sum in items.iter().flat_map(|item| &item.sums) {
        add_matching_item_set(&|item| item.sums.iter().any(|other| sign_ratio_of_sums(sum, other).is_some()));
    }
    found
}

/// Returns the sum of items as one item: their common factors times the sum of the quotients. The first
/// summand in parentheses is positive. If the first summand is a negative multiple of an acceleration, and
/// `items` are not the whole sum, the sign is taken out; otherwise a positive summand is moved to the front.
fn factored_sum_of_items(
    rules: &FactoringRules<'_>,
    items: &[PrintedTerm],
    whole: bool,
) -> Option<PrintedTerm> {
    let first = items.first()?;
    let factor = items
        .iter()
        .fold(first.factor, |m, item| m.greatest_common_divisor(item.factor))
        .clear_mask(rules.kept);
    let mut sums: Vec<SumFactor> = Vec::new();
    let mut left: Vec<PrintedTerm> = items
        .iter()
        .map(|item| PrintedTerm {
            coefficient: item.coefficient,
            factor: item.factor.quotient(factor),
            sums: item.sums.clone(),
        })
        .collect();
    for sum in &first.sums {
        let places: Option<Vec<(usize, f64)>> = left
            .iter()
            .map(|item| {
                item.sums.iter().enumerate().find_map(|(k, other)| Some((k, sign_ratio_of_sums(sum, other)?)))
            })
            .collect();
        let Some(places) = places else { continue };
        for (item, (k, sign)) in left.iter_mut().zip(places) {
            item.sums.remove(k);
            item.coefficient *= sign;
        }
        sums.push(sum.clone());
    }
    let mut inner: Vec<PrintedTerm> = left.into_iter().flat_map(remove_sign_parentheses).collect();
    let mut number = common_number_factor(inner.iter().map(|item| item.coefficient));
    let is_negative_acceleration_term =
        |item: &PrintedTerm| item.coefficient < 0.0 && item.factor.intersects_mask(rules.order.accelerations);
    if !whole && inner.first().is_some_and(is_negative_acceleration_term) {
        number = -number.abs();
    }
    inner.iter_mut().for_each(|item| item.coefficient /= number);
    let mut inner: Vec<PrintedTerm> = inner.into_iter().flat_map(remove_sign_parentheses).collect();
    if let Some(positive) = inner.iter().position(|item| item.coefficient > 0.0) {
        inner[..=positive].rotate_right(1);
    }
    sums.push(SumFactor { items: inner, power: 1 });
    Some(PrintedTerm { coefficient: number, factor, sums })
}

/// Removes the parentheses of a sum whose only factor is a sign. Any other item is returned unchanged.
fn remove_sign_parentheses(item: PrintedTerm) -> Vec<PrintedTerm> {
    match item.sums.as_slice() {
        [sum] if sum.power == 1 && item.factor == Monomial::ONE && is_close(item.coefficient.abs(), 1.0) => {
            let scaled_item = |inner: &PrintedTerm| PrintedTerm {
                coefficient: inner.coefficient * item.coefficient,
                ..inner.clone()
            };
            sum.items.iter().map(scaled_item).collect()
        }
        _ => vec![item],
    }
}

/// Returns the nesting depth of the parentheses of an item.
fn nesting_depth(item: &PrintedTerm) -> usize {
    let inner = item.sums.iter().flat_map(|sum| &sum.items).map(nesting_depth).max();
    inner.map_or(0, |n| n + 1)
}

/// Returns one if two sums are equal, minus one if they are opposite, regardless of the order of their items.
fn sign_ratio_of_sums(a: &SumFactor, b: &SumFactor) -> Option<f64> {
    if a.power != b.power || a.items.len() != b.items.len() {
        return None;
    }
    let are_equal_with_sign =
        |sign: f64| a.items.iter().all(|x| b.items.iter().any(|y| is_equal_with_sign(x, y, sign)));
    match (are_equal_with_sign(1.0), are_equal_with_sign(-1.0)) {
        (true, _) => Some(1.0),
        (_, true) => Some(if a.power.is_multiple_of(2) { 1.0 } else { -1.0 }),
        _ => None,
    }
}

/// Returns whether the second item equals the first item times this sign.
fn is_equal_with_sign(a: &PrintedTerm, b: &PrintedTerm, sign: f64) -> bool {
    a.factor == b.factor
        && a.sums.len() == b.sums.len()
        && is_close(a.coefficient * sign, b.coefficient)
        && a.sums.iter().zip(&b.sums).all(|(x, y)| sign_ratio_of_sums(x, y) == Some(1.0))
}

#[cfg(test)]
mod tests;
