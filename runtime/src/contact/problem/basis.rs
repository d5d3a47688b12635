//! Rows of `B` in `W = B Bᵀ`.

use super::{ContactProblem, ContactRowMatrix, RowList};
use crate::Real;
use crate::contact::total::TotalArray;
use crate::private::{constant, epsilon};
use core::ops::Range;
use nalgebra::SVector;

/// Part of the largest diagonal entry of `W` that counts as zero for a pivot, in rounding errors.
const ROUNDINGS: f64 = 64.0;

/// Factor `B` of the Delassus matrix `W = B Bᵀ`: the effect of each impulse on `w`, the velocity in the
/// metric of the kinetic energy. A contact has entries in the columns of its bodies.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct DelassusFactor<T, const NR: usize> {
    rows: ContactRowMatrix<T, NR>,
    /// Columns of the first entry of each row that is not zero, and behind the last.
    reach: TotalArray<(usize, usize), NR>,
    /// Number of rows.
    size: usize,
    /// Index of the entry of `w`, the velocity in the metric of the kinetic energy, of each column.
    columns: TotalArray<usize, NR>,
    /// Number of columns; zero if `B` is not computed yet.
    rank: usize,
    /// Whether `B Bᵀ` equals `W` to rounding of each entry.
    is_exact: bool,
}

/// Entries of `w` that a matrix `B` has columns for.
pub(in super::super) struct UsedColumns<const N: usize> {
    is_used: [bool; N],
    /// Number of used entries before each.
    index: [usize; N],
    count: usize,
}

impl<const N: usize> UsedColumns<N> {
    /// Returns the columns for the used entries.
    pub(in super::super) fn columns_for_used_entries(is_used: [bool; N]) -> Self {
        let (mut index, mut count) = ([0; N], 0);
        for (index, is_used) in index.iter_mut().zip(&is_used) {
            *index = count;
            count += usize::from(*is_used);
        }
        Self { is_used, index, count }
    }
}

/// Rows of a contact and its friction moments.
pub(super) const ROWS: usize = 6;
/// Rows whose products are added at once.
const AT_ONCE: usize = 3;

/// Derivatives of the impulses of a contact and its friction moments with respect to their contact
/// velocities.
pub(super) struct ImpulseDerivativeBlock<T> {
    rows: [usize; ROWS],
    count: usize,
    entries: [[T; ROWS]; ROWS],
}

impl<T: Real> ImpulseDerivativeBlock<T> {
    /// Returns zeros for one row.
    pub(super) fn new(row: usize) -> Self {
        Self { rows: [row; ROWS], count: 1, entries: [[T::zero(); ROWS]; ROWS] }
    }

    /// Adds rows of friction to the block, filled with zeros, and returns the index of the first.
    pub(super) fn push_friction_rows(&mut self, rows: Range<usize>) -> usize {
        let first = self.count;
        for row in rows {
            if let Some(entry) = self.rows.get_mut(self.count) {
                *entry = row;
                self.count += 1;
            }
        }
        first
    }

    /// Adds to the derivative of an impulse with respect to a contact velocity.
    pub(super) fn add_to_entry(&mut self, i: usize, j: usize, value: T) {
        if let Some(entry) = self.entries.get_mut(i).and_then(|row| row.get_mut(j)) {
            *entry += value;
        }
    }

    /// Adds the product of a column and a row of values to the rows of friction from `first` on.
    pub(super) fn add_scaled_outer_product(&mut self, first: usize, factor: T, [x, y]: [T; 2]) {
        self.add_to_entry(first, first, factor * x * x);
        self.add_to_entry(first, first + 1, factor * x * y);
        self.add_to_entry(first + 1, first, factor * x * y);
        self.add_to_entry(first + 1, first + 1, factor * y * y);
    }
}

impl<T: Real, const NR: usize> DelassusFactor<T, NR> {
    /// Returns `B` without columns, which is not computed yet.
    pub(in super::super) fn uncomputed_basis() -> Self {
        let rows = ContactRowMatrix::repeat_entry(RowList::repeat_entry(T::zero()));
        let (reach, columns) = (TotalArray::repeat_entry((0, 0)), TotalArray::repeat_entry(0));
        Self { rows, reach, size: 0, columns, rank: 0, is_exact: false }
    }

    /// Begins `B` with columns, and without rows; false if the columns are more than the arrays have.
    pub(in super::super) fn restart_with_columns<const N: usize>(
        &mut self,
        columns: &UsedColumns<N>,
    ) -> bool {
        (self.size, self.rank, self.is_exact) = (0, 0, false);
        if columns.count == 0 || columns.count > NR {
            return false;
        }
        let used = columns.is_used.iter().enumerate().filter(|(_, is_used)| **is_used);
        self.columns.iter_mut().zip(used).for_each(|(to, (column, _))| *to = column);
        (self.rank, self.is_exact) = (columns.count, true);
        true
    }

