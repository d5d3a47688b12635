//! Products with the inverse of a mass matrix, for generated code. They never allocate, as nalgebra's own do for large
//! matrices, and skip what is known to be zero.

use crate::Real;
use crate::arithmetic::{Arithmetic, Compiled};
use crate::lanes::Lanes;
use nalgebra::SMatrix;

/// How many numbers of a column are read together.
const WIDTH: usize = 8;

/// Two columns are multiplied at once only where their sums have registers enough.
const IN_PAIRS: bool = cfg!(target_feature = "avx512f");

/// A column in `B` registers, the last filled up.
type Column<T, const B: usize> = [Lanes<T, WIDTH>; B];

/// The `N` columns of a square matrix, each in `B` registers, beginning where lines of the cache do.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct Columns<T, const B: usize, const N: usize>([Column<T, B>; N]);

impl<T: Real, const B: usize, const N: usize> Columns<T, B, N> {
    /// The columns of a matrix.
    #[inline]
    pub fn of(matrix: &SMatrix<T, N, N>) -> Self {
        let mut columns = [[Lanes([T::zero(); WIDTH]); B]; N];
        for (column, from) in columns.iter_mut().zip(&matrix.data.0) {
            *column = packed(from);
        }
        Self(columns)
    }

    /// Puts minus the product with this matrix in the place of columns of `b`: of those from one number up to another,
    /// outside whose given rows there are zeros. All others are zero.
    #[inline]
    pub fn minus_times<const M: usize>(
        &self,
        b: &mut SMatrix<T, N, M>,
        columns: &[(usize, usize, &[usize])],
    ) {
        for (first, end, rows) in columns {
            let some = b.data.0.get_mut(*first..*end).unwrap_or(&mut []);
            let paired = if IN_PAIRS { some.len() } else { 0 };
            let (some, single) = some.split_at_mut(paired);
            let (pairs, rest) = some.as_chunks_mut::<2>();
            for [x, y] in pairs {
                let [x_sums, y_sums] = self.sums([x, y], rows);
                unpack(&x_sums, x);
                unpack(&y_sums, y);
            }
            for x in rest.iter_mut().chain(single) {
                let [sums] = self.sums([x], rows);
                unpack(&sums, x);
            }
        }
    }

    /// Minus the products with some columns: several at once, since a sum has to wait for every addition.
    #[inline(always)]
    fn sums<const K: usize>(&self, columns: [&[T; N]; K], rows: &[usize]) -> [Column<T, B>; K] {
        let mut sums = [[Lanes([T::zero(); WIDTH]); B]; K];
        for &k in rows {
            let Some(from) = self.0.get(k) else { continue };
            for (sums, column) in sums.iter_mut().zip(columns) {
                let factor = Lanes::splat(-column.get(k).copied().unwrap_or(T::zero()));
                for (sum, x) in sums.iter_mut().zip(from) {
                    *sum = Compiled::mul_add(*x, factor, *sum);
                }
            }
        }
        sums
    }
}

/// Adds linear combinations of the columns `of` of a matrix to others, each given with its factors. Columns are read in `B`
/// registers.
#[inline]
pub fn combine<T: Real, const B: usize, const N: usize, const K: usize, const M: usize>(
    matrix: &mut SMatrix<T, N, N>,
    of: [usize; K],
    others: &[(usize, [T; K]); M],
) {
    let mut from = [[Lanes([T::zero(); WIDTH]); B]; K];
    for (packed_column, k) in from.iter_mut().zip(of) {
        *packed_column = matrix.data.0.get(k).map_or(*packed_column, packed);
    }
    for (at, factors) in others {
        let Some(column) = matrix.data.0.get_mut(*at) else { continue };
        let mut sums: Column<T, B> = packed(column);
        for (from, factor) in from.iter().zip(factors) {
            let factor = Lanes::splat(*factor);
            for (sum, x) in sums.iter_mut().zip(from) {
                *sum = Compiled::mul_add(*x, factor, *sum);
            }
        }
        unpack(&sums, column);
    }
}

#[inline(always)]
fn packed<T: Real, const N: usize, const B: usize>(column: &[T; N]) -> Column<T, B> {
    core::array::from_fn(|block| {
        let rest = column.get(block * WIDTH..).unwrap_or(&[]);
        match rest.first_chunk() {
            Some(numbers) => Lanes(*numbers),
            None => Lanes(core::array::from_fn(|k| rest.get(k).copied().unwrap_or(T::zero()))),
        }
    })
}

#[inline(always)]
fn unpack<T: Real, const N: usize, const B: usize>(packed: &Column<T, B>, column: &mut [T; N]) {
    for (block, numbers) in packed.iter().enumerate() {
        let rest = column.get_mut(block * WIDTH..).unwrap_or(&mut []);
        match rest.first_chunk_mut() {
            Some(place) => *place = numbers.0,
            None => rest.iter_mut().zip(numbers.0).for_each(|(place, x)| *place = x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers<const N: usize, const M: usize>(seed: f64) -> SMatrix<f64, N, M> {
        SMatrix::from_fn(|i, j| (seed + (i * 7 + 5 * j) as f64).sin())
    }

    #[test]
    fn the_product_is_nalgebras() {
        let (a, b) = (numbers::<19, 19>(0.0), numbers::<19, 9>(1.0));
        let mut found = b;
        Columns::<_, 3, 19>::of(&a)
            .minus_times(&mut found, &[(0, 9, &core::array::from_fn::<_, 19, _>(|k| k))]);
        assert!((found + a * b).amax() < 1e-13);
    }

    #[test]
    fn rows_that_are_not_named_are_skipped() {
        let (a, mut b) = (numbers::<7, 7>(2.0), numbers::<7, 3>(3.0));
        let mut found = b;
        found.column_mut(1).fill(0.0);
        Columns::<_, 1, 7>::of(&a).minus_times(&mut found, &[(0, 1, &[0, 1, 4, 5, 6]), (2, 3, &[6])]);
        b.view_mut((2, 0), (2, 1)).fill(0.0);
        b.column_mut(1).fill(0.0);
        b.view_mut((0, 2), (6, 1)).fill(0.0);
        assert!((found + a * b).amax() < 1e-13);
    }

    #[test]
    fn columns_are_combined() {
        let start = numbers::<9, 9>(4.0);
        let mut found = start;
        combine::<_, 2, 9, 2, 2>(&mut found, [1, 7], &[(3, [0.5, -2.0]), (8, [1.0, 0.0])]);
        let mut expected = start;
        expected.set_column(3, &(start.column(3) + start.column(1) * 0.5 - start.column(7) * 2.0));
        expected.set_column(8, &(start.column(8) + start.column(1)));
        assert!((found - expected).amax() < 1e-13);
    }
}
