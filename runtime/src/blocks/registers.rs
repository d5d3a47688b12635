//! Products of matrices in SIMD registers: several hundred instructions for each size of matrices.

use super::small;
use crate::Real;
use crate::arithmetic::dispatch::Evaluate;
use crate::arithmetic::{Arithmetic, Vector};
use crate::multiplication::{part, registers_of_eight, registers_of_four, write_entries};
use core::array::{from_mut, from_ref};
use nalgebra::SMatrix;

/// Factors `A` and `B` of a matrix product.
pub(super) struct MatrixProduct<'a, T, const R: usize, const K: usize, const C: usize> {
    pub(super) a: &'a SMatrix<T, R, K>,
    pub(super) b: &'a SMatrix<T, K, C>,
}

impl<T: Real, const R: usize, const K: usize, const C: usize> Evaluate<0, &mut SMatrix<T, R, C>>
    for MatrixProduct<'_, T, R, K, C>
{
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, sum: &mut SMatrix<T, R, C>) {
        if (4..=small::MOST).contains(&R) && K <= small::MOST {
            return small::add_product::<A, T, R, K>(&mut sum.data.0, &self.a.data.0, &self.b.data.0);
        }
        let a = hide_length(&self.a.data.0).iter().enumerate().take(K);
        add_column_products::<A, T, R, K, C>(&mut sum.data.0, a, &self.b.data.0);
    }
}

/// Factors of a matrix product that is restricted to chosen columns of the first factor.
pub(super) struct ChosenColumnsProduct<'a, T, const R: usize, const K: usize, const C: usize> {
    pub(super) places: &'a [usize],
    pub(super) a: &'a SMatrix<T, R, K>,
    pub(super) b: &'a SMatrix<T, K, C>,
}

impl<T: Real, const R: usize, const K: usize, const C: usize> Evaluate<2, &mut SMatrix<T, R, C>>
    for ChosenColumnsProduct<'_, T, R, K, C>
{
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, sum: &mut SMatrix<T, R, C>) {
        let a = self.places.iter().filter_map(|k| self.a.data.0.get(*k).map(|column| (*k, column)));
        add_column_products::<A, T, R, K, C>(&mut sum.data.0, a, &self.b.data.0);
    }
}

/// Adds a matrix product of the given columns, with their indices. It processes four columns at a time, and
/// the maximum number of rows that fit in registers together with the operands.
#[inline(always)]
fn add_column_products<'a, A: Arithmetic, T: Real, const R: usize, const K: usize, const C: usize>(
    columns: &mut [[T; R]; C],
    a: impl Iterator<Item = (usize, &'a [T; R])> + Clone,
    b: &[[T; K]; C],
) {
    if A::WIDE && R >= 8 {
        matrix_product_in_wide_registers::<A, T, R, K, C>(columns, a, b);
    } else if R >= 4 {
        matrix_product_in_registers::<A, T, 4, R, K, C>(columns, a, b);
    } else {
        matrix_product_in_registers::<A, T, 1, R, K, C>(columns, a, b);
    }
}

/// Returns a slice whose length is hidden from the compiler, so that it does not unroll loops over it.
#[inline(always)]
fn hide_length<T>(list: &[T]) -> &[T] {
    core::hint::black_box(list)
}

/// Returns the number of rows left after strips of two registers of width `W`. The last strip has more than
/// one and at most three registers, unless the matrix is smaller.
const fn remaining_row_count(rows: usize, w: usize) -> usize {
    if rows > 3 * w { (rows - w - 1) % (2 * w) + w + 1 } else { rows }
}

/// Computes all rows of a matrix product in registers of width `W`: two registers at a time, and finally the
/// remaining up to three. If fewer rows remain, the last register overlaps the previous one; all rows are
/// read before any is written.
#[inline(always)]
fn matrix_product_in_registers<
    'a,
    A: Arithmetic,
    T: Real,
    const W: usize,
    const R: usize,
    const K: usize,
    const C: usize,
