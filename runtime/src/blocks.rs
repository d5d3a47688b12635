//! Products of matrices of fixed size for loops of the runtime, without copies. The products of nalgebra add
//! columns one by one, and multiply transposed matrices entry by entry.

use crate::Real;
#[cfg(any(test, not(debug_assertions)))]
use crate::arithmetic::dispatch::dispatch;
use crate::arithmetic::{Arithmetic, Compiled};
use nalgebra::{ArrayStorage, SMatrix};

mod nearly;
#[cfg(any(test, not(debug_assertions)))]
mod registers;
#[cfg(any(test, not(debug_assertions)))]
mod small;
mod solve;
#[cfg(test)]
mod tests;

pub use nearly::NearlyIdentity;
pub use solve::{factors, solve, solve_rows_into};

/// Computes `C += A B`. There is a separate function for each size: a few dozen inlined products exceed the
/// instruction cache. In debug builds products are plain loops, which compile and run faster there, and give
/// the same sums.
#[inline(never)]
pub fn add_product<T: Real, const R: usize, const K: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) {
    #[cfg(any(test, not(debug_assertions)))]
    dispatch::<0, T, _, _>(&registers::MatrixProduct { a, b }, sum);
    #[cfg(not(any(test, not(debug_assertions))))]
    add_product_in_loops(sum, 0..K, a, b);
}

/// Adds the product of the columns of `A` and the rows of `B` with these indices.
#[cfg(not(any(test, not(debug_assertions))))]
fn add_product_in_loops<T: Real, const R: usize, const K: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    places: impl Iterator<Item = usize>,
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) {
    for k in places {
        let Some(column) = a.data.0.get(k) else { continue };
        for (sums, factors) in sum.data.0.iter_mut().zip(&b.data.0) {
            let Some(factor) = factors.get(k) else { continue };
            sums.iter_mut().zip(column).for_each(|(sum, entry)| *sum += *entry * *factor);
        }
    }
}

/// Adds the product of some columns of `A`, with the indices `places`, and the corresponding rows of `B`.
#[inline(never)]
pub fn add_product_of_some<T: Real, const R: usize, const K: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    places: &[usize],
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) {
    #[cfg(any(test, not(debug_assertions)))]
    dispatch::<2, T, _, _>(&registers::ChosenColumnsProduct { places, a, b }, sum);
    #[cfg(not(any(test, not(debug_assertions))))]
    add_product_in_loops(sum, places.iter().copied(), a, b);
}

/// Returns the product `A B` of two matrices.
#[inline]
pub fn product<T: Real, const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) -> SMatrix<T, R, C> {
    let mut sum = zeros();
    add_product(&mut sum, a, b);
    sum
}

/// Returns whether all entries of a matrix are zero.
#[inline]
pub fn is_zero<T: Real, const R: usize, const C: usize>(a: &SMatrix<T, R, C>) -> bool {
    // Comparing without early exit lets a column be compared at once.
    a.data.0.iter().all(|column| column.iter().fold(true, |zero, x| zero & (*x == T::zero())))
}

/// Returns a zero matrix, without nalgebra's construction entry by entry.
#[inline]
pub fn zeros<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::from_array_storage(ArrayStorage([[T::zero(); R]; C]))
}

/// Returns the transpose `Aᵀ` of a matrix.
#[inline]
pub fn transposed<T: Real, const R: usize, const C: usize>(a: &SMatrix<T, R, C>) -> SMatrix<T, C, R> {
    let mut turned = zeros();
    transpose_into(a, &mut turned);
    turned
}

/// Writes `Aᵀ` to a matrix, in blocks of four by four, transposed in registers.
#[inline(never)]
pub fn transpose_into<T: Real, const R: usize, const C: usize>(
    a: &SMatrix<T, R, C>,
    into: &mut SMatrix<T, C, R>,
) {
    let turned = &mut into.data.0;
    let (fours, rest) = a.data.0.as_chunks::<4>();
    for (j, columns) in fours.iter().enumerate() {
        let [a, b, c, d] = columns.each_ref().map(|column| column.as_chunks::<4>().0);
        let (rows, left) = turned.as_chunks_mut::<4>();
        for ((((a, b), c), d), rows) in a.iter().zip(b).zip(c).zip(d).zip(rows) {
            for (i, row) in rows.iter_mut().enumerate() {
                if let Some(place) = row.get_mut(4 * j..).and_then(<[T]>::first_chunk_mut::<4>) {
                    *place = [a[i], b[i], c[i], d[i]];
                }
            }
        }
        for (i, row) in (R - R % 4..).zip(left) {
            for (place, column) in row.iter_mut().skip(4 * j).zip(columns) {
                *place = column[i];
            }
        }
    }
    for (j, column) in (C - C % 4..).zip(rest) {
        for (row, x) in turned.iter_mut().zip(column.iter()) {
            if let Some(entry) = row.get_mut(j) {
                *entry = *x;
            }
        }
    }
}

