//! Rows of `B` in `W = B Bᵀ`.

use super::{List, Problem, Square};
use crate::Real;
use crate::contact::total::Total;
use crate::private::{constant, epsilon};

/// Part of the largest diagonal entry of `W` that counts as zero for a pivot, in rounding errors.
const ROUNDINGS: f64 = 64.0;

/// `B`, row by row: the effect of each impulse on `w`, the velocity in the metric of the kinetic energy. A
/// contact has entries in the columns of its bodies.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Basis<T, const NR: usize> {
    rows: Square<T, NR>,
    /// Columns of the first entry of each row that is not zero, and behind the last.
    reach: Total<(usize, usize), NR>,
    /// Number of columns; zero if `B` is not computed yet.
    rank: usize,
    /// Whether `B Bᵀ` equals `W` to rounding of each entry.
    is_exact: bool,
}

/// A linear combination of rows: its entries, and the columns that contain them.
#[derive(Clone, Copy)]
pub(super) struct Combination<T, const NR: usize> {
    entries: List<T, NR>,
    reach: (usize, usize),
}

impl<T: Real, const NR: usize> Combination<T, NR> {
    /// Returns zero.
    pub(super) fn zero() -> Self {
        Self { entries: List::repeat(T::zero()), reach: (NR, 0) }
    }

    /// Adds a multiple of a row.
    pub(super) fn add(&mut self, factor: T, (first, row): (usize, &[T])) {
        let last = first + row.len();
        self.reach = (self.reach.0.min(first), self.reach.1.max(last));
        add(self.entries.get_mut(first..last).unwrap_or_default(), factor, row);
    }

    /// Returns the first column of the entries, and the entries.
    pub(super) fn row(&self) -> (usize, &[T]) {
        let (first, last) = self.reach;
        (first, self.entries.get(first..last).unwrap_or_default())
    }
}

impl<T: Real, const NR: usize> Basis<T, NR> {
    /// Returns `B` without columns, which is not computed yet.
    pub(in super::super) fn none() -> Self {
        let rows = Square::repeat(List::repeat(T::zero()));
        Self { rows, reach: Total::repeat((0, 0)), rank: 0, is_exact: false }
    }

