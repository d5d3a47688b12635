//! Products with matrices that are nearly the identity: derivatives of displaced configurations with few ball
//! and free joints.

use super::zeros;
use crate::Real;
use crate::arithmetic::dispatch::{Evaluate, dispatch};
use crate::arithmetic::{Arithmetic, Compiled, Vector};
use crate::multiplication::part;
use nalgebra::SMatrix;

/// Matrix `D` that equals the identity outside one contiguous range of rows and columns.
pub struct NearlyIdentity<'a, T, const N: usize> {
    matrix: &'a SMatrix<T, N, N>,
    first: usize,
    end: usize,
}

impl<'a, T: Real, const N: usize> NearlyIdentity<'a, T, N> {
    /// Finds the range of columns in which a matrix differs from the identity.
    pub fn new(matrix: &'a SMatrix<T, N, N>) -> Self {
        let (mut first, mut end) = (N, 0);
        for (j, column) in matrix.data.0.iter().enumerate() {
            // Comparing without early exit lets a column be compared at once.
            let others = column.iter().fold(0, |count, x| count + u64::from(*x != T::zero()));
            let (above, rest) = column.split_at(j);
            let Some((diagonal, below)) = rest.split_first() else { continue };
            if (others == 1) & (*diagonal == T::one()) {
                continue;
            }
            let is_nonzero = |x: &T| *x != T::zero();
            (first, end) = (first.min(j), end.max(j + 1));
            first = first.min(above.iter().position(is_nonzero).unwrap_or(j));
            end = end.max(below.iter().rposition(is_nonzero).map_or(0, |i| j + 2 + i));
        }
        Self { matrix, first, end }
    }

    /// Returns the matrix with a known range in which it differs from the identity.
    pub fn with_range(matrix: &'a SMatrix<T, N, N>, (first, end): (usize, usize)) -> Self {
        Self { matrix, first, end }
    }

    /// Returns the half-open range of columns that differ from the identity.
    pub fn others(&self) -> (usize, usize) {
        (self.first, self.end)
    }

