//! Arrays whose index operator cannot panic.

use core::ops::{Deref, DerefMut, Index, IndexMut};

/// Array with a spare entry for indices past its end, so that indexing cannot panic. Indices of contacts and
/// rows come from tables whose values the compiler cannot verify.
#[derive(Clone, Copy, Debug)]
pub(super) struct TotalArray<E, const N: usize> {
    entries: [E; N],
    spare: E,
}

impl<E: Copy, const N: usize> TotalArray<E, N> {
    /// Returns an array of `N` copies of an entry.
    pub(super) const fn repeat_entry(entry: E) -> Self {
        Self { entries: [entry; N], spare: entry }
    }

    /// Returns an array of these entries. An index past the end reads or writes `spare`.
    pub(super) const fn new(entries: [E; N], spare: E) -> Self {
        Self { entries, spare }
    }

    /// Returns the entries as an ordinary array, without the spare one.
    pub(super) const fn into_entries(self) -> [E; N] {
        self.entries
    }

    /// Applies a function to all entries, including the spare one.
    pub(super) fn map_entries<F>(self, mut f: impl FnMut(E) -> F) -> TotalArray<F, N> {
        TotalArray { spare: f(self.spare), entries: self.entries.map(f) }
    }

    /// Exchanges the entries with the indices `a` and `b`.
    pub(super) fn exchange_entries(&mut self, a: usize, b: usize) {
        (self[a], self[b]) = (self[b], self[a]);
    }
}

impl<E, const N: usize> Index<usize> for TotalArray<E, N> {
    type Output = E;

    fn index(&self, k: usize) -> &E {
        self.entries.get(k).unwrap_or(&self.spare)
    }
}

impl<E, const N: usize> IndexMut<usize> for TotalArray<E, N> {
    fn index_mut(&mut self, k: usize) -> &mut E {
        self.entries.get_mut(k).unwrap_or(&mut self.spare)
    }
}

impl<E, const N: usize> Deref for TotalArray<E, N> {
    type Target = [E; N];

    fn deref(&self) -> &[E; N] {
        &self.entries
    }
}

impl<E, const N: usize> DerefMut for TotalArray<E, N> {
    fn deref_mut(&mut self) -> &mut [E; N] {
        &mut self.entries
    }
}
