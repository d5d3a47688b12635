//! Products of matrices by registers of eight numbers (AVX-512).

use super::{ColumnGroup, ROWS};
use std::arch::x86_64::{
    __mmask8, _mm512_fmadd_pd, _mm512_mask_storeu_pd, _mm512_maskz_loadu_pd, _mm512_set1_pd,
    _mm512_setzero_pd,
};

/// Number of registers of rows that are computed together.
const MOST: usize = 3;

/// Replaces columns of matrices with `n` rows by minus their products with a square matrix.
#[target_feature(enable = "avx512f")]
pub fn replace_columns_by_negative_products<const K: usize>(
    n: usize,
    square: &[f64],
    matrices: [&mut [f64]; K],
    columns: &[Vec<ColumnGroup>; K],
    work: &mut [f64],
) {
    for (matrix, groups) in matrices.into_iter().zip(columns) {
        for group in groups {
            match group.columns.len() {
                1 => replace_group_by_negative_products::<1>(n, square, matrix, group, work),
                2 => replace_group_by_negative_products::<2>(n, square, matrix, group, work),
                3 => replace_group_by_negative_products::<3>(n, square, matrix, group, work),
                _ => replace_group_by_negative_products::<4>(n, square, matrix, group, work),
            }
        }
    }
}

#[target_feature(enable = "avx512f")]
fn replace_group_by_negative_products<const M: usize>(
    n: usize,
    square: &[f64],
    matrix: &mut [f64],
    group: &ColumnGroup,
    work: &mut [f64],
) {
    let (factors, _) = work.as_chunks_mut::<M>();
    for (factors, i) in factors.iter_mut().zip(&group.rows) {
        for (factor, j) in factors.iter_mut().zip(&group.columns) {
            *factor = -matrix[j * n + i];
        }
    }
    for first in (0..n).step_by(MOST * ROWS) {
        match (n - first).div_ceil(ROWS) {
            1 => compute_product_rows::<M, 1>([n, first], square, matrix, group, factors),
            2 => compute_product_rows::<M, 2>([n, first], square, matrix, group, factors),
            _ => compute_product_rows::<M, MOST>([n, first], square, matrix, group, factors),
        }
    }
}

/// Computes the rows from `first` on, at most those of `R` registers.
#[target_feature(enable = "avx512f")]
fn compute_product_rows<const M: usize, const R: usize>(
    [n, first]: [usize; 2],
    square: &[f64],
    matrix: &mut [f64],
    group: &ColumnGroup,
    factors: &[[f64; M]],
) {
    // Lanes of each register that are rows of the matrix.
    let mut masks: [__mmask8; R] = [u8::MAX; R];
    let last = n - first;
    if last < R * ROWS {
        masks[R - 1] = u8::MAX >> (R * ROWS - last);
    }
    let mut sums = [[_mm512_setzero_pd(); R]; M];
    for (factors, k) in factors.iter().zip(&group.rows) {
        let column = &square[k * n + first..(k + 1) * n];
        let mut rows = [_mm512_setzero_pd(); R];
        for r in 0..R {
            // SAFETY: the lanes of the mask are entries of the column.
            rows[r] = unsafe { _mm512_maskz_loadu_pd(masks[r], column.as_ptr().wrapping_add(ROWS * r)) };
        }
        for m in 0..M {
            let factor = _mm512_set1_pd(factors[m]);
            for r in 0..R {
                sums[m][r] = _mm512_fmadd_pd(rows[r], factor, sums[m][r]);
            }
        }
    }
    for (sums, j) in sums.iter().zip(&group.columns) {
        let column = &mut matrix[j * n + first..(j + 1) * n];
        for r in 0..R {
            // SAFETY: as above.
            unsafe {
                _mm512_mask_storeu_pd(column.as_mut_ptr().wrapping_add(ROWS * r), masks[r], sums[r]);
            }
        }
    }
}
