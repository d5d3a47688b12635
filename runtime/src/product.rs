//! Products with the inverse of a mass matrix, for generated code. They never allocate, as nalgebra's own do for large
//! matrices, and skip what is known to be zero.

use crate::Real;
use crate::arithmetic::{Arithmetic, Vector};
use crate::lanes::{Lanes, Work};
use nalgebra::SMatrix;

/// How many numbers of a column of so many are calculated together: a register of them, a smaller one for columns that do
/// not fill the target's.
#[must_use]
pub const fn width(numbers: usize) -> usize {
    if cfg!(target_feature = "avx512f") && numbers >= 8 { 8 } else { 4 }
}

/// How many registers hold sums at a time. The others are for what is added.
const SUMS: usize = if cfg!(target_feature = "avx512f") { 24 } else { 12 };

/// How many registers the numbers of a column fill.
#[must_use]
pub const fn registers(numbers: usize) -> usize {
    numbers.div_ceil(width(numbers))
}

/// A column in `B` registers of `W` numbers. The last begins as much earlier as it would be too long.
type Column<T, const W: usize, const B: usize> = [Lanes<T, W>; B];

/// Sums in `B` registers.
type Sums<A, T, const W: usize, const B: usize> = [Vector<A, T, W>; B];

/// Columns of a matrix, beginning where lines of the cache do.
#[repr(align(64))]
struct Columns<T, const W: usize, const B: usize, const K: usize>([Column<T, W, B>; K]);

/// A matrix with which another is multiplied: the columns from one number up to another, outside whose given rows there are
/// zeros. All other columns are zero.
pub type Factor<'a, T, const N: usize, const M: usize> =
    (&'a mut SMatrix<T, N, M>, &'a [(usize, usize, &'a [usize])]);

/// Puts minus the products of a matrix with others in the place of these. Columns are read in `B` registers of `W` numbers.
#[inline]
pub fn minus_products<
    A: Arithmetic,
    T: Real,
    const W: usize,
    const B: usize,
    const N: usize,
    const M: usize,
    const COUNT: usize,
>(
    matrix: &SMatrix<T, N, N>,
    factors: [Factor<'_, T, N, M>; COUNT],
) {
    A::within(Products::<T, W, B, N, M, COUNT> { matrix, factors });
}

struct Products<'a, T, const W: usize, const B: usize, const N: usize, const M: usize, const COUNT: usize> {
    matrix: &'a SMatrix<T, N, N>,
    factors: [Factor<'a, T, N, M>; COUNT],
}

impl<T: Real, const W: usize, const B: usize, const N: usize, const M: usize, const COUNT: usize> Work
    for Products<'_, T, W, B, N, M, COUNT>
{
    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let mut columns = Columns::<T, W, B, N>::zero();
        for (column, from) in columns.0.iter_mut().zip(&self.matrix.data.0) {
            pack(from, column);
        }
        for (b, groups) in self.factors {
            for (first, end, rows) in groups {
                let some = b.data.0.get_mut(*first..*end).unwrap_or(&mut []);
                let some = columns.multiply::<A, 4>(some, rows);
                let some = columns.multiply::<A, 3>(some, rows);
                let some = columns.multiply::<A, 2>(some, rows);
                columns.multiply::<A, 1>(some, rows);
            }
        }
    }
}

impl<T: Real, const W: usize, const B: usize, const K: usize> Columns<T, W, B, K> {
    #[inline(always)]
    fn zero() -> Self {
        Self([[Lanes([T::zero(); W]); B]; K])
    }
}

impl<T: Real, const W: usize, const B: usize, const N: usize> Columns<T, W, B, N> {
    /// Puts minus their products in the place of columns, `K` at a time if there are registers enough; returns those that
    /// are left. A single sum has to wait for every addition.
    #[inline(always)]
    fn multiply<'a, A: Arithmetic, const K: usize>(
        &self,
        columns: &'a mut [[T; N]],
        rows: &[usize],
    ) -> &'a mut [[T; N]] {
        if K > 1 && K * B > SUMS {
            return columns;
        }
        let (some, rest) = columns.as_chunks_mut::<K>();
        for some in some {
            let mut sums = [[A::splat(T::zero()); B]; K];
            for &k in rows {
                let Some(from) = self.0.get(k) else { continue };
                for (sums, column) in sums.iter_mut().zip(&*some) {
                    let Some(factor) = column.get(k) else { continue };
                    add_multiple::<A, T, W, B>(sums, *factor, from);
                }
            }
            for (sums, column) in sums.iter_mut().zip(some) {
                for sum in sums.iter_mut() {
                    *sum = -*sum;
                }
                unpack::<A, T, W, B, N>(sums, column);
            }
        }
        rest
    }
}

/// Adds linear combinations of the columns `of` of a matrix to others, each given with its factors. Columns are read in `B`
/// registers of `W` numbers.
#[inline]
pub fn combine<
    A: Arithmetic,
    T: Real,
    const W: usize,
    const B: usize,
    const N: usize,
    const K: usize,
    const M: usize,
>(
    matrix: &mut SMatrix<T, N, N>,
    of: [usize; K],
    others: &[(usize, [T; K]); M],
) {
    A::within(Combinations::<T, W, B, N, K, M> { matrix, of, others });
}

struct Combinations<'a, T, const W: usize, const B: usize, const N: usize, const K: usize, const M: usize> {
    matrix: &'a mut SMatrix<T, N, N>,
    of: [usize; K],
    others: &'a [(usize, [T; K]); M],
}

