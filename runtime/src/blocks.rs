//! Products of matrices of fixed sizes for loops of the runtime, without copies. nalgebra's own add columns one by one, and
//! multiply transposed matrices entry by entry.

use crate::Real;
use crate::arithmetic::dispatch::{Evaluate, dispatch};
use crate::arithmetic::{Arithmetic, Compiled};
use crate::multiplication::{part, put};
use core::array::{from_mut, from_ref};
use nalgebra::{ArrayStorage, SMatrix, SVector};

mod nearly;
mod small;

pub use nearly::NearlyIdentity;

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

    /// As many rows of four columns at a time as registers hold with room for what is added.
    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, sum: &mut SMatrix<T, R, C>) {
        if (4..=small::MOST).contains(&R) && K <= small::MOST {
            return small::add_product::<A, T, R, K>(&mut sum.data.0, &self.a.data.0, &self.b.data.0);
        }
        let (columns, a, b) = (&mut sum.data.0, rolled(&self.a.data.0), &self.b.data.0);
        if A::WIDE && R >= 8 {
            all_rows::<A, T, 8, R, K, C>(columns, a, b);
        } else if R >= 4 {
            all_rows::<A, T, 4, R, K, C>(columns, a, b);
        } else {
            all_rows::<A, T, 1, R, K, C>(columns, a, b);
        }
    }
}

/// A list whose length the compiler does not know: it would write out its loops.
#[inline(always)]
fn rolled<T>(list: &[T]) -> &[T] {
    core::hint::black_box(list)
}

/// All rows, in registers of so many: two registers at a time, and at last as many as are left, up to three. The last of these begins
/// as much earlier as it would be too long; both read before either writes.
#[inline(always)]
fn all_rows<A: Arithmetic, T: Real, const W: usize, const R: usize, const K: usize, const C: usize>(
    columns: &mut [[T; R]; C],
    a: &[[T; R]],
    b: &[[T; K]; C],
) {
    let left = if R > 3 * W { (R - W - 1) % (2 * W) + W + 1 } else { R };
    let mut from = 0;
    for _ in 0..(R - left) / (2 * W) {
        strip::<A, T, W, 2, R, K, C>(columns, a, b, from);
        from += 2 * W;
    }
    match left.div_ceil(W) {
        1 => strip::<A, T, W, 1, R, K, C>(columns, a, b, from),
        2 => strip::<A, T, W, 2, R, K, C>(columns, a, b, from),
        3 => strip::<A, T, W, 3, R, K, C>(columns, a, b, from),
        _ => {}
    }
}

/// Adds the product in `V` registers of rows, from a given row on, in all columns.
#[inline(always)]
fn strip<
    A: Arithmetic,
    T: Real,
    const W: usize,
    const V: usize,
    const R: usize,
    const K: usize,
    const C: usize,
>(
    columns: &mut [[T; R]; C],
    a: &[[T; R]],
    b: &[[T; K]; C],
    from: usize,
) {
    let (fours, rest) = columns.as_chunks_mut::<4>();
    let (factors, last) = b.as_chunks::<4>();
    for (columns, b) in fours.iter_mut().zip(factors) {
        tile::<A, T, W, V, 4, R, K>(columns, a, b, from);
    }
    match (rest, last) {
        ([x, y, z], [d, e, f]) => {
            let mut three = [*x, *y, *z];
            tile::<A, T, W, V, 3, R, K>(&mut three, a, &[*d, *e, *f], from);
            [*x, *y, *z] = three;
        }
        ([x, y], [d, e]) => {
            let mut two = [*x, *y];
            tile::<A, T, W, V, 2, R, K>(&mut two, a, &[*d, *e], from);
            [*x, *y] = two;
        }
        ([x], [d]) => tile::<A, T, W, V, 1, R, K>(from_mut(x), a, from_ref(d), from),
        _ => {}
    }
}

/// Adds the product in `V` registers of rows, from a given row on, in some columns.
#[inline(always)]
fn tile<
    A: Arithmetic,
    T: Real,
    const W: usize,
    const V: usize,
    const G: usize,
    const R: usize,
    const K: usize,