    /// Sets the rows of `B`. Columns of zeros are left out; if more columns remain than the arrays have,
    /// there are none.
    pub(in super::super) fn set<'a, const N: usize>(&mut self, rows: impl Iterator<Item = &'a [T; N]> + Clone)
    where
        T: 'a,
    {
        (self.rank, self.is_exact) = (0, false);
        let mut is_used = [false; N];
        for row in rows.clone() {
            is_used.iter_mut().zip(row).for_each(|(is_used, entry)| *is_used |= *entry != T::zero());
        }
        let rank = is_used.iter().filter(|is_used| **is_used).count();
        if rank > NR {
            return;
        }
        let mut size = 0;
        for (to, row) in self.rows.iter_mut().zip(rows) {
            let entries = row.iter().zip(&is_used).filter(|(_, is_used)| **is_used);
            to.iter_mut().zip(entries).for_each(|(to, (entry, _))| *to = *entry);
            size += 1;
        }
        (self.rank, self.is_exact) = (rank, rank > 0);
        self.find_reach(size);
    }

    /// Sets the rows to `chosen` ones of another matrix `B`.
    pub(super) fn select<const N: usize>(&mut self, from: &Basis<T, N>, chosen: &[usize]) {
        if from.rank > 0 {
            self.set(chosen.iter().map(|i| &*from.rows[*i]));
            self.is_exact &= from.is_exact;
        }
    }

    /// Finds the entries of the first `size` rows that are not zero.
    fn find_reach(&mut self, size: usize) {
        for (row, reach) in self.rows.iter().zip(self.reach.iter_mut()).take(size) {
            let row = row.get(..self.rank).unwrap_or_default();
            let is_any = |entry: &T| *entry != T::zero();
            let first = row.iter().position(is_any).unwrap_or(0);
            *reach = (first, row.iter().rposition(is_any).map_or(first, |last| last + 1));
        }
    }

    /// Whether `B Bᵀ` is as exact as `W`.
    pub(super) fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// Returns the number of columns.
    pub(super) fn rank(&self) -> usize {
        self.rank
    }

    /// Returns the first column of a row that has an entry, and the entries from there to the last.
    pub(super) fn row(&self, i: usize) -> (usize, &[T]) {
        let (first, last) = self.reach[i];
        (first, self.rows[i].get(first..last).unwrap_or_default())
    }

    /// Returns `B w`.
    pub(super) fn rates(&self, w: &List<T, NR>) -> List<T, NR> {
        let mut rates = List::repeat(T::zero());
        for (rate, (row, (first, last))) in rates.iter_mut().zip(self.rows.iter().zip(self.reach.iter())) {
            let entries = row.get(*first..*last).unwrap_or_default();
            *rate = dot(entries, w.get(*first..*last).unwrap_or_default());
        }
        rates
    }

    /// Returns `Bᵀ Λ`.
    pub(super) fn velocity(&self, impulses: &List<T, NR>) -> List<T, NR> {
        let mut w = List::repeat(T::zero());
        for (impulse, (row, (first, last))) in impulses.iter().zip(self.rows.iter().zip(self.reach.iter())) {
            if *impulse != T::zero() {
                let entries = row.get(*first..*last).unwrap_or_default();
                add(w.get_mut(*first..*last).unwrap_or_default(), *impulse, entries);
            }
        }
        w
    }
}

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Computes `B` from `W` (Cholesky with pivots), unless it is known.
    pub(super) fn prepare_basis(&mut self) {
        let size = self.size;
        if self.basis.rank > 0 || size == 0 {
            return;
        }
        // Columns first, one after another.
        let mut columns = Square::<T, NR>::repeat(List::repeat(T::zero()));
        let mut left = List::<T, NR>::repeat(T::zero());
        (0..size).for_each(|i| left[i] = self.weights[i][i]);
        let reach = left.iter().take(size).fold(T::zero(), |most, x| most.max(*x));
        let mut rank = 0;
        while rank < size {
            let mut best = 0;
            (0..size).for_each(|i| {
                if left[i] > left[best] {
                    best = i
                }
            });
            let pivot = left[best];
            let is_done = pivot <= reach * epsilon::<T>() * constant(ROUNDINGS);
            if is_done {
                break;
            }
            let reciprocal = T::one() / pivot.sqrt();
            let (done, rest) = columns.split_at_mut_checked(rank).unwrap_or_default();
            let Some(column) = rest.first_mut().and_then(|column| column.get_mut(..size)) else { break };
            column.iter_mut().zip(self.weights[best].iter()).for_each(|(to, from)| *to = *from);
            for before in done.iter() {
                let factor = before[best];
                if factor != T::zero() {
                    add(column, -factor, before.get(..size).unwrap_or_default());
                }
            }
            for (i, entry) in column.iter_mut().enumerate() {
                *entry *= reciprocal;
                left[i] -= *entry * *entry;
            }
            left[best] = -T::one();
            rank += 1;
        }
        for i in 0..size {
            (0..rank).for_each(|j| self.basis.rows[i][j] = columns[j][i]);
        }
        self.basis.rank = rank;
        self.basis.find_reach(size);
    }
}

/// Returns the scalar product.
pub(in super::super) fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

/// Adds a multiple of a vector to another.
pub(super) fn add<T: Real>(to: &mut [T], factor: T, from: &[T]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * *from);
}

/// Adds a multiple of the product of a column and a row to a matrix.
pub(super) fn add_product<T: Real, const NR: usize>(
    matrix: &mut Square<T, NR>,
    factor: T,
    (top, left): (usize, &[T]),
    (first, right): (usize, &[T]),
) {
    let rows = matrix.get_mut(top..top + left.len()).unwrap_or_default();
    for (row, value) in rows.iter_mut().zip(left).filter(|(_, value)| **value != T::zero()) {
        add(row.get_mut(first..first + right.len()).unwrap_or_default(), factor * *value, right);
    }
}
