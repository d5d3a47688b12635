//! Columns of a matrix that are held in SIMD registers.

use crate::Real;
use crate::arithmetic::{Arithmetic, Vector};

/// Returns the number of registers of eight numbers for a column of length `numbers`; zero if the processor
/// has no such registers.
#[must_use]
pub const fn registers_of_eight(numbers: usize, wide: bool) -> usize {
    if !wide || numbers < 8 { 0 } else { numbers / 8 + (numbers % 8 > 4) as usize }
}

/// Returns the number of registers of four numbers for the rest of a column that registers of eight do not
/// hold.
#[must_use]
pub const fn registers_of_four(numbers: usize, wide: bool) -> usize {
    numbers.saturating_sub(8 * registers_of_eight(numbers, wide)).div_ceil(4)
}

/// Column of a matrix in `E` registers of eight numbers, followed by `F` registers of four. The last register
/// overlaps the previous one if fewer numbers remain.
#[derive(Clone, Copy)]
pub struct Column<A, T, const E: usize, const F: usize> {
    eights: [Vector<A, T, 8>; E],
    fours: [Vector<A, T, 4>; F],
}

/// Columns of a matrix, aligned to cache lines.
#[repr(align(64))]
pub struct Columns<A, T, const E: usize, const F: usize, const K: usize> {
    eights: [[Vector<A, T, 8>; E]; K],
    fours: [[Vector<A, T, 4>; F]; K],
}

impl<A: Arithmetic, T: Real, const E: usize, const F: usize, const K: usize> Columns<A, T, E, F, K> {
    /// Returns columns whose entries are all zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { eights: [[A::splat(T::zero()); E]; K], fours: [[A::splat(T::zero()); F]; K] }
    }

    /// Reads a column directly into its position, which avoids a copy of the whole column.
    #[inline(always)]
    pub fn set(&mut self, k: usize, column: &[T]) {
        if let (Some(eights), Some(fours)) = (self.eights.get_mut(k), self.fours.get_mut(k)) {
            read_column(column, eights, fours);
        }
    }
}

impl<A: Arithmetic, T: Real, const E: usize, const F: usize, const K: usize> Source<A, T, E, F>
    for Columns<A, T, E, F, K>
{
    const COUNT: usize = K;

    #[inline(always)]
    fn load_column(&self, k: usize) -> Column<A, T, E, F> {
        match (self.eights.get(k), self.fours.get(k)) {
            (Some(eights), Some(fours)) => Column { eights: *eights, fours: *fours },
            _ => Column::zero(),
        }
    }
}

// No functions of the standard library that take closures: they are not always inlined.

impl<A: Arithmetic, T: Real, const E: usize, const F: usize> Column<A, T, E, F> {
    /// Returns a column whose entries are all zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { eights: [A::splat(T::zero()); E], fours: [A::splat(T::zero()); F] }
    }

    /// Returns a column with the same number in every row.
    #[inline(always)]
    pub fn all(x: T) -> Self {
        Self { eights: [A::splat(x); E], fours: [A::splat(x); F] }
    }

    /// Returns the column with the entries `1 − x`, for each entry `x` of this column.
    #[inline(always)]
    pub fn one_minus_entries(&self) -> Self {
        let mut rest = Self::all(T::one());
        rest.add_multiple::<true>(T::one(), self);
        rest
    }

    /// Multiplies the column elementwise by another column.
    #[inline(always)]
    pub fn multiply(&mut self, other: &Self) {
        for (x, y) in self.eights.iter_mut().zip(&other.eights) {
            *x = *x * *y;
        }
        for (x, y) in self.fours.iter_mut().zip(&other.fours) {
            *x = *x * *y;
        }
    }

    /// Adds a multiple of another column to this one, or subtracts it.
    #[inline(always)]
    pub fn add_multiple<const MINUS: bool>(&mut self, factor: T, other: &Self) {
        add_multiple_of_registers::<A, T, 8, MINUS>(&mut self.eights, factor, &other.eights);
        add_multiple_of_registers::<A, T, 4, MINUS>(&mut self.fours, factor, &other.fours);
    }

    /// Reads a column of at most as many rows as the registers hold.
    #[inline(always)]
    pub fn read(column: &[T]) -> Self {
        let mut all = Self::zero();
        read_column(column, &mut all.eights, &mut all.fours);
        all
    }

    /// Writes the column to memory, with the number of rows that were read.
    #[inline(always)]
    pub fn write(&self, column: &mut [T]) {
        for (k, register) in self.eights.iter().enumerate() {
            write_entries(register, column, 8 * k);
        }
        for (k, register) in self.fours.iter().enumerate() {
            write_entries(register, column, 8 * E + 4 * k);
        }
    }
}

