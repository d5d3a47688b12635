//! Products with a small matrix that is stored entirely in registers.

use crate::Real;
use crate::arithmetic::{Arithmetic, Vector};
use crate::multiplication::{part, write_entries};

/// Maximum number of rows and columns of a small matrix: it occupies half of 32 registers of four numbers.
pub(super) const MOST: usize = 8;

/// Adds a matrix product, `C += A B`, column by column of `B`, with `A` in registers.
#[inline(always)]
pub(super) fn add_product<A: Arithmetic, T: Real, const R: usize, const K: usize>(
    sums: &mut [[T; R]],
    a: &[[T; R]; K],
    b: &[[T; K]],
) {
    if R > 4 {
        add_product_in_registers::<A, T, 2, R, K>(sums, a, b)
    } else {
        add_product_in_registers::<A, T, 1, R, K>(sums, a, b)
    }
}

/// Computes columns of a matrix product with their rows in `V` registers of four. If fewer rows remain, the
/// last register overlaps the previous one; all rows are read before any is written.
#[inline(always)]
fn add_product_in_registers<A: Arithmetic, T: Real, const V: usize, const R: usize, const K: usize>(
    sums: &mut [[T; R]],
    a: &[[T; R]; K],
    b: &[[T; K]],
) {
    let mut rows = [[A::splat(T::zero()); V]; K];
    for (registers, column) in rows.iter_mut().zip(a) {
        *registers = read_column::<A, T, V>(column);
    }
    for (column, factors) in sums.iter_mut().zip(b) {
        let mut entries = read_column::<A, T, V>(column);
        for (registers, factor) in rows.iter().zip(factors) {
            let factor = A::splat(*factor);
            for (entry, x) in entries.iter_mut().zip(registers) {
                *entry = A::mul_add(*x, factor, *entry);
            }
        }
        for (v, entry) in entries.iter().enumerate() {
            write_entries(entry, column, 4 * v);
        }
    }
}

/// Reads a matrix column into registers of four.
#[inline(always)]
fn read_column<A: Arithmetic, T: Real, const V: usize>(column: &[T]) -> [Vector<A, T, 4>; V] {
    let mut registers = [A::splat(T::zero()); V];
    for (v, register) in registers.iter_mut().enumerate() {
        *register = part::<A, T, 4>(column, 4 * v);
    }
    registers
}