>(
    columns: &mut [[T; R]; C],
    a: impl Iterator<Item = (usize, &'a [T; R])> + Clone,
    b: &[[T; K]; C],
) {
    let left = remaining_row_count(R, W);
    let mut from = 0;
    for _ in 0..(R - left) / (2 * W) {
        add_product_strip::<A, T, W, 2, 0, R, K, C>(columns, a.clone(), b, from);
        from += 2 * W;
    }
    match left.div_ceil(W) {
        1 => add_product_strip::<A, T, W, 1, 0, R, K, C>(columns, a.clone(), b, from),
        2 => add_product_strip::<A, T, W, 2, 0, R, K, C>(columns, a.clone(), b, from),
        3 => add_product_strip::<A, T, W, 3, 0, R, K, C>(columns, a.clone(), b, from),
        _ => {}
    }
}

/// Computes a matrix product as [`matrix_product_in_registers`] does, with registers of eight, and a final
/// register of four if it can hold the remaining rows. Instructions on four are half as long on processors
/// that split instructions on eight.
#[inline(always)]
fn matrix_product_in_wide_registers<
    'a,
    A: Arithmetic,
    T: Real,
    const R: usize,
    const K: usize,
    const C: usize,
>(
    columns: &mut [[T; R]; C],
    a: impl Iterator<Item = (usize, &'a [T; R])> + Clone,
    b: &[[T; K]; C],
) {
    let left = remaining_row_count(R, 8);
    let mut from = 0;
    for _ in 0..(R - left) / 16 {
        add_product_strip::<A, T, 8, 2, 0, R, K, C>(columns, a.clone(), b, from);
        from += 16;
    }
    match (registers_of_eight(left, true), registers_of_four(left, true)) {
        (1, 0) => add_product_strip::<A, T, 8, 1, 0, R, K, C>(columns, a.clone(), b, from),
        (1, _) => add_product_strip::<A, T, 8, 1, 1, R, K, C>(columns, a.clone(), b, from),
        (2, 0) => add_product_strip::<A, T, 8, 2, 0, R, K, C>(columns, a.clone(), b, from),
        (2, _) => add_product_strip::<A, T, 8, 2, 1, R, K, C>(columns, a.clone(), b, from),
        _ => add_product_strip::<A, T, 8, 3, 0, R, K, C>(columns, a.clone(), b, from),
    }
}

/// Adds the product in `V` registers of rows and `F` registers of four, from a given row on, in all columns.
#[inline(always)]
fn add_product_strip<
    'a,
    A: Arithmetic,
    T: Real,
    const W: usize,
    const V: usize,
    const F: usize,
    const R: usize,
    const K: usize,
    const C: usize,
>(
    columns: &mut [[T; R]; C],
    a: impl Iterator<Item = (usize, &'a [T; R])> + Clone,
    b: &[[T; K]; C],
    from: usize,
) {
    let (fours, rest) = columns.as_chunks_mut::<4>();
    let (factors, last) = b.as_chunks::<4>();
    for (columns, b) in fours.iter_mut().zip(factors) {
        add_product_tile::<A, T, W, V, F, 4, R, K>(columns, a.clone(), b, from);
    }
    match (rest, last) {
        ([x, y, z], [d, e, f]) => {
            let mut three = [*x, *y, *z];
            add_product_tile::<A, T, W, V, F, 3, R, K>(&mut three, a.clone(), &[*d, *e, *f], from);
            [*x, *y, *z] = three;
        }
        ([x, y], [d, e]) => {
            let mut two = [*x, *y];
            add_product_tile::<A, T, W, V, F, 2, R, K>(&mut two, a.clone(), &[*d, *e], from);
            [*x, *y] = two;
        }
        ([x], [d]) => add_product_tile::<A, T, W, V, F, 1, R, K>(from_mut(x), a.clone(), from_ref(d), from),
        _ => {}
    }
}

/// Rows of a matrix column in SIMD registers: `V` registers of width `W`, then `F` registers of width four.
#[derive(Clone, Copy)]
struct RegisterRows<A, T, const W: usize, const V: usize, const F: usize> {
    whole: [Vector<A, T, W>; V],
    fours: [Vector<A, T, 4>; F],
}

impl<A: Arithmetic, T: Real, const W: usize, const V: usize, const F: usize> RegisterRows<A, T, W, V, F> {
    #[inline(always)]
    fn zero_accumulator() -> Self {
        Self { whole: [A::splat(T::zero()); V], fours: [A::splat(T::zero()); F] }
    }

    #[inline(always)]
    fn load_rows_into_registers(&mut self, column: &[T], from: usize) {
        for (v, register) in self.whole.iter_mut().enumerate() {
            *register = part::<A, T, W>(column, from + v * W);
        }
        for (f, register) in self.fours.iter_mut().enumerate() {
            *register = part::<A, T, 4>(column, from + V * W + 4 * f);
        }
    }

    #[inline(always)]
    fn write_registers_to_column(&self, column: &mut [T], from: usize) {
        for (v, register) in self.whole.iter().enumerate() {
            write_entries(register, column, from + v * W);
        }
        for (f, register) in self.fours.iter().enumerate() {
            write_entries(register, column, from + V * W + 4 * f);
        }
    }

    #[inline(always)]
    fn add_multiple(&mut self, rows: &Self, factor: T) {
        let wide = A::splat(factor);
        for (entry, x) in self.whole.iter_mut().zip(&rows.whole) {
            *entry = A::mul_add(*x, wide, *entry);
        }
        let narrow = A::splat(factor);
        for (entry, x) in self.fours.iter_mut().zip(&rows.fours) {
            *entry = A::mul_add(*x, narrow, *entry);
        }
    }
}

/// Adds the product in several registers of rows, from a given row on, in several columns.
#[inline(always)]
fn add_product_tile<
    'a,
    A: Arithmetic,
    T: Real,
    const W: usize,
    const V: usize,
    const F: usize,
    const G: usize,
    const R: usize,
    const K: usize,
>(
    columns: &mut [[T; R]; G],
    a: impl Iterator<Item = (usize, &'a [T; R])> + Clone,
    b: &[[T; K]; G],
    from: usize,
) {
    let mut all = [RegisterRows::<A, T, W, V, F>::zero_accumulator(); G];
    for (rows, column) in all.iter_mut().zip(columns.iter()) {
        rows.load_rows_into_registers(column, from);
    }
    for (k, column) in a {
        let mut rows = RegisterRows::zero_accumulator();
        rows.load_rows_into_registers(column, from);
        for (sums, factors) in all.iter_mut().zip(b) {
            if let Some(factor) = factors.get(k) {
                sums.add_multiple(&rows, *factor);
            }
        }
    }
    for (column, rows) in columns.iter_mut().zip(&all) {
        rows.write_registers_to_column(column, from);
    }
}