impl<T: Real, const W: usize, const B: usize, const N: usize, const K: usize, const M: usize> Work
    for Combinations<'_, T, W, B, N, K, M>
{
    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let mut from = Columns::<T, W, B, K>::zero();
        for (column, k) in from.0.iter_mut().zip(self.of) {
            if let Some(given) = self.matrix.data.0.get(k) {
                pack(given, column);
            }
        }
        for (at, factors) in self.others {
            let Some(column) = self.matrix.data.0.get_mut(*at) else { continue };
            let mut start = [Lanes([T::zero(); W]); B];
            pack(column, &mut start);
            let mut sums = [A::splat(T::zero()); B];
            for (sum, start) in sums.iter_mut().zip(start) {
                *sum = Vector::from(start);
            }
            for (from, factor) in from.0.iter().zip(factors) {
                add_multiple::<A, T, W, B>(&mut sums, *factor, from);
            }
            unpack::<A, T, W, B, N>(&sums, column);
        }
    }
}

/// Adds a multiple of a column to sums.
#[inline(always)]
fn add_multiple<A: Arithmetic, T: Real, const W: usize, const B: usize>(
    sums: &mut Sums<A, T, W, B>,
    factor: T,
    column: &Column<T, W, B>,
) {
    let factor = A::splat(factor);
    for (sum, x) in sums.iter_mut().zip(column) {
        *sum = A::mul_add(Vector::from(*x), factor, *sum);
    }
}

/// Where a register begins that belongs to a column of `n` numbers.
#[inline(always)]
fn start<const W: usize>(register: usize, n: usize) -> usize {
    (register * W).min(n.saturating_sub(W))
}

// No function of the standard library that takes closures: those are not always inlined.

#[inline(always)]
fn pack<T: Real, const N: usize, const W: usize, const B: usize>(
    column: &[T; N],
    into: &mut Column<T, W, B>,
) {
    for (register, numbers) in into.iter_mut().enumerate() {
        let rest = column.get(start::<W>(register, N)..).unwrap_or(&[]);
        if let Some(all) = rest.first_chunk() {
            numbers.0 = *all;
        } else {
            for (number, x) in numbers.0.iter_mut().zip(rest) {
                *number = *x;
            }
        }
    }
}