>(
    columns: &mut [[T; R]; G],
    a: &[[T; R]],
    b: &[[T; K]; G],
    from: usize,
) {
    let mut all = [[A::splat(T::zero()); V]; G];
    for (registers, column) in all.iter_mut().zip(columns.iter()) {
        for (v, register) in registers.iter_mut().enumerate() {
            *register = part::<A, T, W>(column, from + v * W);
        }
    }
    for (k, column) in a.iter().enumerate().take(K) {
        let mut rows = [A::splat(T::zero()); V];
        for (v, register) in rows.iter_mut().enumerate() {
            *register = part::<A, T, W>(column, from + v * W);
        }
        for (registers, factors) in all.iter_mut().zip(b) {
            if let Some(factor) = factors.get(k) {
                let factor = A::splat(*factor);
                for (entry, x) in registers.iter_mut().zip(&rows) {
                    *entry = A::mul_add(*x, factor, *entry);
                }
            }
        }
    }
    for (column, registers) in columns.iter_mut().zip(&all) {
        for (v, register) in registers.iter().enumerate() {
            put(register, column, from + v * W);
        }
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
    // Without a way out early a column is compared at once.
    a.data.0.iter().all(|column| column.iter().fold(true, |zero, x| zero & (*x == T::zero())))
}

/// Zeros, without nalgebra's own construction entry by entry.
#[inline]
pub fn zeros<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::from_array_storage(ArrayStorage([[T::zero(); R]; C]))
}

/// `Aᵀ`.
#[inline]
pub fn transposed<T: Real, const R: usize, const C: usize>(a: &SMatrix<T, R, C>) -> SMatrix<T, C, R> {
    let mut turned = zeros();
    transpose_into(a, &mut turned);
    turned
}

/// Puts `Aᵀ` into a matrix, in squares of four, whose rows are put together in registers.
#[inline(never)]
pub fn transpose_into<T: Real, const R: usize, const C: usize>(
    a: &SMatrix<T, R, C>,
    into: &mut SMatrix<T, C, R>,
) {
    let turned = &mut into.data.0;
    let (fours, rest) = a.data.0.as_chunks::<4>();
    for (j, columns) in fours.iter().enumerate() {
        let [a, b, c, d] = columns.each_ref().map(|column| column.as_chunks::<4>().0);
        let (rows, left) = turned.as_chunks_mut::<4>();
        for ((((a, b), c), d), rows) in a.iter().zip(b).zip(c).zip(d).zip(rows) {
            for (i, row) in rows.iter_mut().enumerate() {
                if let Some(place) = row.get_mut(4 * j..).and_then(<[T]>::first_chunk_mut::<4>) {
                    *place = [a[i], b[i], c[i], d[i]];
                }
            }
        }
        for (i, row) in (R - R % 4..).zip(left) {
            for (place, column) in row.iter_mut().skip(4 * j).zip(columns) {
                *place = column[i];
            }
        }
    }
    for (j, column) in (C - C % 4..).zip(rest) {
        for (row, x) in turned.iter_mut().zip(column.iter()) {
            if let Some(entry) = row.get_mut(j) {
                *entry = *x;
            }
        }
    }
}

/// `A B`, where most of `B` is zero.
pub fn product_with_few<T: Real, const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<T, R, K>,
    b: &SMatrix<T, K, C>,
) -> SMatrix<T, R, C> {
    let mut out = zeros::<T, R, C>();
    for (to, factors) in out.data.0.iter_mut().zip(&b.data.0) {
        for (factor, from) in factors.iter().zip(&a.data.0).filter(|(factor, _)| **factor != T::zero()) {
            for (sum, x) in to.iter_mut().zip(from) {
                *sum = Compiled::mul_add(*x, *factor, *sum);
            }
        }
    }
    out
}

/// `A += s (B + Bᵀ)`.
#[inline(never)]
pub fn add_with_transpose<T: Real, const N: usize>(sum: &mut SMatrix<T, N, N>, s: T, b: &SMatrix<T, N, N>) {
    add_multiple(sum, s, b);
    add_multiple(sum, s, &transposed(b));
}

