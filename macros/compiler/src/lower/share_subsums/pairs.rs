//! Pairs of terms that several sums have.

use super::{Key, Terms};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Which sums have which pairs of terms, for pairs that some sums share.
#[derive(Default)]
pub(super) struct Pairs {
    lists: BTreeMap<Pair, Vec<usize>>,
    /// The same by how many.
    shared: BTreeSet<(usize, Reverse<Pair>)>,
}

impl Pairs {
    /// Those of some sums of so many values and each other.
    pub(super) fn of(sums: &[Terms], atoms: usize) -> Pairs {
        let place = |key: Key| match key {
            Key::One => 0,
            Key::Atom(a) => 1 + a,
            Key::Sum(s) => 1 + atoms + s,
        };
        // What is a term of one sum alone is in no pair that is shared.
        let mut uses = vec![0_u32; 1 + atoms + sums.len()];
        for (key, _) in sums.iter().flatten() {
            uses[place(*key)] += 1;
        }
        let mut all = Vec::new();
        let mut common = Terms::new();
        for (k, terms) in sums.iter().enumerate() {
            common.clear();
            common.extend(terms.iter().filter(|(key, _)| uses[place(*key)] > 1));
            for (i, a) in common.iter().enumerate() {
                all.extend(common[i + 1..].iter().map(|b| (Pair::of(*a, *b), k)));
            }
        }
        let mut pairs = Pairs::default();
        pairs.add(all);
        pairs
    }

    /// Adds pairs that no sum had before, each with a sum that has it.
    pub(super) fn add(&mut self, mut pairs: Vec<(Pair, usize)>) {
        pairs.sort_unstable();
        for same in pairs.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            self.shared.insert((same.len(), Reverse(same[0].0)));
            self.lists.insert(same[0].0, same.iter().map(|(_, sum)| *sum).collect());
        }
    }

    pub(super) fn remove(&mut self, pair: Pair, sum: usize) {
        let Some(list) = self.lists.get_mut(&pair) else { return };
        self.shared.remove(&(list.len(), Reverse(pair)));
        list.retain(|other| *other != sum);
        if list.len() > 1 {
            self.shared.insert((list.len(), Reverse(pair)));
        }
    }

    /// The pair that most sums share, of equals the first in order, with those; none if no two share one.
    pub(super) fn take_most_shared(&mut self) -> Option<(Pair, Vec<usize>)> {
        let (_, Reverse(pair)) = self.shared.pop_last()?;
        Some((pair, self.lists.remove(&pair)?))
    }
}

/// The numbers of two keys and the ratio of their coefficients, in one number: its highest and its middle 32
/// bits, and the lower half.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Pair(u128);

impl Pair {
    /// Two terms in order, but the number 1 comes second: a sum begins with a value.
    pub(super) fn of(a: (Key, f64), b: (Key, f64)) -> Pair {
        let [x, y] = [a.0.number(), b.0.number()];
        let swap = x == 0 || (y != 0 && y < x);
        let ((x, c), (y, d)) = if swap { ((y, b.1), (x, a.1)) } else { ((x, a.1), (y, b.1)) };
        Pair(u128::from(x) << 96 | u128::from(y) << 64 | u128::from((d / c).to_bits()))
    }

    pub(super) fn first(self) -> u32 {
        (self.0 >> 96) as u32
    }

    pub(super) fn second(self) -> u32 {
        (self.0 >> 64) as u32
    }

    pub(super) fn ratio(self) -> f64 {
        f64::from_bits(self.0 as u64)
    }
}
