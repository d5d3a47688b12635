//! Factorisation and elimination of small dense matrices of contact equations, without allocation.

use super::{ContactRowMatrix, ROUNDINGS, RowList};
use crate::Real;
use crate::contact::total::TotalArray;
use crate::private::{constant, epsilon};
use core::ops::Range;

/// Ratio to the largest diagonal entry below which a row gets its own, smaller regularisation in proportion
/// to its diagonal entry.
const SIMILAR: f64 = 256.0;

/// Length of rows up to which whole rows are subtracted, without a range of columns.
const SHORT: usize = 36;

/// Solves a system of `size` equations in place by Gaussian elimination with pivots of the columns, for
/// several right-hand sides. Unknowns without a pivot are zero.
pub(super) fn eliminate_with_pivots<T: Real, const N: usize, const NR: usize>(
    system: &mut ContactRowMatrix<T, NR>,
    right: &mut TotalArray<[T; N], NR>,
    size: usize,
) {
    for column in 0..size {
        let mut best = column;
        for row in column + 1..size {
            if system[row][column].abs() > system[best][column].abs() {
                best = row;
            }
        }
        if best != column {
            system.exchange_entries(best, column);
            right.exchange_entries(best, column);
        }
        let (done, rows) = system.split_at_mut_checked(column + 1).unwrap_or_default();
        let (values, others) = right.split_at_mut_checked(column + 1).unwrap_or_default();
        let (Some(pivots), Some(value)) = (done.last(), values.last()) else { break };
        if pivots[column] == T::zero() {
            continue;
        }
        let inverse = T::one() / pivots[column];
        for (row, other) in rows.iter_mut().zip(others).take(size - column - 1) {
            let factor = row[column] * inverse;
            if factor == T::zero() {
                continue;
            }
            // Entries before the pivot are not read again.
            subtract_range_or_short_row(row, factor, pivots, column + 1..size);
            subtract_multiple(other, factor, value);
        }
    }
    for row in (0..size).rev() {
        let mut sum = right[row];
        (row + 1..size).for_each(|c| subtract_multiple(&mut sum, system[row][c], &right[c]));
        let pivot = system[row][row];
        right[row] = sum.map(|sum| if pivot == T::zero() { T::zero() } else { sum / pivot });
    }
}

/// Returns the pivot, relative to its diagonal entry, above which rows count as independent, `ε^(5/8)`:
/// larger than rounding errors, and smaller than the pivots of bodies with very different masses.
pub(super) fn independence_threshold<T: Real>() -> T {
    let half = epsilon::<T>().sqrt();
    half * half.sqrt().sqrt()
}

/// Returns the regularisation of a row. `weight` is its diagonal entry, and `reach` the largest diagonal
/// entry.
pub(super) fn row_regularisation<T: Real>(weight: T, reach: T) -> T {
    let own = (weight * constant(SIMILAR)).min(reach) * epsilon::<T>().sqrt();
    own.max(reach * epsilon::<T>() * constant(ROUNDINGS))
}

/// Factorises the symmetric matrix `A = Uᵀ D U` (Cholesky without square roots) in place: rows of `U` times
/// their entries of `D`, with the reciprocals of `D` on the diagonal. Returns false if rows are dependent and
/// no regularisation is chosen (`is_lifted`).
pub(super) fn factorise_symmetric<T: Real, const NR: usize>(
    u: &mut ContactRowMatrix<T, NR>,
    size: usize,
    is_lifted: bool,
) -> bool {
    let mut given = RowList::<T, NR>::repeat_entry(T::zero());
    given.iter_mut().zip(u.iter().enumerate()).for_each(|(given, (j, row))| *given = row[j]);
    let reach = given.iter().take(size).fold(T::zero(), |most, weight| most.max(*weight));
    let part = independence_threshold::<T>();
    for j in 0..size {
        // Earlier rows are already eliminated from the diagonal entry.
        let (pivot, least) = match is_lifted {
            true => (u[j][j] + row_regularisation(given[j], reach), T::zero()),
            false => (u[j][j], given[j] * part),
        };
        let is_independent = pivot > least;
        if !is_independent {
            return false;
        }
        let reciprocal = T::one() / pivot;
        u[j][j] = reciprocal;
        let (done, rows) = u.split_at_mut_checked(j + 1).unwrap_or_default();
        let Some(row) = done.last() else { break };
        for (below, part) in rows.iter_mut().zip(row.iter().skip(j + 1)).take(size - j - 1) {
            if *part != T::zero() {
                subtract_range_or_short_row(below, *part * reciprocal, row, j + 1..size);
            }
        }
    }
    true
}

/// Replaces `p` by the solution `x` of `Uᵀ D U x = p`, with the factors of [`factorise_symmetric`].
pub(super) fn solve_with_stored_factors<T: Real, const NR: usize>(
    u: &ContactRowMatrix<T, NR>,
    size: usize,
    x: &mut RowList<T, NR>,
) {
    for j in 0..size {
        let value = x[j] * u[j][j];
        subtract_row_range(x, value, &u[j], j + 1..size);
        x[j] = value;
    }
    for j in (0..size).rev() {
        let (row, rest) = (&u[j], j + 1..size);
        let terms = x.get(rest.clone()).unwrap_or_default().iter().zip(row.get(rest).unwrap_or_default());
        let sum = terms.fold(T::zero(), |sum, (other, part)| sum + *other * *part);
        x[j] -= sum * row[j];
    }
}

/// Subtracts a range of entries of a multiple of a row from another row.
fn subtract_row_range<T: Real, const N: usize>(
    from: &mut RowList<T, N>,
    factor: T,
    row: &RowList<T, N>,
    part: Range<usize>,
) {
    let entries = from.get_mut(part.clone()).unwrap_or_default();
    entries
        .iter_mut()
        .zip(row.get(part).unwrap_or_default())
        .for_each(|(from, entry)| *from -= factor * *entry);
}

/// Subtracts a range of entries of a multiple of a row from another row. Short rows are subtracted as a
/// whole, because their length is known at compile time; the entries outside of the range must not matter.
fn subtract_range_or_short_row<T: Real, const N: usize>(
    from: &mut RowList<T, N>,
    factor: T,
    row: &RowList<T, N>,
    part: Range<usize>,
) {
    if const { N <= SHORT } {
        subtract_multiple(from, factor, row)
    } else {
        subtract_row_range(from, factor, row, part)
    }
}

/// Subtracts a multiple of a row from another row.
#[inline(always)]
pub(in super::super) fn subtract_multiple<T: Real, const N: usize>(
    from: &mut [T; N],
    factor: T,
    row: &[T; N],
) {
    from.iter_mut().zip(row).for_each(|(from, entry)| *from -= factor * *entry);
}

/// Returns a square matrix of zeros.
pub(super) fn zero_matrix<T: Real, const NR: usize>() -> ContactRowMatrix<T, NR> {
    ContactRowMatrix::repeat_entry(RowList::repeat_entry(T::zero()))
}