/// `A *= s`.
#[inline]
pub fn scale<T: Real, const R: usize, const C: usize>(matrix: &mut SMatrix<T, R, C>, s: T) {
    matrix.data.0.as_flattened_mut().iter_mut().for_each(|x| *x *= s);
}

/// Puts `s A` into a matrix.
#[inline]
pub fn multiple_into<T: Real, const R: usize, const C: usize>(
    s: T,
    a: &SMatrix<T, R, C>,
    into: &mut SMatrix<T, R, C>,
) {
    for (entry, x) in into.data.0.as_flattened_mut().iter_mut().zip(a.data.0.as_flattened()) {
        *entry = *x * s;
    }
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

/// `Σ s A` of several factors and matrices.
#[inline]
pub fn combined<T: Real, const R: usize, const C: usize, const N: usize>(
    factors: &[T; N],
    matrices: [&SMatrix<T, R, C>; N],
) -> SMatrix<T, R, C> {
    let mut sum = zeros();
    for (s, matrix) in factors.iter().zip(matrices) {
        add_multiple(&mut sum, *s, matrix);
    }
    sum
}

/// Puts the mean of a matrix and its transpose into another: rounding must not grow from instant to instant.
#[inline(never)]
pub fn symmetric_into<T: Real, const N: usize>(m: &SMatrix<T, N, N>, into: &mut SMatrix<T, N, N>) {
    let half = crate::private::constant::<T>(0.5);
    transpose_into(m, into);
    for (entry, x) in into.data.0.as_flattened_mut().iter_mut().zip(m.data.0.as_flattened()) {
        *entry = (*entry + *x) * half;
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

/// Puts `−(L D Lᵀ)⁻¹ B` in the place of `B`.
pub fn solve<T: Real, const N: usize, const C: usize>(
    l: &SMatrix<T, N, N>,
    inverse: &SVector<T, N>,
    b: &mut SMatrix<T, N, C>,
) {
    *b = transposed(&solved_rows(l, inverse, &transposed(b)));
}

/// `−B (L D Lᵀ)⁻¹`.
#[inline(never)]
pub fn solved_rows<T: Real, const N: usize, const R: usize>(
    l: &SMatrix<T, N, N>,
    inverse: &SVector<T, N>,
    b: &SMatrix<T, R, N>,
) -> SMatrix<T, R, N> {
    let mut solved = zeros();
    dispatch::<1, T, _, _>(&Solve { l, inverse, b }, &mut solved);
    solved
}

/// What is solved.
struct Solve<'a, T, const N: usize, const R: usize> {
    l: &'a SMatrix<T, N, N>,
    inverse: &'a SVector<T, N>,
    b: &'a SMatrix<T, R, N>,
}

impl<T: Real, const N: usize, const R: usize> Evaluate<1, &mut SMatrix<T, R, N>> for Solve<'_, T, N, R> {
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, out: &mut SMatrix<T, R, N>) {
        let out = &mut out.data.0;
        if A::WIDE && R >= 8 {
            // The last rows begin as much earlier as they would be too long, and are solved twice.
            (0..R).step_by(8).for_each(|from| self.some::<A, 8>(out, from));
        } else if R >= 4 {
            (0..R).step_by(4).for_each(|from| self.some::<A, 4>(out, from));
        } else {
            (0..R).for_each(|from| self.some::<A, 1>(out, from));
        }
    }
}

impl<T: Real, const N: usize, const R: usize> Solve<'_, T, N, R> {
    /// Solves for one register of right-hand sides, from a given one on.
    #[inline(always)]
    fn some<A: Arithmetic, const W: usize>(&self, out: &mut [[T; R]; N], from: usize) {
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
        for j in (0..N).rev() {
            let mut own = x[j] * A::splat(-inverse[j]);
            for i in j + 1..N {
                own = A::neg_mul_add(x[i], A::splat(l[j][i]), own);
            }
            x[j] = own;
        }
        for (column, x) in out.iter_mut().zip(&x) {
            put(x, column, from);
        }
    }
}