#[inline(always)]
fn unpack<A: Arithmetic, T: Real, const W: usize, const B: usize, const N: usize>(
    sums: &Sums<A, T, W, B>,
    column: &mut [T; N],
) {
    for (register, sum) in sums.iter().enumerate() {
        let rest = column.get_mut(start::<W>(register, N)..).unwrap_or(&mut []);
        let numbers = sum.numbers();
        if let Some(all) = rest.first_chunk_mut() {
            *all = *numbers;
        } else {
            for (place, x) in rest.iter_mut().zip(numbers) {
                *place = *x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::Compiled;

    fn numbers<const N: usize, const M: usize>(seed: f64) -> SMatrix<f64, N, M> {
        SMatrix::from_fn(|i, j| (seed + (i * 7 + 5 * j) as f64).sin())
    }

    /// The product for the compilation's target, and that for the processor where there is one.
    fn product<const W: usize, const B: usize, const N: usize, const M: usize>(
        a: &SMatrix<f64, N, N>,
        b: &SMatrix<f64, N, M>,
        groups: &[(usize, usize, &[usize])],
    ) -> SMatrix<f64, N, M> {
        let (mut found, mut other) = (*b, *b);
        minus_products::<Compiled, _, W, B, N, M, 2>(a, [(&mut found, groups), (&mut other, groups)]);
        assert_eq!(found, other);
        #[cfg(all(
            feature = "std",
            target_arch = "x86_64",
            not(all(target_feature = "avx2", target_feature = "fma"))
        ))]
        if crate::lanes::avx2::is_available() {
            other = *b;
            minus_products::<crate::lanes::avx2::Avx2, _, W, B, N, M, 1>(a, [(&mut other, groups)]);
            assert!((found - other).amax() < 1e-13);
        }
        found
    }

    #[test]
    fn the_product_is_nalgebras() {
        const N: usize = 19;
        let (a, b) = (numbers::<N, N>(0.0), numbers::<N, 10>(1.0));
        let rows: [usize; N] = core::array::from_fn(|k| k);
        let found =
            product::<{ width(N) }, { registers(N) }, N, 10>(&a, &b, &[(0, 3, &rows), (3, 10, &rows)]);
        assert!((found + a * b).amax() < 1e-13);
    }

    #[test]
    fn small_matrices_do_not_fill_a_register() {
        let (a, b) = (numbers::<3, 3>(0.0), numbers::<3, 7>(1.0));
        let found = product::<{ width(3) }, { registers(3) }, 3, 7>(&a, &b, &[(0, 7, &[0, 1, 2])]);
        assert!((found + a * b).amax() < 1e-13);
    }

    #[test]
    fn rows_that_are_not_named_are_skipped() {
        let (a, mut b) = (numbers::<7, 7>(2.0), numbers::<7, 3>(3.0));
        let mut given = b;
        given.column_mut(1).fill(0.0);
        let found = product::<{ width(7) }, { registers(7) }, 7, 3>(
            &a,
            &given,
            &[(0, 1, &[0, 1, 4, 5, 6]), (2, 3, &[6])],
        );
        b.view_mut((2, 0), (2, 1)).fill(0.0);
        b.column_mut(1).fill(0.0);
        b.view_mut((0, 2), (6, 1)).fill(0.0);
        assert!((found + a * b).amax() < 1e-13);
    }

    #[test]
    fn columns_are_combined() {
        let start = numbers::<9, 9>(4.0);
        let mut found = start;
        let others = [(3, [0.5, -2.0]), (8, [1.0, 0.0])];
        combine::<Compiled, _, { width(9) }, { registers(9) }, 9, 2, 2>(&mut found, [1, 7], &others);
        let mut expected = start;
        expected.set_column(3, &(start.column(3) + start.column(1) * 0.5 - start.column(7) * 2.0));
        expected.set_column(8, &(start.column(8) + start.column(1)));
        assert!((found - expected).amax() < 1e-13);
    }
}