    /// Returns the transpose `Dᵀ` of this matrix. Its columns that differ from the identity are written to
    /// `into`.
    pub fn transposed<'b>(&self, into: &'b mut SMatrix<T, N, N>) -> NearlyIdentity<'b, T, N> {
        let some = self.first..self.end;
        let rows = self.matrix.data.0.get(some.clone()).unwrap_or(&[]);
        for (i, column) in into.data.0.iter_mut().enumerate().skip(self.first).take(some.len()) {
            for (entry, row) in column.iter_mut().skip(self.first).zip(rows) {
                *entry = row.get(i).copied().unwrap_or(T::zero());
            }
        }
        NearlyIdentity { matrix: into, first: self.first, end: self.end }
    }

    /// Replaces a matrix `A` by the product `A D` with this matrix `D`.
    pub fn right_multiply<const R: usize>(&self, a: &mut SMatrix<T, R, N>) {
        if self.end - self.first.min(self.end) > 8 {
            self.right_multiply_with_storage::<R, N>(a)
        } else {
            self.right_multiply_with_storage::<R, 8>(a)
        }
    }

    /// Replaces a matrix `A` by the product `A D`, with storage for `C` columns of `D` that differ from the
    /// identity.
    fn right_multiply_with_storage<const R: usize, const C: usize>(&self, a: &mut SMatrix<T, R, N>) {
        let mut sums = zeros::<T, R, C>();
        let some = self.first..self.end;
        let from = a.data.0.get(some.clone()).unwrap_or(&[]);
        let factors = self.matrix.data.0.get(some.clone()).unwrap_or(&[]);
        for (sum, factors) in sums.data.0.iter_mut().zip(factors) {
            for (from, factor) in from.iter().zip(factors.iter().skip(self.first)) {
                for (sum, x) in sum.iter_mut().zip(from) {
                    *sum = Compiled::mul_add(*x, *factor, *sum);
                }
            }
        }
        for (to, sum) in a.data.0.iter_mut().skip(self.first).zip(sums.data.0.iter().take(some.len())) {
            *to = *sum;
        }
    }

    /// Replaces a matrix `A` by the product `D A` with this matrix `D`.
    pub fn left_multiply<const C: usize>(&self, a: &mut SMatrix<T, N, C>) {
        if self.first < self.end {
            dispatch::<0, T, _, _>(self, a);
        }
    }

    /// Writes the product `s D A` with this matrix `D` to another matrix.
    pub fn write_scaled_left_product<const C: usize>(
        &self,
        s: T,
        a: &SMatrix<T, N, C>,
        into: &mut SMatrix<T, N, C>,
    ) {
        let few = self.end - self.first.min(self.end) <= 8;
        let (start, is_other) = self.eight_rows_containing_range();
        for (column, from) in into.data.0.iter_mut().zip(&a.data.0) {
            column.iter_mut().zip(from).for_each(|(entry, x)| *entry = *x * s);
            if few && self.first < self.end {
                self.left_multiply_column::<Compiled>(column, start, is_other);
            }
        }
        if !few {
            self.left_multiply_many_rows::<Compiled, C>(into);
        }
    }

    /// Returns the first of eight rows that contain the range of this matrix, and which of the eight rows
    /// belong to it. All other rows are zero in these columns.
    #[inline(always)]
    fn eight_rows_containing_range(&self) -> (usize, [bool; 8]) {
        let start = self.first.min(N - N.min(8));
        (start, core::array::from_fn(|k| (self.first..self.end).contains(&(start + k))))
    }

    /// Replaces one column `x` by `D x` with this matrix `D`, as a step of
    /// [`left_multiply`](Self::left_multiply).
    #[inline(always)]
    fn left_multiply_column<A: Arithmetic>(&self, column: &mut [T; N], start: usize, is_other: [bool; 8]) {
        let sum = self.eight_rows_of_product::<A>(column, start);
        if let Some(places) = column.get_mut(start..).and_then(<[T]>::first_chunk_mut::<8>) {
            // Eight entries at once, each either the sum or its previous value.
            let given = *places;
            let chosen = given.iter().zip(sum.lane_numbers()).zip(is_other);
            places.iter_mut().zip(chosen).for_each(|(place, ((given, sum), is_other))| {
                *place = if is_other { *sum } else { *given };
            });
            return;
        }
        let places = column.get_mut(start..).unwrap_or(&mut []);
        for ((place, sum), is_other) in places.iter_mut().zip(sum.lane_numbers()).zip(is_other) {
            if is_other {
                *place = *sum;
            }
        }
    }

    /// Returns eight rows, from `start` on, of the product of this matrix with a column.
    #[inline(always)]
    fn eight_rows_of_product<A: Arithmetic>(&self, column: &[T], start: usize) -> Vector<A, T, 8> {
        let mut sum = Vector::<A, T, 8>::splat(T::zero());
        let some = self.first..self.end;
        let (factors, own) = (column.get(some.clone()), self.matrix.data.0.get(some));
        for (factor, own) in factors.unwrap_or(&[]).iter().zip(own.unwrap_or(&[])) {
            sum = A::mul_add(part(own, start), A::splat(*factor), sum);
        }
        sum
    }

    /// Replaces `A` by the product `D A` for a matrix `D` that differs from the identity in more than eight
    /// rows.
    #[inline(always)]
    fn left_multiply_many_rows<A: Arithmetic, const C: usize>(&self, a: &mut SMatrix<T, N, C>) {
        let length = N.min(8);
        for column in &mut a.data.0 {
            let given = *column;
            for from in (self.first..self.end).step_by(8) {
                let start = from.min(N - length);
                let sum = self.eight_rows_of_product::<A>(&given, start);
                let kept = self.end.min(start + length);
                let places = column.get_mut(from..kept).unwrap_or(&mut []);
                for (place, sum) in places.iter_mut().zip(sum.lane_numbers().iter().skip(from - start)) {
                    *place = *sum;
                }
            }
        }
    }
}

impl<T: Real, const N: usize, const C: usize> Evaluate<0, &mut SMatrix<T, N, C>>
    for NearlyIdentity<'_, T, N>
{
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, a: &mut SMatrix<T, N, C>) {
        if self.end - self.first.min(self.end) > 8 {
            return self.left_multiply_many_rows::<A, C>(a);
        }
        let (start, is_other) = self.eight_rows_containing_range();
        for column in &mut a.data.0 {
            self.left_multiply_column::<A>(column, start, is_other);
        }
    }
}
