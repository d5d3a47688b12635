//! Inverse of a mass matrix and products with it, for generated code. The functions never allocate, unlike
//! nalgebra's own for large matrices, and skip structural zeros.

mod column;
pub(crate) use column::{part, write_entries};
mod elimination;
mod inverse;
mod kernels;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod tile;

use crate::Real;
use crate::arithmetic::Arithmetic;
use crate::lanes::VectorLoop;
pub use column::{registers_of_eight, registers_of_four};
use core::marker::PhantomData;
pub use inverse::{complete, invert};
use nalgebra::SMatrix;
pub use tile::{Tile, Tiling};

/// Whether a column of this length occupies several SIMD registers of eight numbers.
const fn occupies_several_registers(numbers: usize) -> bool {
    registers_of_eight(numbers, true) > 1
}

/// Returns the number of rows of a matrix that are computed together: all rows if enough registers remain for
/// several columns.
#[must_use]
pub const fn rows(numbers: usize, wide: bool) -> usize {
    let most = if wide { 48 } else { 24 };
    if numbers <= most {
        return numbers;
    }
    let blocks = numbers.div_ceil(most / 2);
    numbers.div_ceil(blocks).next_multiple_of(4)
}

/// Half-open range of adjacent rows or columns.
type IndexRange = (usize, usize);

/// Run of neighbouring columns: their range, the rows of the trunk in which their factors are nonzero, and
/// the index of the first column's factors.
pub type Run = (IndexRange, IndexRange, usize);

/// Matrix to be multiplied by another; column and row of the entries to set to zero in it; and half-open
/// ranges of its columns with the rows that can be nonzero. All other columns are zero.
pub type Factor<'a, T, const N: usize, const M: usize> =
    (&'a mut SMatrix<T, N, M>, &'a [(usize, usize)], &'a [(IndexRange, &'a [usize])]);

/// Replaces each matrix by its negative product with `matrix`.
#[inline]
pub fn replace_by_negative_products<
    A: Arithmetic,
    T: Real,
    P: Tiling<T, N>,
    const N: usize,
    const M: usize,
    const COUNT: usize,
>(
    matrix: &SMatrix<T, N, N>,
    factors: [Factor<'_, T, N, M>; COUNT],
) {
    A::run_loop(NegatedMatrixProducts::<T, P, N, M, COUNT> { matrix, factors, parts: PhantomData });
}

struct NegatedMatrixProducts<'a, T, P, const N: usize, const M: usize, const COUNT: usize> {
    matrix: &'a SMatrix<T, N, N>,
    factors: [Factor<'a, T, N, M>; COUNT],
    parts: PhantomData<P>,
}

impl<T: Real, P: Tiling<T, N>, const N: usize, const M: usize, const COUNT: usize> VectorLoop
    for NegatedMatrixProducts<'_, T, P, N, M, COUNT>
{
    const IS_LONG: bool = occupies_several_registers(N);

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        for (b, zeros, groups) in self.factors {
            clear_entries(b, zeros);
            for ((first, end), rows) in groups {
                let some = b.data.0.get_mut(*first..*end).unwrap_or(&mut []);
                P::replace_by_negative_products::<A>(self.matrix, some, rows);
            }
        }
    }
}

/// Sets entries of a matrix, listed by column and row, to zero.
#[inline(always)]
pub(crate) fn clear_entries<T: Real, const N: usize, const M: usize>(
    matrix: &mut SMatrix<T, N, M>,
    zeros: &[(usize, usize)],
) {
    for (column, row) in zeros {
        if let Some(entry) = matrix.data.0.get_mut(*column).and_then(|column| column.get_mut(*row)) {
            *entry = T::zero();
        }
    }
}
