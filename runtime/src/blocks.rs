//! Products of matrices of fixed sizes for loops of the runtime, without copies. nalgebra's own add columns one by one, and
//! multiply transposed matrices entry by entry.

use crate::Real;
use crate::arithmetic::dispatch::{Evaluate, dispatch};
use crate::arithmetic::{Arithmetic, Compiled, Vector};
use crate::multiplication::{part, put};
use core::array::{from_mut, from_ref};
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// `C += A B`. A function of its own for each size: a few dozen products written out one after another are longer than the
/// instruction cache.
#[inline(never)]
pub fn add_product<T: Real, const R: usize, const K: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) {
    dispatch::<0, T, _, _>(&Product { a, b }, sum);
}

/// What is multiplied.
struct Product<'a, T, const R: usize, const K: usize, const C: usize> {
    a: &'a SMatrix<T, R, K>,
    b: &'a SMatrix<T, K, C>,
}

impl<T: Real, const R: usize, const K: usize, const C: usize> Evaluate<0, &mut SMatrix<T, R, C>>
    for Product<'_, T, R, K, C>
{
    type Output = ();

    /// Eight rows of four columns at a time, or as many as are left, which leaves registers for what is added.
    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, sum: &mut SMatrix<T, R, C>) {
        let (columns, a, b) = (&mut sum.data.0, rolled(&self.a.data.0), &self.b.data.0);
        let mut from = 0;
        for _ in 0..R / 8 {
            strip::<A, T, 8, R, K, C>(columns, a, b, from);
            from += 8;
        }
        if R % 8 >= 4 {
            strip::<A, T, 4, R, K, C>(columns, a, b, from);
            from += 4;
        }
        if R % 4 >= 2 {
            strip::<A, T, 2, R, K, C>(columns, a, b, from);
            from += 2;
        }
        if R % 2 == 1 {
            strip::<A, T, 1, R, K, C>(columns, a, b, from);
        }
    }
}

/// A list whose length the compiler does not know: it would write out its loops.
#[inline(always)]
fn rolled<T>(list: &[T]) -> &[T] {
    core::hint::black_box(list)
}

/// So many rows from one on, of all columns.
#[inline(always)]
fn strip<A: Arithmetic, T: Real, const W: usize, const R: usize, const K: usize, const C: usize>(
    columns: &mut [[T; R]; C],
    a: &[[T; R]],
    b: &[[T; K]; C],
    from: usize,
) {
    let (fours, rest) = columns.as_chunks_mut::<4>();
    let (factors, last) = b.as_chunks::<4>();
    for (columns, b) in fours.iter_mut().zip(factors) {
        tile::<A, T, W, 4, R, K>(columns, a, b, from);
    }
    for (column, b) in rest.iter_mut().zip(last) {
        tile::<A, T, W, 1, R, K>(from_mut(column), a, from_ref(b), from);
    }
}

/// So many rows from one on, of some columns.
#[inline(always)]
fn tile<A: Arithmetic, T: Real, const W: usize, const G: usize, const R: usize, const K: usize>(
    columns: &mut [[T; R]; G],
    a: &[[T; R]],
    b: &[[T; K]; G],
    from: usize,
) {
    let mut all: [Vector<A, T, W>; G] = core::array::from_fn(|g| part(&columns[g], from));
    for (k, column) in a.iter().enumerate() {
        let x = part::<A, T, W>(column, from);
        for (entry, factors) in all.iter_mut().zip(b) {
            if let Some(factor) = factors.get(k) {
                *entry = A::mul_add(x, A::splat(*factor), *entry);
            }
        }
    }
    for (column, register) in columns.iter_mut().zip(&all) {
        put(register, column, from);
    }
}

/// `A B`.
#[inline]
pub fn product<T: Real, const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) -> SMatrix<T, R, C> {
    let mut sum = zeros();
    add_product(&mut sum, a, b);
    sum
}

/// Whether all entries are zero.
#[inline]
pub fn is_zero<T: Real, const R: usize, const C: usize>(a: &SMatrix<T, R, C>) -> bool {
    a.data.0.iter().all(|column| column.iter().all(|x| *x == T::zero()))
}

/// Zeros, without nalgebra's own construction entry by entry.
#[inline]
pub fn zeros<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::from_array_storage(ArrayStorage([[T::zero(); R]; C]))
}

/// `Aᵀ`.
#[inline(never)]
pub fn transposed<T: Real, const R: usize, const C: usize>(a: &SMatrix<T, R, C>) -> SMatrix<T, C, R> {
    let mut turned = [[T::zero(); C]; R];
    for (j, column) in a.data.0.iter().enumerate() {
        for (row, x) in turned.iter_mut().zip(column) {
            if let Some(entry) = row.get_mut(j) {
                *entry = *x;
            }
        }
    }
    SMatrix::from_array_storage(ArrayStorage(turned))
}

