//! The inverse of a mass matrix and products with it, for generated code. They never allocate, as nalgebra's own do for large
//! matrices, and skip what is known to be zero.

mod column;
pub(crate) use column::{part, put};
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

/// Whether a list of this many numbers fills several registers of eight.
const fn is_long(numbers: usize) -> bool {
    registers_of_eight(numbers, true) > 1
}

/// How many of so many rows of a matrix are calculated together: all if they leave registers for several columns.
#[must_use]
pub const fn rows(numbers: usize, wide: bool) -> usize {
    let most = if wide { 48 } else { 24 };
    if numbers <= most {
        return numbers;
    }
    let blocks = numbers.div_ceil(most / 2);
    numbers.div_ceil(blocks).next_multiple_of(4)
}

/// Neighbouring rows or columns, from one up to another.
type Range = (usize, usize);

/// Neighbouring columns, the rows of the trunk where their factors are not zero, and the place of the first one's factors.
pub type Run = (Range, Range, usize);

/// A matrix with which another is multiplied; column and row of what has to be made zero in it; and its columns, from one up to
/// another, outside whose given rows there are zeros. All other columns are zero.
pub type Factor<'a, T, const N: usize, const M: usize> =
    (&'a mut SMatrix<T, N, M>, &'a [(usize, usize)], &'a [(Range, &'a [usize])]);

/// Puts minus the products of a matrix with others in the place of these.
#[inline]
pub fn minus_products<
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
    A::run_loop(Products::<T, P, N, M, COUNT> { matrix, factors, parts: PhantomData });
}

struct Products<'a, T, P, const N: usize, const M: usize, const COUNT: usize> {
    matrix: &'a SMatrix<T, N, N>,
    factors: [Factor<'a, T, N, M>; COUNT],
    parts: PhantomData<P>,
}

impl<T: Real, P: Tiling<T, N>, const N: usize, const M: usize, const COUNT: usize> VectorLoop
    for Products<'_, T, P, N, M, COUNT>
{
    const IS_LONG: bool = is_long(N);

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        for (b, zeros, groups) in self.factors {
            clear(b, zeros);
            for ((first, end), rows) in groups {
                let some = b.data.0.get_mut(*first..*end).unwrap_or(&mut []);
                P::multiply::<A>(self.matrix, some, rows);
            }
        }
    }
}

/// Makes entries zero.
#[inline(always)]
fn clear<T: Real, const N: usize, const M: usize>(matrix: &mut SMatrix<T, N, M>, zeros: &[(usize, usize)]) {
    for (column, row) in zeros {
        if let Some(entry) = matrix.data.0.get_mut(*column).and_then(|column| column.get_mut(*row)) {
            *entry = T::zero();
        }
    }
}
