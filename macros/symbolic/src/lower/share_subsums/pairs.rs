//! Pairs of terms that several sums have in common.

use super::{TermWithoutCoefficient, Terms};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Index of the pairs of terms that several sums have in common.
#[derive(Default)]
pub(super) struct SharedPairs {
    /// Indices of the sums that contain each pair.
    lists: BTreeMap<TermPair, Vec<usize>>,
    /// Pairs by the number of sums that contain them.
    shared: BTreeSet<(usize, Reverse<TermPair>)>,
}

impl SharedPairs {
    /// Collects the pairs of terms of all sums, given the number of atoms.
    pub(super) fn from_sums(sums: &[Terms], atoms: usize) -> SharedPairs {
        let dense_key_index = |key: TermWithoutCoefficient| match key {
            TermWithoutCoefficient::One => 0,
            TermWithoutCoefficient::Atom(a) => 1 + a,
            TermWithoutCoefficient::Sum(s) => 1 + atoms + s,
        };
        // A term with a single use is not part of a shared pair.
        let mut uses = vec![0_u32; 1 + atoms + sums.len()];
        for (key, _) in sums.iter().flatten() {
            uses[dense_key_index(*key)] += 1;
        }
        let mut all = Vec::new();
        let mut common = Terms::new();
        for (k, terms) in sums.iter().enumerate() {
            common.clear();
            common.extend(terms.iter().filter(|(key, _)| uses[dense_key_index(*key)] > 1));
            for (i, a) in common.iter().enumerate() {
                all.extend(common[i + 1..].iter().map(|b| (TermPair::new(*a, *b), k)));
            }
        }
        let mut pairs = SharedPairs::default();
        pairs.add_new_pairs(all);
        pairs
    }

    /// Adds pairs that no sum contained before, each with a sum that contains it.
    pub(super) fn add_new_pairs(&mut self, mut pairs: Vec<(TermPair, usize)>) {
        pairs.sort_unstable();
        for same in pairs.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            self.shared.insert((same.len(), Reverse(same[0].0)));
            self.lists.insert(same[0].0, same.iter().map(|(_, sum)| *sum).collect());
        }
    }

    /// Removes a sum from the list of a pair.
    pub(super) fn remove_sum_from_pair(&mut self, pair: TermPair, sum: usize) {
        let Some(list) = self.lists.get_mut(&pair) else { return };
        self.shared.remove(&(list.len(), Reverse(pair)));
        list.retain(|other| *other != sum);
        if list.len() > 1 {
            self.shared.insert((list.len(), Reverse(pair)));
        }
    }

    /// Removes the pair that the most sums share, the first one among equals, and returns it with these sums.
    /// Returns `None` if no pair is shared.
    pub(super) fn take_most_shared_pair(&mut self) -> Option<(TermPair, Vec<usize>)> {
        let (_, Reverse(pair)) = self.shared.pop_last()?;
        Some((pair, self.lists.remove(&pair)?))
    }
}

/// Pair of terms: the numbers of two keys and the ratio of their coefficients, packed into one integer (bits
/// 96 to 127, bits 64 to 95, and the lower half).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct TermPair(u128);

impl TermPair {
    /// Returns the pair of two terms in ascending order, except that the number 1 comes second, because a sum
    /// begins with a value.
    pub(super) fn new(a: (TermWithoutCoefficient, f64), b: (TermWithoutCoefficient, f64)) -> TermPair {
        let [x, y] = [a.0.term_key_index(), b.0.term_key_index()];
        let swap = x == 0 || (y != 0 && y < x);
        let ((x, c), (y, d)) = if swap { ((y, b.1), (x, a.1)) } else { ((x, a.1), (y, b.1)) };
        TermPair(u128::from(x) << 96 | u128::from(y) << 64 | u128::from((d / c).to_bits()))
    }

    /// Returns the number of the first key of a pair of terms.
    pub(super) fn first_key_index(self) -> u32 {
        (self.0 >> 96) as u32
    }

    /// Returns the number of the second key of a pair of terms.
    pub(super) fn second_key_index(self) -> u32 {
        (self.0 >> 64) as u32
    }

    /// Returns the coefficient of the second term divided by that of the first.
    pub(super) fn coefficient_ratio(self) -> f64 {
        f64::from_bits(self.0 as u64)
    }
}
