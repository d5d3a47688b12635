//! Inverse of a block-structured mass matrix (`mechanics/derivatives/trunk.rs` of the compiler), in loops:
//! for a large mechanism, straight-line code of these products would exceed the processor's instruction fetch
//! rate.

use super::{IndexRange, Run, Tiling, occupies_several_registers};
use crate::Real;
use crate::arithmetic::Arithmetic;
use crate::lanes::VectorLoop;
use core::marker::PhantomData;
use core::slice::from_ref;
use nalgebra::SMatrix;

/// Completes the inverse mass matrix `M⁻¹ = [0 0; 0 C⁻¹] + H Gᵀ`. On entry, the matrix contains `H` in the
/// columns of the trunk and `C⁻¹` in the others, whose `factors` are columns of `Gᵀ`. Columns are read in
/// tiles as for [`replace_by_negative_products`](super::replace_by_negative_products), but with all rows
/// together.
#[inline]
pub fn complete<A: Arithmetic, T: Real, P: Tiling<T, N>, const N: usize, const K: usize, const M: usize>(
    matrix: &mut SMatrix<T, N, N>,
    trunk: [usize; K],
    factors: &[[T; K]; M],
    runs: &[Run],
) {
    A::run_loop(CompletionLoop::<T, P, N, K, M> { matrix, trunk, factors, runs, parts: PhantomData });
}

struct CompletionLoop<'a, T, P, const N: usize, const K: usize, const M: usize> {
    matrix: &'a mut SMatrix<T, N, N>,
    trunk: [usize; K],
    factors: &'a [[T; K]; M],
    runs: &'a [Run],
    parts: PhantomData<P>,
}

impl<T: Real, P: Tiling<T, N>, const N: usize, const K: usize, const M: usize> VectorLoop
    for CompletionLoop<'_, T, P, N, K, M>
{
    const IS_LONG: bool = occupies_several_registers(N);

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        P::complete_inverse::<A, K, K>(self.matrix, self.trunk, self.factors, self.runs);
    }
}

/// Buffer of matrix columns that is aligned to cache lines. Registers that are loaded soon after they were
/// stored must not cross a cache line.
#[repr(align(64))]
struct AlignedColumns<X>(X);

/// Half-open ranges of the velocities that belong to one limb.
pub type Limb<'a> = &'a [IndexRange];

/// Inverts a mass matrix `M = [A B; Bᵀ C]`. On entry, the matrix contains `C⁻¹` in the columns of the limbs;
/// those of the trunk are ignored. `borders` are the rows of the trunk in `M` by column, padded with zeros;
/// the runs contain their factors by column. The function then multiplies the columns `solved` by the
/// inverse. `P` and `Q` define how columns of `N` and of `L` numbers are read.
#[inline]
pub fn invert<
    A: Arithmetic,
    T: Real,
    P: Tiling<T, N>,
    Q: Tiling<T, L>,
    const N: usize,
    const K: usize,
    const L: usize,
    const S: usize,
>(
    matrix: &mut SMatrix<T, N, N>,
    trunk: [usize; K],
    borders: &[[T; L]; N],
    limbs: &[Limb<'_>],
    runs: &[Run],
    solved: &mut [[T; N]; S],
) {
    let parts = PhantomData;
    A::run_loop(MatrixInversionTask::<T, P, Q, N, K, L, S> {
        matrix,
        trunk,
        borders,
        limbs,
        runs,
        solved,
        parts,
    });
}

struct MatrixInversionTask<'a, T, P, Q, const N: usize, const K: usize, const L: usize, const S: usize> {
    matrix: &'a mut SMatrix<T, N, N>,
    trunk: [usize; K],
    borders: &'a [[T; L]; N],
    limbs: &'a [Limb<'a>],
    runs: &'a [Run],
    solved: &'a mut [[T; N]; S],
    parts: PhantomData<(P, Q)>,
}

impl<
    T: Real,
    P: Tiling<T, N>,
    Q: Tiling<T, L>,
    const N: usize,
    const K: usize,
    const L: usize,
    const S: usize,