/// Returns the product `A B` with a matrix `B` that is mostly zero.
pub fn product_with_mostly_zero_matrix<T: Real, const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) -> SMatrix<T, R, C> {
    let mut out = zeros::<T, R, C>();
    for (to, factors) in out.data.0.iter_mut().zip(&b.data.0) {
        for (factor, from) in factors.iter().zip(&a.data.0).filter(|(factor, _)| **factor != T::zero()) {
            for (sum, x) in to.iter_mut().zip(from) {
                *sum = Compiled::mul_add(*x, *factor, *sum);
            }
        }
    }
    out
}

/// Adds a multiple of a symmetrised matrix in place: `A += s (B + Bᵀ)`.
#[inline(never)]
pub fn add_with_transpose<T: Real, const N: usize>(sum: &mut SMatrix<T, N, N>, s: T, b: &SMatrix<T, N, N>) {
    let mut turned = zeros();
    transpose_into(b, &mut turned);
    let parts = b.data.0.as_flattened().iter().zip(turned.data.0.as_flattened());
    for (entry, (x, y)) in sum.data.0.as_flattened_mut().iter_mut().zip(parts) {
        *entry = Compiled::mul_add(*x + *y, s, *entry);
    }
}

/// Writes `A + s B` to a matrix.
#[inline]
pub fn write_scaled_sum<T: Real, const R: usize, const C: usize>(
    a: &SMatrix<T, R, C>,
    s: T,
    b: &SMatrix<T, R, C>,
    into: &mut SMatrix<T, R, C>,
) {
    let parts = a.data.0.as_flattened().iter().zip(b.data.0.as_flattened());
    for (entry, (x, y)) in into.data.0.as_flattened_mut().iter_mut().zip(parts) {
        *entry = Compiled::mul_add(*y, s, *x);
    }
}

/// Multiplies a matrix by a number in place: `A *= s`.
#[inline]
pub fn scale<T: Real, const R: usize, const C: usize>(matrix: &mut SMatrix<T, R, C>, s: T) {
    matrix.data.0.as_flattened_mut().iter_mut().for_each(|x| *x *= s);
}

/// Writes the multiple `s A` of a matrix to another matrix.
#[inline]
pub fn write_multiple<T: Real, const R: usize, const C: usize>(
    s: T,
    a: &SMatrix<T, R, C>,
    into: &mut SMatrix<T, R, C>,
) {
    for (entry, x) in into.data.0.as_flattened_mut().iter_mut().zip(a.data.0.as_flattened()) {
        *entry = *x * s;
    }
}

/// Adds a multiple of a matrix in place: `A += s B`.
#[inline]
pub fn add_multiple<T: Real, const R: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    s: T,
    b: &SMatrix<T, R, C>,
) {
    for (entry, x) in sum.data.0.as_flattened_mut().iter_mut().zip(b.data.0.as_flattened()) {
        *entry = Compiled::mul_add(*x, s, *entry);
    }
}

/// Returns `Σ s A` over several factors and matrices.
#[inline]
pub fn weighted_matrix_sum<T: Real, const R: usize, const C: usize, const N: usize>(
    factors: &[T; N],
    matrices: [&SMatrix<T, R, C>; N],
) -> SMatrix<T, R, C> {
    let mut sum = zeros();
    for (s, matrix) in factors.iter().zip(matrices) {
        add_multiple(&mut sum, *s, matrix);
    }
    sum
}

/// Writes the mean of a matrix and its transpose to another matrix, so that asymmetry due to rounding does
/// not accumulate over the steps of a recursion.
#[inline(never)]
pub fn symmetric_into<T: Real, const N: usize>(m: &SMatrix<T, N, N>, into: &mut SMatrix<T, N, N>) {
    let half = crate::private::constant::<T>(0.5);
    transpose_into(m, into);
    for (entry, x) in into.data.0.as_flattened_mut().iter_mut().zip(m.data.0.as_flattened()) {
        *entry = (*entry + *x) * half;
    }
}
