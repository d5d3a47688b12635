//! Arrays without a way to panic.

use core::ops::{Deref, DerefMut, Index, IndexMut};

/// An array whose every index names an entry: those past its end name a spare one. Numbers of contacts and of
/// rates come from tables, and no index from there is a way to panic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Total<E, const N: usize> {
    entries: [E; N],
    spare: E,
}

impl<E: Copy, const N: usize> Total<E, N> {
    /// `N` entries alike.
    pub(super) const fn repeat(entry: E) -> Self {
        Self { entries: [entry; N], spare: entry }
    }

    /// These entries, and past the end `spare`.
    pub(super) const fn new(entries: [E; N], spare: E) -> Self {
        Self { entries, spare }
    }

    /// The array.
    pub(super) const fn entries(self) -> [E; N] {
        self.entries
    }

    /// All entries, the spare one too, made into others.
    pub(super) fn each<F>(self, mut f: impl FnMut(E) -> F) -> Total<F, N> {
        Total { spare: f(self.spare), entries: self.entries.map(f) }
    }

    /// Exchanges two entries.
    pub(super) fn exchange(&mut self, a: usize, b: usize) {
        (self[a], self[b]) = (self[b], self[a]);
    }
}

impl<E, const N: usize> Index<usize> for Total<E, N> {
    type Output = E;

    fn index(&self, k: usize) -> &E {
        self.entries.get(k).unwrap_or(&self.spare)
    }
}

impl<E, const N: usize> IndexMut<usize> for Total<E, N> {
    fn index_mut(&mut self, k: usize) -> &mut E {
        self.entries.get_mut(k).unwrap_or(&mut self.spare)
    }
}

impl<E, const N: usize> Deref for Total<E, N> {
    type Target = [E; N];

    fn deref(&self) -> &[E; N] {
        &self.entries
    }
}

impl<E, const N: usize> DerefMut for Total<E, N> {
    fn deref_mut(&mut self) -> &mut [E; N] {
        &mut self.entries
    }
}