> VectorLoop for MatrixInversionTask<'_, T, P, Q, N, K, L, S>
{
    const IS_LONG: bool = occupies_several_registers(N);

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let MatrixInversionTask { matrix, trunk, borders, limbs, runs, solved, .. } = self;
        // Gᵀ = −B C⁻¹ by columns, and the Schur complement S = A + B G, which is initialised with A.
        let mut g = AlignedColumns([[T::zero(); L]; N]);
        let mut inner = AlignedColumns([[T::zero(); L]; L]);
        for (column, k) in inner.0.iter_mut().zip(trunk) {
            if let Some(border) = borders.get(k) {
                *column = *border;
            }
        }
        for limb in limbs {
            for (first, end) in *limb {
                let inverse = matrix.data.0.get(*first..*end).unwrap_or(&[]);
                let columns = g.0.get_mut(*first..*end).unwrap_or(&mut []);
                for rows in *limb {
                    Q::add_multiples::<A, N, N, true>(columns, borders, inverse, *rows);
                }
                Q::add_products::<A, N>(&mut inner.0, borders, &g.0, (*first, *end));
            }
        }
        Q::invert_leading_block::<A, K>(&mut inner.0);
        // H = G S⁻¹, with the identity in the rows of the trunk.
        let mut outer = [[T::zero(); N]; K];
        if limbs.is_empty() {
            for (outer, inner) in outer.iter_mut().zip(&inner.0) {
                for (x, k) in inner.iter().zip(trunk) {
                    set_entry(outer, k, *x);
                }
            }
        } else {
            let mut rows_of_g = rows_from_columns(&g.0);
            for (row, k) in rows_of_g.iter_mut().zip(trunk) {
                set_entry(row, k, T::one());
            }
            P::add_multiples::<A, L, L, false>(&mut outer, &rows_of_g, &inner.0, (0, K));
        }
        for (column, k) in outer.iter().zip(trunk) {
            if let Some(place) = matrix.data.0.get_mut(k) {
                *place = *column;
            }
        }
        P::complete_inverse::<A, K, L>(matrix, trunk, &g.0, runs);
        for column in solved {
            let mut x = [[T::zero(); N]];
            P::add_multiples::<A, N, N, false>(&mut x, &matrix.data.0, from_ref(column), (0, N));
            if limbs.is_empty() {
                // The inverse of an ill-conditioned matrix is accurate enough for the residual, but not for
                // the whole solution (iterative refinement).
                let (mut rest, mut left) = ([[T::zero(); L]], [T::zero(); N]);
                for (rest, k) in rest[0].iter_mut().zip(trunk) {
                    *rest = column.get(k).copied().unwrap_or(T::zero());
                }
                Q::add_multiples::<A, N, N, true>(&mut rest, borders, &x, (0, N));
                for (rest, k) in rest[0].iter().zip(trunk) {
                    set_entry(&mut left, k, *rest);
                }
                P::add_multiples::<A, N, N, false>(&mut x, &matrix.data.0, from_ref(&left), (0, N));
            }
            [*column] = x;
        }
    }
}

/// Returns the rows of a matrix that is given by columns. Blocks of four by four are transposed in registers.
#[inline(always)]
fn rows_from_columns<T: Real, const L: usize, const N: usize>(columns: &[[T; L]; N]) -> [[T; N]; L] {
    let mut rows = [[T::zero(); N]; L];
    let (blocks, rest) = columns.as_chunks::<4>();
    for (k, [a, b, c, d]) in blocks.iter().enumerate() {
        for (t, row) in rows.iter_mut().enumerate() {
            if let Some(place) = row.as_chunks_mut::<4>().0.get_mut(k) {
                *place = [a[t], b[t], c[t], d[t]];
            }
        }
    }
    for (k, column) in rest.iter().enumerate() {
        for (x, row) in column.iter().zip(&mut rows) {
            set_entry(row, N / 4 * 4 + k, *x);
        }
    }
    rows
}