    /// Appends a row to `B`: the entries `w` from column `first` of the mechanism on, zeros before them.
    pub(in super::super) fn push_row<const N: usize>(
        &mut self,
        columns: &UsedColumns<N>,
        first: usize,
        w: &[T],
    ) {
        let UsedColumns { is_used, index, .. } = columns;
        let (row, mut reach) = (&mut self.rows[self.size], (NR, 0));
        let places = index.iter().zip(is_used).skip(first);
        for (entry, (index, _)) in
            w.iter().zip(places).filter(|(entry, (_, is_used))| **is_used && **entry != T::zero())
        {
            row[*index] = *entry;
            reach = (reach.0.min(*index), *index + 1);
        }
        self.reach[self.size] = if reach.1 > 0 { reach } else { (0, 0) };
        self.size += 1;
    }

    /// Sets the rows to `chosen` ones of another matrix `B`.
    pub(super) fn copy_selected_rows<const N: usize>(
        &mut self,
        from: &DelassusFactor<T, N>,
        chosen: &[usize],
    ) {
        if from.rank == 0 {
            return;
        }
        let mut is_used = [false; N];
        for (first, row) in chosen.iter().map(|i| from.nonzero_part_of_row(*i)) {
            let entries = is_used.iter_mut().skip(first).zip(row);
            entries.for_each(|(is_used, entry)| *is_used |= *entry != T::zero());
        }
        let columns = UsedColumns::columns_for_used_entries(is_used);
        if self.restart_with_columns(&columns) {
            chosen
                .iter()
                .map(|i| from.nonzero_part_of_row(*i))
                .for_each(|(first, row)| self.push_row(&columns, first, row));
            self.columns.iter_mut().take(self.rank).for_each(|column| *column = from.columns[*column]);
            self.is_exact = from.is_exact;
        }
    }

    /// Finds the entries of the first `size` rows that are not zero.
    fn update_nonzero_ranges(&mut self, size: usize) {
        self.size = size;
        for (row, reach) in self.rows.iter().zip(self.reach.iter_mut()).take(size) {
            let row = row.get(..self.rank).unwrap_or_default();
            let is_nonzero = |entry: &T| *entry != T::zero();
            let first = row.iter().position(is_nonzero).unwrap_or(0);
            *reach = (first, row.iter().rposition(is_nonzero).map_or(first, |last| last + 1));
        }
    }

    /// Whether `B Bᵀ` is as exact as `W`.
    pub(super) fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// Returns the number of columns.
    pub(super) fn column_count(&self) -> usize {
        self.rank
    }

    /// Returns the first column of a row that has an entry, and the entries from there to the last.
    pub(super) fn nonzero_part_of_row(&self, i: usize) -> (usize, &[T]) {
        let (first, last) = self.reach[i];
        (first, self.rows[i].get(first..last).unwrap_or_default())
    }

    /// Adds `Bᵀ H B` for a block `H` to a matrix. `ends` has the index behind the last entry of each row.
    pub(super) fn add_projected_block(
        &self,
        block: &ImpulseDerivativeBlock<T>,
        matrix: &mut ContactRowMatrix<T, NR>,
        ends: &mut RowList<usize, NR>,
    ) {
        let ImpulseDerivativeBlock { rows, count, entries } = block;
        let (mut first, mut last) = (NR, 0);
        for i in rows.iter().take(*count) {
            let (start, row) = self.nonzero_part_of_row(*i);
            if !row.is_empty() {
                (first, last) = (first.min(start), last.max(start + row.len()));
            }
        }
        let row_part_in_column_range = |i: usize| self.rows[i].get(first..last).unwrap_or_default();
        for top in (0..*count).step_by(AT_ONCE) {
            let mut products = [RowList::<T, NR>::repeat_entry(T::zero()); AT_ONCE];
            let mut left = [&[] as &[T]; AT_ONCE];
            let mut is_any = false;
            for ((product, left), i) in products.iter_mut().zip(&mut left).zip(top..*count) {
                let product = product.get_mut(..last.saturating_sub(first)).unwrap_or_default();
                let (Some(row), Some(factors)) = (rows.get(i), entries.get(i)) else { continue };
                *left = row_part_in_column_range(*row);
                for (factor, j) in factors.iter().zip(rows).take(*count) {
                    if *factor != T::zero() {
                        add_multiple(product, *factor, row_part_in_column_range(*j));
                        is_any = true;
                    }
                }
            }
            if !is_any {
                continue;
            }
            let [a, b, c] = products;
            let [x, y, z] = left.map(|left| |i: usize| left.get(i).copied().unwrap_or(T::zero()));
            let own = matrix.iter_mut().zip(ends.iter_mut()).take(last).skip(first).enumerate();
            for (i, (row, end)) in own {
                *end = (*end).max(last);
                let (x, y, z) = (x(i), y(i), z(i));
                let terms = a.iter().zip(b.iter()).zip(c.iter());
                let entries = row.get_mut(first..last).unwrap_or_default();
                entries.iter_mut().zip(terms).for_each(|(to, ((a, b), c))| *to += x * *a + y * *b + z * *c);
            }
        }
    }

