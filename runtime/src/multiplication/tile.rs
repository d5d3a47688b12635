//! Tiles of a matrix: numbers of rows that are computed together, and the registers that hold them.

use super::column::Columns;
use super::elimination::eliminate_leading_columns;
use super::kernels::{add_all_multiples, add_products, multiply};
use super::{IndexRange, Run};
use crate::Real;
use crate::arithmetic::Arithmetic;
use nalgebra::SMatrix;

/// Linear algebra on the columns of a matrix, divided into tiles that fit in registers.
pub trait Tiling<T: Real, const N: usize> {
    /// Replaces columns by their negative products with a matrix. The columns are zero outside the given
    /// rows.
    fn replace_by_negative_products<A: Arithmetic>(
        matrix: &SMatrix<T, N, N>,
        columns: &mut [[T; N]],
        rows: &[usize],
    );

    /// Adds multiples of vectors to columns, or subtracts them. Only the vectors and factors in `range` are
    /// used.
    fn add_multiples<A: Arithmetic, const V: usize, const W: usize, const MINUS: bool>(
        sums: &mut [[T; N]],
        vectors: &[[T; N]; W],
        factors: &[[T; V]],
        range: IndexRange,
    );

    /// Adds the products of the columns `vectors` and the rows `factors` in `range`. `N` is a multiple of
    /// four.
    fn add_products<A: Arithmetic, const W: usize>(
        sums: &mut [[T; N]; N],
        vectors: &[[T; N]; W],
        factors: &[[T; N]; W],
        range: IndexRange,
    );

    /// Completes the inverse of a block-structured mass matrix for this tiling, as [`complete`] does.
    fn complete_inverse<A: Arithmetic, const K: usize, const V: usize>(
        matrix: &mut SMatrix<T, N, N>,
        trunk: [usize; K],
        factors: &[[T; V]],
        runs: &[Run],
    );

    /// Inverts in place the symmetric positive definite matrix of `K` rows in the leading columns.
    fn invert_leading_block<A: Arithmetic, const K: usize>(columns: &mut [[T; N]; N]);
}

/// Tile of `R` matrix rows, in `E` registers of eight numbers and `F` of four.
#[derive(Clone, Copy, Debug)]
pub struct Tile<const R: usize, const E: usize, const F: usize>;

impl<T: Real, const R: usize, const E: usize, const F: usize, const N: usize> Tiling<T, N> for Tile<R, E, F> {
    #[inline(always)]
    fn replace_by_negative_products<A: Arithmetic>(
        matrix: &SMatrix<T, N, N>,
        columns: &mut [[T; N]],
        rows: &[usize],
    ) {
        let some = multiply::<A, T, R, E, F, N, 4>(matrix, columns, rows);
        let some = multiply::<A, T, R, E, F, N, 3>(matrix, some, rows);
        let some = multiply::<A, T, R, E, F, N, 2>(matrix, some, rows);
        multiply::<A, T, R, E, F, N, 1>(matrix, some, rows);
    }

    #[inline(always)]
    fn add_multiples<A: Arithmetic, const V: usize, const W: usize, const MINUS: bool>(
        sums: &mut [[T; N]],
        vectors: &[[T; N]; W],
        factors: &[[T; V]],
        range: IndexRange,
    ) {
        add_all_multiples::<A, T, _, E, F, N, V, MINUS>(sums, vectors, factors, range);
    }

    #[inline(always)]
    fn add_products<A: Arithmetic, const W: usize>(
        sums: &mut [[T; N]; N],
        vectors: &[[T; N]; W],
        factors: &[[T; N]; W],
        range: IndexRange,
    ) {
        add_products::<A, T, E, F, N, W, 4>(sums, vectors, factors, range);
    }

    #[inline(always)]
    fn complete_inverse<A: Arithmetic, const K: usize, const V: usize>(
        matrix: &mut SMatrix<T, N, N>,
        trunk: [usize; K],
        factors: &[[T; V]],
        runs: &[Run],
    ) {
        let mut known = Columns::<A, T, E, F, K>::zero();
        for (t, k) in trunk.into_iter().enumerate() {
            if let Some(column) = matrix.data.0.get(k) {
                known.set(t, column);
            }
        }
        for ((first, end), range, place) in runs {
            let columns = matrix.data.0.get_mut(*first..*end).unwrap_or(&mut []);
            let factors = factors.get(*place..).unwrap_or(&[]);
            add_all_multiples::<A, T, _, E, F, N, V, false>(columns, &known, factors, *range);
        }
    }

    #[inline(always)]
    fn invert_leading_block<A: Arithmetic, const K: usize>(columns: &mut [[T; N]; N]) {
        eliminate_leading_columns::<A, T, E, F, N, K>(columns);
    }
}

/// Selects the first tiling if registers hold eight numbers, otherwise the second.
impl<T: Real, Wide: Tiling<T, N>, Narrow: Tiling<T, N>, const N: usize> Tiling<T, N> for (Wide, Narrow) {
    #[inline(always)]
    fn replace_by_negative_products<A: Arithmetic>(
        matrix: &SMatrix<T, N, N>,
        columns: &mut [[T; N]],
        rows: &[usize],
    ) {
        if A::WIDE {
            Wide::replace_by_negative_products::<A>(matrix, columns, rows);
        } else {
            Narrow::replace_by_negative_products::<A>(matrix, columns, rows);
        }
    }

    #[inline(always)]
    fn add_multiples<A: Arithmetic, const V: usize, const W: usize, const MINUS: bool>(
        sums: &mut [[T; N]],
        vectors: &[[T; N]; W],
        factors: &[[T; V]],
        range: IndexRange,
    ) {
        if A::WIDE {
            Wide::add_multiples::<A, V, W, MINUS>(sums, vectors, factors, range);
        } else {
            Narrow::add_multiples::<A, V, W, MINUS>(sums, vectors, factors, range);
        }
    }

    #[inline(always)]
    fn add_products<A: Arithmetic, const W: usize>(
        sums: &mut [[T; N]; N],
        vectors: &[[T; N]; W],
        factors: &[[T; N]; W],
        range: IndexRange,
    ) {
        if A::WIDE {
            Wide::add_products::<A, W>(sums, vectors, factors, range);
        } else {
            Narrow::add_products::<A, W>(sums, vectors, factors, range);
        }
    }

    #[inline(always)]
    fn complete_inverse<A: Arithmetic, const K: usize, const V: usize>(
        matrix: &mut SMatrix<T, N, N>,
        trunk: [usize; K],
        factors: &[[T; V]],
        runs: &[Run],
    ) {
        if A::WIDE {
            Wide::complete_inverse::<A, K, V>(matrix, trunk, factors, runs);
        } else {
            Narrow::complete_inverse::<A, K, V>(matrix, trunk, factors, runs);
        }
    }

    #[inline(always)]
    fn invert_leading_block<A: Arithmetic, const K: usize>(columns: &mut [[T; N]; N]) {
        if A::WIDE {
            Wide::invert_leading_block::<A, K>(columns);
        } else {
            Narrow::invert_leading_block::<A, K>(columns);
        }
    }
}
