//! Solution of symmetric linear systems for many right-hand sides, one SIMD register of right-hand sides at a
//! time.

use super::{transposed, zeros};
use crate::Real;
use crate::arithmetic::dispatch::{Evaluate, dispatch};
use crate::arithmetic::{Arithmetic, Compiled};
use crate::multiplication::{part, registers_of_eight, registers_of_four, write_entries};
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// Returns the factors `L` (below the diagonal) and `1/D` of the regularised symmetric matrix
/// `H + r = L D Lᵀ`, where `L` has ones on its diagonal. The error is the index of a pivot that is not
/// positive.
pub fn factors<T: Real, const N: usize>(
    matrix: &SMatrix<T, N, N>,
    regularisation: T,
) -> Result<(SMatrix<T, N, N>, SVector<T, N>), usize> {
    let (mut l, mut inverse) = (matrix.data.0, [T::zero(); N]);
    for j in 0..N {
        let column = l[j];
        let pivot = column[j] + regularisation;
        if !(pivot > T::zero() && pivot.is_finite()) {
            return Err(j);
        }
        inverse[j] = T::one() / pivot;
        let mut scaled = column;
        scaled.iter_mut().for_each(|x| *x *= inverse[j]);
        // Whole columns: entries above the diagonal are never read.
        for k in j + 1..N {
            for (entry, x) in l[k].iter_mut().zip(&column) {
                *entry = Compiled::neg_mul_add(*x, scaled[k], *entry);
            }
        }
        l[j] = scaled;
    }
    let matrix_from_storage = |x| SMatrix::from_array_storage(ArrayStorage(x));
    Ok((matrix_from_storage(l), SMatrix::from_array_storage(ArrayStorage([inverse]))))
}

/// Replaces the matrix `B` by `−(L D Lᵀ)⁻¹ B`, given the factors `L` and `1/D`.
pub fn solve<T: Real, const N: usize, const C: usize>(
    l: &SMatrix<T, N, N>,
    inverse: &SVector<T, N>,
    b: &mut SMatrix<T, N, C>,
) {
    *b = transposed(&negative_rows_times_inverse(l, inverse, &transposed(b)));
}

/// Returns the matrix `−B (L D Lᵀ)⁻¹`, given the factors `L` and `1/D`.
fn negative_rows_times_inverse<T: Real, const N: usize, const R: usize>(
    l: &SMatrix<T, N, N>,
    inverse: &SVector<T, N>,
    b: &SMatrix<T, R, N>,
) -> SMatrix<T, R, N> {
    let mut solved = zeros();
    solve_rows_into(l, inverse, b, &mut solved);
    solved
}

/// Writes the matrix `−B (L D Lᵀ)⁻¹` to `into`, given the factors `L` and `1/D`.
#[inline(never)]
pub fn solve_rows_into<T: Real, const N: usize, const R: usize>(
    l: &SMatrix<T, N, N>,
    inverse: &SVector<T, N>,
    b: &SMatrix<T, R, N>,
    into: &mut SMatrix<T, R, N>,
) {
    dispatch::<1, T, _, _>(&SymmetricSystem { l, inverse, b }, into);
}

/// Factors and right-hand sides of a symmetric linear system.
pub(super) struct SymmetricSystem<'a, T, const N: usize, const R: usize> {
    pub(super) l: &'a SMatrix<T, N, N>,
    pub(super) inverse: &'a SVector<T, N>,
    pub(super) b: &'a SMatrix<T, R, N>,
}

impl<T: Real, const N: usize, const R: usize> Evaluate<1, &mut SMatrix<T, R, N>>
    for SymmetricSystem<'_, T, N, R>
{
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, out: &mut SMatrix<T, R, N>) {
        let out = &mut out.data.0;
        // The last register overlaps the previous one if fewer rows remain; the common rows are solved twice.
        if A::WIDE && R >= 8 {
            let eights = registers_of_eight(R, true);
            (0..eights).for_each(|k| self.solve_one_register::<A, 8>(out, 8 * k));
            if registers_of_four(R, true) > 0 {
                self.solve_one_register::<A, 4>(out, 8 * eights);
            }
        } else if R >= 4 {
            (0..R).step_by(4).for_each(|from| self.solve_one_register::<A, 4>(out, from));
        } else {
            (0..R).for_each(|from| self.solve_one_register::<A, 1>(out, from));
        }
    }
}

impl<T: Real, const N: usize, const R: usize> SymmetricSystem<'_, T, N, R> {
    /// Solves the linear system for one register of right-hand sides, beginning with the one at index `from`.
    #[inline(always)]
    fn solve_one_register<A: Arithmetic, const W: usize>(&self, out: &mut [[T; R]; N], from: usize) {
        let (l, inverse) = (&self.l.data.0, &self.inverse.data.0[0]);
        let mut x = [A::splat(T::zero()); N];
        for (x, column) in x.iter_mut().zip(&self.b.data.0) {
            *x = part::<A, T, W>(column, from);
        }
        for j in 0..N {
            let own = x[j];
            for i in j + 1..N {
                x[i] = A::neg_mul_add(own, A::splat(l[j][i]), x[i]);
            }
        }
        for (x, inverse) in x.iter_mut().zip(inverse) {
            *x = *x * A::splat(-*inverse);
        }
        // Each unknown is substituted into all remaining equations at once: a sum for each unknown would wait
        // for one addition after another.
        for j in (0..N).rev() {
            let own = x[j];
            for i in 0..j {
                x[i] = A::neg_mul_add(own, A::splat(l[i][j]), x[i]);
            }
        }
        for (column, x) in out.iter_mut().zip(&x) {
            write_entries(x, column, from);
        }
    }
}