    /// Returns the contact velocities `B w` of a velocity `w` in the metric of the kinetic energy.
    pub(super) fn rates_of_velocity(&self, w: &RowList<T, NR>) -> RowList<T, NR> {
        let mut rates = RowList::repeat_entry(T::zero());
        for (i, rate) in rates.iter_mut().enumerate().take(self.size) {
            let (first, row) = self.nonzero_part_of_row(i);
            *rate = dot(row, w.get(first..first + row.len()).unwrap_or_default());
        }
        rates
    }

    /// Returns the change `Bᵀ Λ` of `w` that the impulses cause.
    pub(super) fn velocity_of_impulses(&self, impulses: &RowList<T, NR>) -> RowList<T, NR> {
        let mut w = RowList::repeat_entry(T::zero());
        for (i, impulse) in impulses.iter().enumerate().take(self.size) {
            if *impulse != T::zero() {
                let (first, row) = self.nonzero_part_of_row(i);
                add_multiple(w.get_mut(first..first + row.len()).unwrap_or_default(), *impulse, row);
            }
        }
        w
    }

    /// Writes the entries of `w` that impulses change.
    pub(in super::super) fn write_changed_velocity_entries<const N: usize>(
        &self,
        impulses: &SVector<T, NR>,
        w: &mut [T; N],
    ) {
        self.scatter_basis_columns(
            &self.velocity_of_impulses(&RowList::new(impulses.data.0[0], T::zero())),
            w,
        );
    }

    /// Writes the entries of `w` of all columns.
    pub(super) fn scatter_basis_columns<const N: usize>(&self, own: &RowList<T, NR>, w: &mut [T; N]) {
        for (column, value) in self.columns.iter().zip(own.iter()).take(self.rank) {
            if let Some(entry) = w.get_mut(*column) {
                *entry = *value;
            }
        }
    }

    /// Returns the values of `w` for all columns.
    pub(super) fn entries_at_basis_columns<const N: usize>(&self, w: &[T; N]) -> RowList<T, NR> {
        let mut own = RowList::repeat_entry(T::zero());
        for (value, column) in own.iter_mut().zip(self.columns.iter()).take(self.rank) {
            *value = w.get(*column).copied().unwrap_or(T::zero());
        }
        own
    }

    /// Returns the entry of `B Bᵀ` for two rows.
    pub(super) fn row_product(&self, i: usize, j: usize) -> T {
        let ((first, row), (start, other)) = (self.nonzero_part_of_row(i), self.nonzero_part_of_row(j));
        let from = first.max(start);
        let (row, other) = (row.get(from - first..), other.get(from - start..));
        dot(row.unwrap_or_default(), other.unwrap_or_default())
    }

    /// Returns the largest sum of the magnitudes of the terms of a contact velocity, from magnitudes `free`
    /// on.
    pub(super) fn largest_term_magnitude_sum(&self, free: &RowList<T, NR>, impulses: &RowList<T, NR>) -> T {
        let mut w = RowList::<T, NR>::repeat_entry(T::zero());
        let nonzero_parts_of_rows = || (0..self.size).map(|i| self.nonzero_part_of_row(i));
        for ((first, row), impulse) in nonzero_parts_of_rows().zip(impulses.iter()) {
            if *impulse != T::zero() {
                w.iter_mut().skip(first).zip(row).for_each(|(w, entry)| *w += (*impulse * *entry).abs());
            }
        }
        nonzero_parts_of_rows().zip(free.iter()).fold(T::zero(), |most, ((first, row), free)| {
            let terms = row.iter().zip(w.iter().skip(first));
            most.max(terms.fold(free.abs(), |sum, (entry, w)| sum + entry.abs() * *w))
        })
    }
}

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Computes `B` from `W` (Cholesky with pivots), unless it is known.
    pub(super) fn compute_basis_if_needed(&mut self) {
        let size = self.size;
        if self.basis.rank > 0 || size == 0 {
            return;
        }
        // Columns first, one after another.
        let mut columns = ContactRowMatrix::<T, NR>::repeat_entry(RowList::repeat_entry(T::zero()));
        let mut left = RowList::<T, NR>::repeat_entry(T::zero());
        (0..size).for_each(|i| left[i] = self.delassus_matrix_entry(i, i));
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
            column.iter_mut().enumerate().for_each(|(i, to)| *to = self.delassus_matrix_entry(best, i));
            for before in done.iter() {
                let factor = before[best];
                if factor != T::zero() {
                    add_multiple(column, -factor, before.get(..size).unwrap_or_default());
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
        self.basis.update_nonzero_ranges(size);
    }
}

/// Returns the scalar product.
pub(in super::super) fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

/// Adds a multiple of a vector to another.
pub(super) fn add_multiple<T: Real>(to: &mut [T], factor: T, from: &[T]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * *from);
}
