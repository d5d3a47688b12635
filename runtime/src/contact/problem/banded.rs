//! Linear equations of the velocity change: `(1 + Bᵀ H B) Δw = Bᵀ c`.

use super::basis::{add_multiple, dot};
use super::{ContactRowMatrix, RowList};
use crate::Real;

/// Makes the first `size` rows those of the unit matrix, and returns the index behind the last entry of each.
pub(super) fn set_unit_rows<T: Real, const NR: usize>(
    system: &mut ContactRowMatrix<T, NR>,
    size: usize,
) -> RowList<usize, NR> {
    let mut ends = RowList::repeat_entry(0);
    for (i, (row, end)) in system.iter_mut().zip(ends.iter_mut()).enumerate().take(size) {
        row.iter_mut().take(size).for_each(|entry| *entry = T::zero());
        (row[i], *end) = (T::one(), i + 1);
    }
    ends
}

/// Solves a system of `size` equations in place by Gaussian elimination with pivots of the columns. The
/// matrix has its entries at symmetric places, in each row up to its end. Unknowns without a pivot are zero.
pub(super) fn solve_banded_system<T: Real, const NR: usize>(
    system: &mut ContactRowMatrix<T, NR>,
    (right, ends): (&mut RowList<T, NR>, &mut RowList<usize, NR>),
    size: usize,
) {
    let mut limit = 0;
    for column in 0..size {
        limit = limit.max(ends[column]).min(size);
        let mut best = column;
        for row in column + 1..limit {
            if system[row][column].abs() > system[best][column].abs() {
                best = row;
            }
        }
        if best != column {
            limit = limit.max(ends[best]);
            let (above, below) = system.split_at_mut_checked(best).unwrap_or_default();
            if let (Some(one), Some(other)) = (above.get_mut(column), below.first_mut()) {
                let part = column..limit;
                let (one, other) = (one.get_mut(part.clone()), other.get_mut(part));
                one.unwrap_or_default().swap_with_slice(other.unwrap_or_default());
            }
            right.exchange_entries(best, column);
            ends.exchange_entries(best, column);
        }
        let end = ends[column];
        let (done, rows) = system.split_at_mut_checked(column + 1).unwrap_or_default();
        let Some(pivots) = done.last() else { break };
        if pivots[column] == T::zero() {
            continue;
        }
        let inverse = T::one() / pivots[column];
        let (pivots, value) = (pivots.get(column + 1..end).unwrap_or_default(), right[column]);
        let others = right.iter_mut().zip(ends.iter_mut()).skip(column + 1);
        for (row, (other, own)) in rows.iter_mut().zip(others).take(limit - column - 1) {
            let factor = row[column] * inverse;
            if factor != T::zero() {
                add_multiple(row.get_mut(column + 1..end).unwrap_or_default(), -factor, pivots);
                *other -= factor * value;
                *own = (*own).max(end);
            }
        }
    }
    for row in (0..size).rev() {
        let (entries, part) = (&system[row], row + 1..ends[row].max(row + 1));
        let sum = dot(entries.get(part.clone()).unwrap_or_default(), right.get(part).unwrap_or_default());
        let pivot = entries[row];
        right[row] = if pivot == T::zero() { T::zero() } else { (right[row] - sum) / pivot };
    }
}
