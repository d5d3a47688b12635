//! Dense products with the inverse mass matrix, for the instructions of the host.

#![allow(unsafe_code, reason = "calls of functions for the instructions of the host")]

/// Rows of a tile.
const ROWS: usize = 8;

/// Columns that are multiplied together, with the rows in which they can be nonzero.
pub(crate) struct Columns {
    /// Indices of at most [`Columns::MOST`] columns.
    pub columns: Vec<usize>,
    /// Rows that are nonzero in one of them.
    pub rows: Vec<usize>,
}

impl Columns {
    const MOST: usize = 4;

    /// Groups columns of a matrix of `n` rows by a predicate of column and row.
    pub fn group(n: usize, columns: &[usize], is_zero: impl Fn(usize, usize) -> bool) -> Vec<Columns> {
        let groups = columns.chunks(Columns::MOST).map(|columns| Columns {
            columns: columns.to_vec(),
            rows: (0..n).filter(|i| columns.iter().any(|j| !is_zero(*j, *i))).collect(),
        });
        groups.collect()
    }
}

/// Number of values of work space that products of matrices with `n` rows need.
pub(crate) fn work(n: usize) -> usize {
    n * n.next_multiple_of(ROWS) + Columns::MOST * n
}

/// Replaces the given columns of each matrix by minus their products with a square matrix of `n` rows. All
/// matrices are stored by columns.
pub(crate) fn minus_products<const K: usize>(
    n: usize,
    square: &[f64],
    matrices: [&mut [f64]; K],
    columns: &[Vec<Columns>; K],
    work: &mut [f64],
) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        #[target_feature(enable = "avx2,fma")]
        fn fused<const K: usize>(
            n: usize,
            square: &[f64],
            matrices: [&mut [f64]; K],
            columns: &[Vec<Columns>; K],
            work: &mut [f64],
        ) {
            products(n, square, matrices, columns, work, f64::mul_add);
        }
        // SAFETY: the processor has these features.
        return unsafe { fused(n, square, matrices, columns, work) };
    }
    #[cfg(target_arch = "aarch64")]
    return products(n, square, matrices, columns, work, f64::mul_add);
    #[cfg(not(target_arch = "aarch64"))]
    products(n, square, matrices, columns, work, |a, b, c| a * b + c);
}

#[inline(always)]
fn products<const K: usize>(
    n: usize,
    square: &[f64],
    matrices: [&mut [f64]; K],
    columns: &[Vec<Columns>; K],
    work: &mut [f64],
    mul_add: impl Fn(f64, f64, f64) -> f64 + Copy,
) {
    let stride = n.next_multiple_of(ROWS);
    let (padded, products) = work.split_at_mut(n * stride);
    for (column, own) in padded.chunks_exact_mut(stride).zip(square.chunks_exact(n)) {
        column[..n].copy_from_slice(own);
        column[n..].fill(0.0);
    }
    for (matrix, groups) in matrices.into_iter().zip(columns) {
        for group in groups {
            match group.columns.len() {
                1 => tiles::<1>(n, padded, matrix, group, products, mul_add),
                2 => tiles::<2>(n, padded, matrix, group, products, mul_add),
                3 => tiles::<3>(n, padded, matrix, group, products, mul_add),
                _ => tiles::<4>(n, padded, matrix, group, products, mul_add),
            }
        }
    }
}

#[inline(always)]
fn tiles<const M: usize>(
    n: usize,
    padded: &[f64],
    matrix: &mut [f64],
    group: &Columns,
    work: &mut [f64],
    mul_add: impl Fn(f64, f64, f64) -> f64 + Copy,
) {
    let stride = n.next_multiple_of(ROWS);
    let (factors, _) = work.as_chunks_mut::<M>();
    for (factors, i) in factors.iter_mut().zip(&group.rows) {
        for (factor, j) in factors.iter_mut().zip(&group.columns) {
            *factor = -matrix[j * n + i];
        }
    }
    for first in (0..n).step_by(ROWS) {
        let mut sums = [[0.0; ROWS]; M];
        for (factors, k) in factors.iter().zip(&group.rows) {
            let Some(column) = padded[k * stride + first..].first_chunk::<ROWS>() else { continue };
            for (sum, factor) in sums.iter_mut().zip(factors) {
                for (sum, entry) in sum.iter_mut().zip(column) {
                    *sum = mul_add(*entry, *factor, *sum);
                }
            }
        }
        let end = n.min(first + ROWS);
        for (sum, j) in sums.iter().zip(&group.columns) {
            matrix[j * n + first..j * n + end].copy_from_slice(&sum[..end - first]);
        }
    }
}
