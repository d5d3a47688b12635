//! Sums of products over the rows of a tile, for several columns at a time.

use super::IndexRange;
use super::column::{Column, Source};
use crate::Real;
use crate::arithmetic::Arithmetic;
use nalgebra::SMatrix;

/// Returns the number of registers that store sums; the others store operands.
const fn sum_register_count(wide: bool) -> usize {
    if wide { 24 } else { 12 }
}

/// Replaces columns by minus their products with a matrix, `C` at a time if there are enough registers, and
/// returns the remaining columns. Several sums at a time hide the latency of the additions.
#[inline(always)]
pub fn multiply<
    'a,
    A: Arithmetic,
    T: Real,
    const R: usize,
    const E: usize,
    const F: usize,
    const N: usize,
    const C: usize,
>(
    matrix: &SMatrix<T, N, N>,
    columns: &'a mut [[T; N]],
    rows: &[usize],
) -> &'a mut [[T; N]] {
    if C > 1 && C * (E + F) > sum_register_count(A::WIDE) {
        return columns;
    }
    let (some, rest) = columns.as_chunks_mut::<C>();
    for some in some {
        if R >= N {
            let sums = negative_products::<A, T, R, E, F, N, C>(matrix, some, rows, 0);
            write::<A, T, E, F, N, C, R>(&sums, some, 0);
            continue;
        }
        let given = *some;
        for block in 0..N.div_ceil(R) {
            let first = (block * R).min(N - R);
            let sums = negative_products::<A, T, R, E, F, N, C>(matrix, &given, rows, first);
            write::<A, T, E, F, N, C, R>(&sums, some, first);
        }
    }
    rest
}

/// Returns the negative products of a matrix with `C` columns, for `R` rows of the result from row `first`
/// on.
#[inline(always)]
pub fn negative_products<
    A: Arithmetic,
    T: Real,
    const R: usize,
    const E: usize,
    const F: usize,
    const N: usize,
    const C: usize,
>(
    matrix: &SMatrix<T, N, N>,
    columns: &[[T; N]; C],
    rows: &[usize],
    first: usize,
) -> [Column<A, T, E, F>; C] {
    let mut sums = [Column::<A, T, E, F>::zero(); C];
    for &k in rows {
        let Some(from) = matrix.data.0.get(k) else { continue };
        let Some(from) = from.get(first..).and_then(<[T]>::first_chunk::<R>) else { continue };
        let from = Column::read(from);
        for (sums, column) in sums.iter_mut().zip(columns) {
            let Some(factor) = column.get(k) else { continue };
            sums.add_multiple::<true>(*factor, &from);
        }
    }
    sums
}

/// Loads `C` columns of a matrix into registers.
#[inline(always)]
pub fn load_columns_into_registers<
    A: Arithmetic,
    T: Real,
    const E: usize,
    const F: usize,
    const N: usize,
    const C: usize,
>(
    columns: &[[T; N]; C],
) -> [Column<A, T, E, F>; C] {
    let mut all = [Column::zero(); C];
    for (place, column) in all.iter_mut().zip(columns) {
        *place = Column::read(column);
    }
    all
}

/// Writes sums to the rows of columns, from row `first` on.
#[inline(always)]
pub fn write<
    A: Arithmetic,
    T: Real,
    const E: usize,
    const F: usize,
    const N: usize,
    const C: usize,
    const R: usize,
>(
    sums: &[Column<A, T, E, F>; C],
    columns: &mut [[T; N]; C],
    first: usize,
) {
    for (sums, column) in sums.iter().zip(columns) {
        if let Some(rows) = column.get_mut(first..).and_then(<[T]>::first_chunk_mut::<R>) {
            sums.write(rows);
        }
    }
}

/// Adds multiples of the `source` columns to columns of a matrix, or subtracts them, `C` at a time if there
/// are enough registers.
#[inline(always)]
pub fn add_all_multiples<
    A: Arithmetic,
    T: Real,
    S: Source<A, T, E, F>,
    const E: usize,
    const F: usize,
    const N: usize,
    const V: usize,
    const MINUS: bool,
>(
    sums: &mut [[T; N]],
    source: &S,
    factors: &[[T; V]],
    range: IndexRange,
) {
    let (sums, factors) =
        add_multiples_to_columns::<A, T, S, E, F, N, V, MINUS, 4>(sums, source, factors, range);
    let (sums, factors) =
        add_multiples_to_columns::<A, T, S, E, F, N, V, MINUS, 3>(sums, source, factors, range);
    let (sums, factors) =
        add_multiples_to_columns::<A, T, S, E, F, N, V, MINUS, 2>(sums, source, factors, range);
    add_multiples_to_columns::<A, T, S, E, F, N, V, MINUS, 1>(sums, source, factors, range);
}

/// Adds multiples of the `source` columns to columns of a matrix, `C` at a time. Returns the columns that
/// remain, with their factors.
#[inline(always)]
pub fn add_multiples_to_columns<
    'a,
    'b,
    A: Arithmetic,
    T: Real,
    S: Source<A, T, E, F>,
    const E: usize,
    const F: usize,
    const N: usize,
    const V: usize,
    const MINUS: bool,
    const C: usize,
>(
    columns: &'a mut [[T; N]],
    source: &S,
    factors: &'b [[T; V]],
    (first, end): IndexRange,
) -> (&'a mut [[T; N]], &'b [[T; V]]) {
    if C > 1 && C * (E + F) > sum_register_count(A::WIDE) {
        return (columns, factors);
    }
    let (columns, columns_left) = columns.as_chunks_mut::<C>();
    let mut factors_left = factors;
    for columns in columns {
        let Some((factors, left)) = factors_left.split_first_chunk::<C>() else { break };
        factors_left = left;
        let mut sums = load_columns_into_registers::<A, T, E, F, N, C>(columns);
        for k in first..end.min(V).min(S::COUNT) {
            let from = source.load_column(k);
            for (sums, factors) in sums.iter_mut().zip(factors) {
                let Some(factor) = factors.get(k) else { continue };
                sums.add_multiple::<MINUS>(*factor, &from);
            }
        }
        write::<A, T, E, F, N, C, N>(&sums, columns, 0);
    }
    (columns_left, factors_left)
}

/// Adds products of columns and rows to a matrix, `C` of its columns at a time.
#[inline(always)]
pub fn add_products<
    A: Arithmetic,
    T: Real,
    const E: usize,
    const F: usize,
    const N: usize,
    const W: usize,
    const C: usize,
>(
    sums: &mut [[T; N]; N],
    vectors: &[[T; N]; W],
    factors: &[[T; N]; W],
    (first, end): IndexRange,
) {
    for (place, columns) in sums.as_chunks_mut::<C>().0.iter_mut().enumerate() {
        let mut sums = load_columns_into_registers::<A, T, E, F, N, C>(columns);
        for k in first..end.min(W) {
            let Some(factors) = factors[k].as_chunks::<C>().0.get(place) else { continue };
            let from = Column::read(&vectors[k]);
            for (sums, factor) in sums.iter_mut().zip(factors) {
                sums.add_multiple::<false>(*factor, &from);
            }
        }
        write::<A, T, E, F, N, C, N>(&sums, columns, 0);
    }
}