/// Adds multiples of other columns to columns, or subtracts them.
#[inline(always)]
fn add_multiple_of_registers<A: Arithmetic, T: Real, const W: usize, const MINUS: bool>(
    sums: &mut [Vector<A, T, W>],
    factor: T,
    others: &[Vector<A, T, W>],
) {
    let by = A::splat(factor);
    for (sum, x) in sums.iter_mut().zip(others) {
        *sum = if MINUS { A::neg_mul_add(*x, by, *sum) } else { A::mul_add(*x, by, *sum) };
    }
}

/// Loads a column from memory into registers of eight numbers and of four.
#[inline(always)]
fn read_column<A: Arithmetic, T: Real, const E: usize, const F: usize>(
    column: &[T],
    eights: &mut [Vector<A, T, 8>; E],
    fours: &mut [Vector<A, T, 4>; F],
) {
    for (k, register) in eights.iter_mut().enumerate() {
        *register = part(column, 8 * k);
    }
    for (k, register) in fours.iter_mut().enumerate() {
        *register = part(column, 8 * E + 4 * k);
    }
}

/// Reads `W` numbers of a column from index `from` on, or its last `W` numbers if fewer remain.
#[inline(always)]
pub fn part<A: Arithmetic, T: Real, const W: usize>(column: &[T], from: usize) -> Vector<A, T, W> {
    let rest = column.get(from.min(column.len().saturating_sub(W))..).unwrap_or(&[]);
    let mut numbers = [T::zero(); W];
    if let Some(all) = rest.first_chunk() {
        numbers = *all;
    } else {
        for (number, x) in numbers.iter_mut().zip(rest) {
            *number = *x;
        }
    }
    A::lanes(numbers)
}

/// Writes `W` numbers to a column from index `from` on, or to its last `W` entries if fewer remain.
#[inline(always)]
pub fn write_entries<A: Arithmetic, T: Real, const W: usize>(
    register: &Vector<A, T, W>,
    column: &mut [T],
    from: usize,
) {
    let rest = column.get_mut(from.min(column.len().saturating_sub(W))..).unwrap_or(&mut []);
    let numbers = register.lane_numbers();
    if let Some(all) = rest.first_chunk_mut() {
        *all = *numbers;
    } else {
        for (place, x) in rest.iter_mut().zip(numbers) {
            *place = *x;
        }
    }
}

/// List of columns in registers, of which multiples are added to the columns of another matrix.
pub trait Source<A, T, const E: usize, const F: usize> {
    /// Number of columns in the list.
    const COUNT: usize;

    /// Returns column `k` of the list, in registers; zeros if `k` is out of range.
    fn load_column(&self, k: usize) -> Column<A, T, E, F>;
}

impl<A: Arithmetic, T: Real, const E: usize, const F: usize, const N: usize, const W: usize>
    Source<A, T, E, F> for [[T; N]; W]
{
    const COUNT: usize = W;

    #[inline(always)]
    fn load_column(&self, k: usize) -> Column<A, T, E, F> {
        match self.get(k) {
            Some(column) => Column::read(column),
            None => Column::zero(),
        }
    }
}
