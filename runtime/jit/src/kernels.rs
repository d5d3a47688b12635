//! Loops over matrices that are compiled for the host's instructions, such as products with the inverse mass
//! matrix.

#![allow(unsafe_code, reason = "calls of functions for the instructions of the host")]

#[cfg(target_arch = "x86_64")]
mod registers;

/// Number of matrix rows that are computed together.
const ROWS: usize = 8;
/// Minimum number of rows for which registers of eight numbers are used.
const LONG: usize = 12;

/// Loop over matrices, compiled for the instruction set of the host.
pub(crate) trait Kernel {
    /// Runs the loop; `mul_add` computes `a b + c`. The loop is inlined into a function compiled for the
    /// host's instruction set.
    fn run(self, mul_add: impl Fn(f64, f64, f64) -> f64 + Copy);
}

/// Runs a loop over matrices of `n` rows with the instruction set of the host.
pub(crate) fn run_kernel(n: usize, kernel: impl Kernel) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2,fma")]
        fn run_with_fused_multiply_add(kernel: impl Kernel) {
            kernel.run(f64::mul_add);
        }
        #[target_feature(enable = "avx2,fma,avx512f,avx512vl")]
        fn run_with_long_registers(kernel: impl Kernel) {
            kernel.run(f64::mul_add);
        }
        use std::arch::is_x86_feature_detected as has;
        if has!("avx2") && has!("fma") {
            // SAFETY: the processor has these features.
            return match n >= LONG && has!("avx512f") && has!("avx512vl") {
                true => unsafe { run_with_long_registers(kernel) },
                false => unsafe { run_with_fused_multiply_add(kernel) },
            };
        }
    }
    match cfg!(target_arch = "aarch64") {
        true => kernel.run(f64::mul_add),
        false => kernel.run(|a, b, c| a * b + c),
    }
}

/// Group of matrix columns that are multiplied together, with the rows in which they can be nonzero.
pub(crate) struct ColumnGroup {
    /// Indices of the columns in the group, at most [`Columns::MOST`].
    pub columns: Vec<usize>,
    /// Rows that can be nonzero in at least one column of the group.
    pub rows: Vec<usize>,
}

impl ColumnGroup {
    const MOST: usize = 4;

    /// Groups columns of a matrix of `n` rows, according to a predicate of column and row for zero entries.
    pub fn group_columns(
        n: usize,
        columns: &[usize],
        is_zero: impl Fn(usize, usize) -> bool,
    ) -> Vec<ColumnGroup> {
        let groups = columns.chunks(ColumnGroup::MOST).map(|columns| ColumnGroup {
            columns: columns.to_vec(),
            rows: (0..n).filter(|i| columns.iter().any(|j| !is_zero(*j, *i))).collect(),
        });
        groups.collect()
    }
}

/// Adds a multiple of a vector to another vector.
#[inline(always)]
pub(crate) fn add_multiple(
    by: f64,
    vector: &[f64],
    to: &mut [f64],
    mul_add: impl Fn(f64, f64, f64) -> f64 + Copy,
) {
    let (chunks, rest) = vector.as_chunks::<ROWS>();
    let (to_chunks, to_rest) = to.as_chunks_mut::<ROWS>();
    for (to, chunk) in to_chunks.iter_mut().zip(chunks) {
        let mut sums = *to;
        for row in 0..ROWS {
            sums[row] = mul_add(by, chunk[row], sums[row]);
        }
        *to = sums;
    }
    for (to, entry) in to_rest.iter_mut().zip(rest) {
        *to = mul_add(by, *entry, *to);
    }
}

/// Returns the number of workspace values that products of matrices with `n` rows need.
pub(crate) fn work_space_size(n: usize) -> usize {
    ColumnGroup::MOST * n
}

/// Replaces the given columns of each matrix by minus their products with a square matrix of `n` rows. All
/// matrices are stored by columns.
pub(crate) fn replace_by_negative_products<const K: usize>(
    n: usize,
    square: &[f64],
    matrices: [&mut [f64]; K],
    columns: &[Vec<ColumnGroup>; K],
    work: &mut [f64],
) {
    #[cfg(target_arch = "x86_64")]
    if n > ROWS && std::arch::is_x86_feature_detected!("avx512f") {
        // SAFETY: the processor has the feature.
        return unsafe {
            registers::replace_columns_by_negative_products(n, square, matrices, columns, work)
        };
    }
    run_kernel(n, Products { n, square, matrices, columns, work });
}

struct Products<'a, const K: usize> {
    n: usize,
    square: &'a [f64],
    matrices: [&'a mut [f64]; K],
    columns: &'a [Vec<ColumnGroup>; K],
    work: &'a mut [f64],
}

