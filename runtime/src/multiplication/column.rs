//! Columns of matrices in registers.

use crate::Real;
use crate::arithmetic::{Arithmetic, Vector};

/// How many registers of eight numbers hold most of a column of so many, where there are such registers.
#[must_use]
pub const fn registers_of_eight(numbers: usize, wide: bool) -> usize {
    if !wide || numbers < 8 { 0 } else { numbers / 8 + (numbers % 8 > 4) as usize }
}

/// How many registers of four numbers hold the rest.
#[must_use]
pub const fn registers_of_four(numbers: usize, wide: bool) -> usize {
    numbers.saturating_sub(8 * registers_of_eight(numbers, wide)).div_ceil(4)
}

/// A column in `E` registers of eight numbers, then `F` of four. The last begins as much earlier as it would be too long.
#[derive(Clone, Copy)]
pub struct Column<A, T, const E: usize, const F: usize> {
    eights: [Vector<A, T, 8>; E],
    fours: [Vector<A, T, 4>; F],
}

/// Columns of a matrix, beginning where lines of the cache do.
#[repr(align(64))]
pub struct Columns<A, T, const E: usize, const F: usize, const K: usize> {
    eights: [[Vector<A, T, 8>; E]; K],
    fours: [[Vector<A, T, 4>; F]; K],
}

impl<A: Arithmetic, T: Real, const E: usize, const F: usize, const K: usize> Columns<A, T, E, F, K> {
    /// All zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { eights: [[A::splat(T::zero()); E]; K], fours: [[A::splat(T::zero()); F]; K] }
    }

    /// Reads a column where it is to be: a whole one would be moved once more.
    #[inline(always)]
    pub fn set(&mut self, k: usize, column: &[T]) {
        if let (Some(eights), Some(fours)) = (self.eights.get_mut(k), self.fours.get_mut(k)) {
            read(column, eights, fours);
        }
    }
}

impl<A: Arithmetic, T: Real, const E: usize, const F: usize, const K: usize> Source<A, T, E, F>
    for Columns<A, T, E, F, K>
{
    const COUNT: usize = K;

    #[inline(always)]
    fn column(&self, k: usize) -> Column<A, T, E, F> {
        match (self.eights.get(k), self.fours.get(k)) {
            (Some(eights), Some(fours)) => Column { eights: *eights, fours: *fours },
            _ => Column::zero(),
        }
    }
}

// No function of the standard library that takes closures: those are not always inlined.

impl<A: Arithmetic, T: Real, const E: usize, const F: usize> Column<A, T, E, F> {
    /// Zero in every row.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { eights: [A::splat(T::zero()); E], fours: [A::splat(T::zero()); F] }
    }

    /// The same number in every row.
    #[inline(always)]
    pub fn all(x: T) -> Self {
        Self { eights: [A::splat(x); E], fours: [A::splat(x); F] }
    }

    /// One minus this.
    #[inline(always)]
    pub fn complement(&self) -> Self {
        let mut rest = Self::all(T::one());
        rest.add_multiple::<true>(T::one(), self);
        rest
    }

    /// Row by row.
    #[inline(always)]
    pub fn multiply(&mut self, other: &Self) {
        for (x, y) in self.eights.iter_mut().zip(&other.eights) {
            *x = *x * *y;
        }
        for (x, y) in self.fours.iter_mut().zip(&other.fours) {
            *x = *x * *y;
        }
    }

    /// Adds a multiple of another, or subtracts it.
    #[inline(always)]
    pub fn add_multiple<const MINUS: bool>(&mut self, factor: T, other: &Self) {
        add_multiples::<A, T, 8, MINUS>(&mut self.eights, factor, &other.eights);
        add_multiples::<A, T, 4, MINUS>(&mut self.fours, factor, &other.fours);
    }

    /// A column of as many rows as the registers hold, or fewer.
    #[inline(always)]
    pub fn read(column: &[T]) -> Self {
        let mut all = Self::zero();
        read(column, &mut all.eights, &mut all.fours);
        all
    }

    /// Into a column of as many rows as it was read from.
    #[inline(always)]
    pub fn write(&self, column: &mut [T]) {
        for (k, register) in self.eights.iter().enumerate() {
            put(register, column, 8 * k);
        }
        for (k, register) in self.fours.iter().enumerate() {
            put(register, column, 8 * E + 4 * k);
        }
    }
}

/// Adds multiples of others, or subtracts them.
#[inline(always)]
fn add_multiples<A: Arithmetic, T: Real, const W: usize, const MINUS: bool>(
    sums: &mut [Vector<A, T, W>],
    factor: T,
    others: &[Vector<A, T, W>],
) {
    let by = A::splat(factor);
    for (sum, x) in sums.iter_mut().zip(others) {
        *sum = if MINUS { A::neg_mul_add(*x, by, *sum) } else { A::mul_add(*x, by, *sum) };
    }
}

/// Reads a column.
#[inline(always)]
fn read<A: Arithmetic, T: Real, const E: usize, const F: usize>(
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

/// So many numbers from one on, or as many earlier as there are too few.
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

/// The same for writing.
#[inline(always)]
pub fn put<A: Arithmetic, T: Real, const W: usize>(
    register: &Vector<A, T, W>,
    column: &mut [T],
    from: usize,
) {
    let rest = column.get_mut(from.min(column.len().saturating_sub(W))..).unwrap_or(&mut []);
    let numbers = register.numbers();
    if let Some(all) = rest.first_chunk_mut() {
        *all = *numbers;
    } else {
        for (place, x) in rest.iter_mut().zip(numbers) {
            *place = *x;
        }
    }
}

/// Columns that multiples are taken of.
pub trait Source<A, T, const E: usize, const F: usize> {
    /// How many there are.
    const COUNT: usize;

    /// One of them; zeros if there is none.
    fn column(&self, k: usize) -> Column<A, T, E, F>;
}

impl<A: Arithmetic, T: Real, const E: usize, const F: usize, const N: usize, const W: usize>
    Source<A, T, E, F> for [[T; N]; W]
{
    const COUNT: usize = W;

    #[inline(always)]
    fn column(&self, k: usize) -> Column<A, T, E, F> {
        match self.get(k) {
            Some(column) => Column::read(column),
            None => Column::zero(),
        }
    }
}