#[inline(always)]
fn set_entry<T, const N: usize>(row: &mut [T; N], k: usize, x: T) {
    if let Some(place) = row.get_mut(k) {
        *place = x;
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{everywhere, pseudorandom_matrix, rows_of};
    use super::super::{Tile, registers_of_eight, registers_of_four};
    use super::*;
    use crate::arithmetic::Compiled;

    #[test]
    fn inverse_columns_are_completed() {
        const N: usize = 14;
        fn check_completed_inverse<A: Arithmetic, P: Tiling<f64, N>, const N: usize, const M: usize>(
            start: &SMatrix<f64, N, N>,
            factors: &[[f64; 3]; M],
            runs: &[Run],
            expected: &SMatrix<f64, N, N>,
        ) {
            let mut found = *start;
            complete::<A, _, P, N, 3, M>(&mut found, TRUNK, factors, runs);
            assert!((found - expected).amax() < 1e-13);
        }
        const TRUNK: [usize; 3] = [9, 1, 7];
        let start = pseudorandom_matrix::<N, N>(4.0);
        let all: SMatrix<f64, 3, N> = pseudorandom_matrix(5.0);
        let runs = [((2, 7), (0, 3), 0), ((10, 13), (1, 3), 5)];
        let (first, last) = ([2, 3, 4, 5, 6], [10, 11, 12]);
        let factors: [[f64; 3]; 8] =
            core::array::from_fn(|k| all.data.0[first.iter().chain(&last).nth(k).copied().unwrap_or(0)]);
        let mut expected = start;
        for ((first, end), (from, to), _) in runs {
            for (j, t) in (first..end).flat_map(|j| (from..to).map(move |t| (j, t))) {
                expected.set_column(j, &(expected.column(j) + start.column(TRUNK[t]) * all[(t, j)]));
            }
        }
        everywhere!(check_completed_inverse by N, (&start, &factors, &runs, &expected));
    }

    /// Returns the rows of a mass matrix that belong to the trunk, one list for each column.
    fn trunk_rows_by_column<const N: usize, const K: usize, const L: usize>(
        mass: &SMatrix<f64, N, N>,
        trunk: [usize; K],
    ) -> [[f64; L]; N] {
        let trunk_mass_entry = |t: usize, k: usize| trunk.get(t).map_or(0.0, |t| mass[(*t, k)]);
        core::array::from_fn(|k| core::array::from_fn(|t| trunk_mass_entry(t, k)))
    }

    /// Returns a mass matrix of two limbs that a trunk connects.
    fn branched_mass_matrix<const N: usize>(trunk: [usize; 3], limbs: &[&[usize]]) -> SMatrix<f64, N, N> {
        let limb_of_index = |k: usize| limbs.iter().position(|limb| limb.contains(&k));
        let a = pseudorandom_matrix::<N, N>(6.0);
        SMatrix::from_fn(|i, j| match (limb_of_index(i), limb_of_index(j)) {
            _ if i == j => 10.0 + a[(i, i)],
            (Some(one), Some(other)) if one != other => 0.0,
            // The first limb does not depend on the last coordinate of the trunk.
            (Some(0), None) if j == trunk[2] => 0.0,
            (None, Some(0)) if i == trunk[2] => 0.0,
            _ => a[(i.min(j), i.max(j))],
        })
    }

    #[test]
    fn mass_matrix_is_inverted_by_blocks() {
        const N: usize = 14;
        const TRUNK: [usize; 3] = [9, 1, 7];
        // The second limb is not contiguous.
        const LIMBS: [&[usize]; 2] = [&[2, 3, 4, 5, 6], &[0, 8, 10, 11, 12, 13]];
        fn check_branched_inverse<A: Arithmetic, P: Tiling<f64, N>, const N: usize, const M: usize>(
            mass: &SMatrix<f64, N, N>,
            right: &SMatrix<f64, N, M>,
        ) {
            let mut found = pseudorandom_matrix::<N, N>(7.0);
            for limb in LIMBS {
                let mut block = SMatrix::<f64, N, N>::identity();
                limb.iter().for_each(|&i| limb.iter().for_each(|&j| block[(i, j)] = mass[(i, j)]));
                let inverse = block.try_inverse().unwrap();
                for &k in limb {
                    found.set_column(k, &inverse.column(k));
                }
            }
            let limbs: [Limb<'_>; 2] = [&[(2, 7)], &[(0, 1), (8, 9), (10, 14)]];
            let runs =
                [((2, 7), (0, 2), 2), ((0, 1), (0, 3), 0), ((8, 9), (0, 3), 8), ((10, 14), (0, 3), 10)];
            let mut solved = right.data.0;
            invert::<A, f64, P, InnerTile, N, 3, 4, M>(
                &mut found,
                TRUNK,
                &trunk_rows_by_column(mass, TRUNK),
                &limbs,
                &runs,
                &mut solved,
            );
            assert!((found * mass - SMatrix::<f64, N, N>::identity()).amax() < 1e-13);
            let solved = SMatrix::<f64, N, M>::from_array_storage(nalgebra::ArrayStorage(solved));
            assert!((mass * solved - right).amax() < 1e-12);
        }
        type InnerTile = (rows_of!(4, true), rows_of!(4, false));
        let mass = branched_mass_matrix(TRUNK, &LIMBS);
        everywhere!(check_branched_inverse by N, (&mass, &pseudorandom_matrix::<N, 2>(8.0)));
    }

    #[test]
    fn inverse_without_limbs_uses_all_rows() {
        const N: usize = 13;
        fn check_scaled_inverse<A: Arithmetic, P: Tiling<f64, N>, const N: usize, const M: usize>(
            mass: &SMatrix<f64, N, N>,
            scale: &SMatrix<f64, N, M>,
        ) {
            let scaled: SMatrix<f64, N, N> = SMatrix::from_fn(|i, j| scale[i] * mass[(i, j)] * scale[j]);
            let trunk: [usize; N] = core::array::from_fn(|k| (5 * k + 2) % N);
            let mut found = SMatrix::zeros();
            invert::<A, f64, P, InnerTile, N, N, 16, 0>(
                &mut found,
                trunk,
                &trunk_rows_by_column(&scaled, trunk),
                &[],
                &[],
                &mut [],
            );
            let found: SMatrix<f64, N, N> = SMatrix::from_fn(|i, j| scale[i] * found[(i, j)] * scale[j]);
            assert!((found * mass - SMatrix::<f64, N, N>::identity()).amax() < 1e-12);
        }
        type InnerTile = (rows_of!(16, true), rows_of!(16, false));
        let factor = pseudorandom_matrix::<N, N>(9.0);
        let mass = factor * factor.transpose() + SMatrix::identity();
        // Pivots whose magnitudes differ by orders of magnitude.
        let scale = SMatrix::<f64, N, 1>::from_fn(|k, _| 4.0_f64.powi(k as i32 - 6));
        everywhere!(check_scaled_inverse by N, (&mass, &scale));
    }

    #[test]
    fn ill_conditioned_inverse_solves_equations() {
        const N: usize = 13;
        fn check_solved_columns<A: Arithmetic, P: Tiling<f64, N>, const N: usize, const M: usize>(
            mass: &SMatrix<f64, N, N>,
            right: &SMatrix<f64, N, M>,
        ) {
            let trunk: [usize; N] = core::array::from_fn(|k| k);
            let (mut inverse, mut solved) = (SMatrix::zeros(), right.data.0);
            invert::<A, f64, P, InnerTile, N, N, 16, M>(
                &mut inverse,
                trunk,
                &trunk_rows_by_column(mass, trunk),
                &[],
                &[],
                &mut solved,
            );
            let x = SMatrix::<f64, N, M>::from_array_storage(nalgebra::ArrayStorage(solved));
            let error = (mass * x - right).amax() / (mass.abs() * x.abs()).amax();
            assert!(error < 1e-13);
        }
        type InnerTile = (rows_of!(16, true), rows_of!(16, false));
        // Rank two, except for small numbers on the diagonal.
        let factor = pseudorandom_matrix::<N, N>(9.0);
        let mass = factor * factor.transpose() + SMatrix::identity() * 1e-8;
        everywhere!(check_solved_columns by N, (&mass, &pseudorandom_matrix::<N, 2>(10.0)));
    }
}