/// Whether a column is that of the identity.
fn is_unit<T: Real, const N: usize>(column: &[T; N], j: usize) -> bool {
    column.iter().enumerate().all(|(i, x)| *x == if i == j { T::one() } else { T::zero() })
}

/// `A D`, where most columns of `D` are those of the identity.
pub fn times_nearly_identity<T: Real, const R: usize, const N: usize>(
    a: &SMatrix<T, R, N>,
    d: &SMatrix<T, N, N>,
) -> SMatrix<T, R, N> {
    let mut out = *a;
    for (j, (to, factors)) in out.data.0.iter_mut().zip(&d.data.0).enumerate() {
        if is_unit(factors, j) {
            continue;
        }
        *to = [T::zero(); R];
        for (factor, from) in factors.iter().zip(&a.data.0).filter(|(factor, _)| **factor != T::zero()) {
            for (sum, x) in to.iter_mut().zip(from) {
                *sum = Compiled::mul_add(*x, *factor, *sum);
            }
        }
    }
    out
}

/// `D A`, where most columns of `D` are those of the identity.
pub fn nearly_identity_times<T: Real, const N: usize, const C: usize>(
    d: &SMatrix<T, N, N>,
    a: &SMatrix<T, N, C>,
) -> SMatrix<T, N, C> {
    let mut out = *a;
    for (j, column) in d.data.0.iter().enumerate().filter(|(j, column)| !is_unit(column, *j)) {
        let mut beyond = *column;
        beyond.iter_mut().skip(j).take(1).for_each(|x| *x -= T::one());
        for (to, from) in out.data.0.iter_mut().zip(&a.data.0) {
            let factor = from.get(j).copied().unwrap_or(T::zero());
            for (sum, x) in to.iter_mut().zip(&beyond) {
                *sum = Compiled::mul_add(*x, factor, *sum);
            }
        }
    }
    out
}

/// `A += s B`.
#[inline]
pub fn add_multiple<T: Real, const R: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    s: T,
    b: &SMatrix<T, R, C>,
) {
    for (entry, x) in sum.data.0.as_flattened_mut().iter_mut().zip(b.data.0.as_flattened()) {
        *entry = Compiled::mul_add(*x, s, *entry);
    }
}

/// A matrix and its transpose become their mean: rounding must not grow from instant to instant.
#[inline(never)]
pub fn make_symmetric<T: Real, const N: usize>(m: &mut SMatrix<T, N, N>) {
    let half = crate::private::constant::<T>(0.5);
    let columns = &mut m.data.0;
    for j in 0..N {
        for i in 0..j {
            let mean = (columns[j][i] + columns[i][j]) * half;
            (columns[j][i], columns[i][j]) = (mean, mean);
        }
    }
}

/// `L` below the diagonal and `1/D` of `H + r = L D Lᵀ`, with ones on the diagonal of `L`; which pivot is not positive
/// otherwise.
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
        // Whole columns: what stands above the diagonal is read by nothing.
        for k in j + 1..N {
            for (entry, x) in l[k].iter_mut().zip(&column) {
                *entry = Compiled::neg_mul_add(*x, scaled[k], *entry);
            }
        }
        l[j] = scaled;
    }
    let storage = |x| SMatrix::from_array_storage(ArrayStorage(x));
    Ok((storage(l), SMatrix::from_array_storage(ArrayStorage([inverse]))))
}

/// Puts `−(L D Lᵀ)⁻¹ B` in the place of `B`, row by row, so that all columns go at once.
#[inline(never)]
pub fn solve<T: Real, const N: usize, const C: usize>(
    l: &SMatrix<T, N, N>,
    inverse: &SVector<T, N>,
    b: &mut SMatrix<T, N, C>,
) {
    let (l, inverse) = (&l.data.0, &inverse.data.0[0]);
    let mut rows = transposed(b).data.0;
    for j in 0..N {
        let row = rows[j];
        for i in j + 1..N {
            for (entry, x) in rows[i].iter_mut().zip(&row) {
                *entry = Compiled::neg_mul_add(*x, l[j][i], *entry);
            }
        }
    }
    for j in (0..N).rev() {
        let mut row = rows[j];
        row.iter_mut().for_each(|x| *x *= -inverse[j]);
        for i in j + 1..N {
            for (entry, x) in row.iter_mut().zip(&rows[i]) {
                *entry = Compiled::neg_mul_add(*x, l[j][i], *entry);
            }
        }
        rows[j] = row;
    }
    *b = transposed(&SMatrix::from_array_storage(ArrayStorage(rows)));
}