impl<const K: usize> Kernel for Products<'_, K> {
    #[inline(always)]
    fn run(self, mul_add: impl Fn(f64, f64, f64) -> f64 + Copy) {
        let Products { n, square, matrices, columns, work } = self;
        macro_rules! small {
            ($($n:literal)*) => {
                match n {
                    $($n => {
                    return replace_by_fixed_size_products::<$n>(square, matrices, columns, mul_add);
                })*
                    _ => {}
                }
            };
        }
        small! { 1 2 3 4 5 6 7 8 }
        for (matrix, groups) in matrices.into_iter().zip(columns) {
            for group in groups {
                match group.columns.len() {
                    1 => multiply_in_tiles::<1>(n, square, matrix, group, work, mul_add),
                    2 => multiply_in_tiles::<2>(n, square, matrix, group, work, mul_add),
                    3 => multiply_in_tiles::<3>(n, square, matrix, group, work, mul_add),
                    _ => multiply_in_tiles::<4>(n, square, matrix, group, work, mul_add),
                }
            }
        }
    }
}

/// Replaces columns of matrices with `N` rows by minus their products with a square matrix.
#[inline(always)]
fn replace_by_fixed_size_products<'a, const N: usize>(
    square: &[f64],
    matrices: impl IntoIterator<Item = &'a mut [f64]>,
    columns: &[Vec<ColumnGroup>],
    mul_add: impl Fn(f64, f64, f64) -> f64 + Copy,
) {
    let (square, _) = square.as_chunks::<N>();
    for (matrix, groups) in matrices.into_iter().zip(columns) {
        let (matrix, _) = matrix.as_chunks_mut::<N>();
        for group in groups {
            for j in &group.columns {
                let mut sums = [0.0; N];
                for i in &group.rows {
                    for (sum, entry) in sums.iter_mut().zip(&square[*i]) {
                        *sum = mul_add(*entry, -matrix[*j][*i], *sum);
                    }
                }
                matrix[*j] = sums;
            }
        }
    }
}

/// Multiplies matrices of more than [`ROWS`] rows, with `M` columns at a time.
#[inline(always)]
fn multiply_in_tiles<const M: usize>(
    n: usize,
    square: &[f64],
    matrix: &mut [f64],
    group: &ColumnGroup,
    work: &mut [f64],
    mul_add: impl Fn(f64, f64, f64) -> f64 + Copy,
) {
    let (factors, _) = work.as_chunks_mut::<M>();
    for (factors, i) in factors.iter_mut().zip(&group.rows) {
        for (factor, j) in factors.iter_mut().zip(&group.columns) {
            *factor = -matrix[j * n + i];
        }
    }
    for first in (0..n).step_by(ROWS) {
        // Further rows are those of the next column, and zeros behind the last column.
        let mut last = [0.0; ROWS];
        last.iter_mut().zip(&square[(n - 1) * n + first..]).for_each(|(to, from)| *to = *from);
        let mut sums = [[0.0; ROWS]; M];
        for (factors, k) in factors.iter().zip(&group.rows) {
            let chunk = square.get(k * n + first..).and_then(<[f64]>::first_chunk::<ROWS>);
            let column = *chunk.unwrap_or(&last);
            for m in 0..M {
                for row in 0..ROWS {
                    sums[m][row] = mul_add(column[row], factors[m], sums[m][row]);
                }
            }
        }
        for (sum, j) in sums.iter().zip(&group.columns) {
            let rows = &mut matrix[j * n + first..(j + 1) * n];
            match rows.first_chunk_mut() {
                Some(rows) => *rows = *sum,
                None => rows.iter_mut().zip(sum).for_each(|(to, from)| *to = *from),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products with columns that share zeros equal sums over all entries, for all sizes around those of
    /// registers.
    #[test]
    fn products_equal_sums_of_entries() {
        for n in 1..60 {
            let entry = |j: usize, i: usize, k: usize| ((37 * j + 11 * i + 5 * k) % 19) as f64 - 9.0;
            let is_zero = |j: usize, i: usize| j > 5 && i > 5 && j / 3 != i / 3;
            let square: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n, 0)).collect();
            let test_matrix = |which: usize| -> Vec<f64> {
                let entry_with_zeros = |j, i| if is_zero(j, i) { 0.0 } else { entry(j, i, which) };
                (0..n * n).map(|k| entry_with_zeros(k / n, k % n)).collect()
            };
            let (mut first, mut second) = (test_matrix(1), test_matrix(2));
            let columns: Vec<usize> = (0..n).filter(|j| j % 7 != 3).collect();
            let groups = [1, 2].map(|_| ColumnGroup::group_columns(n, &columns, is_zero));
            let mut work = vec![f64::NAN; work_space_size(n)];
            replace_by_negative_products(n, &square, [&mut first, &mut second], &groups, &mut work);
            for (which, found) in [(1, first), (2, second)] {
                let before = test_matrix(which);
                for k in 0..n * n {
                    let (j, i) = (k / n, k % n);
                    let sum: f64 = (0..n).map(|m| square[m * n + i] * before[j * n + m]).sum();
                    // Integers are exact.
                    let expected = if columns.contains(&j) { -sum } else { before[k] };
                    assert_eq!(found[k], expected, "entry ({i}, {j}) of {n} rows");
                }
            }
        }
    }
}
