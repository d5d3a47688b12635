//! Conversion of plain arrays to the arguments of generated functions, and of their results to plain arrays.

use crate::Failure;
use linkwork::constraint::Linearization;
use linkwork::discrete::Transition;
use linkwork::nalgebra::{IsometryMatrix3, SMatrix};
use linkwork::{Lanes, OutputJacobians, Real};
use std::fmt::Display;

/// Scalar type of the library's arrays: `f64` or `f32`.
pub trait Number: Real + Send + Sync + Display + Default {
    /// NaN value of the scalar type.
    const NAN: Self;
}

impl Number for f64 {
    const NAN: f64 = f64::NAN;
}

impl Number for f32 {
    const NAN: f32 = f32::NAN;
}

/// Entry of a matrix: a scalar of one state, or SIMD lanes over several states. Arrays contain the states one
/// after the other.
pub trait Entry<N>: Copy {
    /// Reads entry `at` of every state, where a state has `length` entries. Missing entries are zero.
    fn read(numbers: &[N], at: usize, length: usize) -> Self;
    /// Writes entry `at` of every state, where a state has `length` entries.
    fn write(self, numbers: &mut [N], at: usize, length: usize);
    /// Reads all entries of every state from an array.
    fn read_all<const LENGTH: usize>(numbers: &[N]) -> [Self; LENGTH];
    /// Writes all entries of every state to an array.
    fn write_all(all: &[Self], numbers: &mut [N]);
}

macro_rules! entry {
    ($($number:ty),*) => {$(
        impl Entry<$number> for $number {
            #[inline(always)]
            fn read(numbers: &[$number], at: usize, _length: usize) -> Self {
                numbers.get(at).copied().unwrap_or_default()
            }

            #[inline(always)]
            fn write(self, numbers: &mut [$number], at: usize, _length: usize) {
                if let Some(place) = numbers.get_mut(at) {
                    *place = self;
                }
            }

            #[inline(always)]
            fn read_all<const LENGTH: usize>(numbers: &[$number]) -> [Self; LENGTH] {
                match numbers.first_chunk() {
                    Some(all) => *all,
                    None => std::array::from_fn(|at| Self::read(numbers, at, LENGTH)),
                }
            }

            #[inline(always)]
            fn write_all(all: &[Self], numbers: &mut [$number]) {
                numbers.iter_mut().zip(all).for_each(|(place, number)| *place = *number);
            }
        }

        impl<const L: usize> Entry<$number> for Lanes<$number, L> {
            #[inline(always)]
            fn read(numbers: &[$number], at: usize, length: usize) -> Self {
                Lanes::from_fn(|k| numbers.get(k * length + at).copied().unwrap_or_default())
            }

            #[inline(always)]
            fn write(self, numbers: &mut [$number], at: usize, length: usize) {
                for (k, number) in self.0.into_iter().enumerate() {
                    if let Some(place) = numbers.get_mut(k * length + at) {
                        *place = number;
                    }
                }
            }

            #[inline(always)]
            fn read_all<const LENGTH: usize>(numbers: &[$number]) -> [Self; LENGTH] {
                let mut all = [Lanes([0.0; L]); LENGTH];
                for (k, state) in numbers.chunks_exact(LENGTH.max(1)).take(L).enumerate() {
                    all.iter_mut().zip(state).for_each(|(lanes, number)| lanes.0[k] = *number);
                }
                all
            }

            // One state after the other: sequential writes take a fraction of the time of strided writes.
            #[inline(always)]
            fn write_all(all: &[Self], numbers: &mut [$number]) {
                for (k, state) in numbers.chunks_exact_mut(all.len().max(1)).take(L).enumerate() {
                    state.iter_mut().zip(all).for_each(|(place, lanes)| *place = lanes.0[k]);
                }
            }
        }
    )*};
}

entry!(f64, f32);

/// Argument of a generated function that is read from an array.
pub trait Argument<N> {
    /// Reads an argument of a generated function from the numbers of an array.
    fn take(numbers: &[N]) -> Self;
}

macro_rules! scalars {
    ($($number:ty),*) => {$(
        impl Argument<$number> for $number {
            fn take(numbers: &[$number]) -> Self {
                Entry::read(numbers, 0, 1)
            }
        }

        impl<const L: usize> Argument<$number> for Lanes<$number, L> {
            fn take(numbers: &[$number]) -> Self {
                Entry::read(numbers, 0, 1)
            }
        }

        /// Small integer, such as the sign that denotes an assembly mode, read as the integer part of a
        /// number.
        impl Argument<$number> for i8 {
            fn take(numbers: &[$number]) -> Self {
                numbers.first().map_or(0, |number| *number as i8)
            }
        }

        impl Results<$number> for i8 {
            fn write_to_sink(self, to: &mut Sink<'_, '_, $number>) -> Result<(), Failure> {
                <$number>::from(self).write_to_sink(to)
            }
        }

        impl Results<$number> for $number {
            fn write_to_sink(self, to: &mut Sink<'_, '_, $number>) -> Result<(), Failure> {
                self.write(to.next(), 0, 1);
                Ok(())
            }
        }

        impl<const L: usize> Results<$number> for Lanes<$number, L> {
            fn write_to_sink(self, to: &mut Sink<'_, '_, $number>) -> Result<(), Failure> {
                self.write(to.next(), 0, 1);
                Ok(())
            }
        }
    )*};
}

scalars!(f64, f32);

impl<N, E: Entry<N>, const R: usize, const C: usize> Argument<N> for SMatrix<E, R, C> {
    #[inline(always)]
    fn take(numbers: &[N]) -> Self {
        let read_column = |column: usize| match C {
            1 => E::read_all::<R>(numbers),
            _ => std::array::from_fn(|row| E::read(numbers, column * R + row, R * C)),
        };
        SMatrix::from_array_storage(linkwork::nalgebra::ArrayStorage(std::array::from_fn(read_column)))
    }
}

/// Indices of the nonzero entries of an array that marks a selection.
#[derive(Clone, Debug)]
pub struct Marked(Vec<usize>);

impl std::ops::Deref for Marked {
    type Target = [usize];

    fn deref(&self) -> &[usize] {
        &self.0
    }
}

impl<N: Number> Argument<N> for Marked {
    fn take(numbers: &[N]) -> Self {
        Marked((0..numbers.len()).filter(|k| numbers[*k] != N::zero()).collect())
    }
}

/// Argument arrays of a function, one per argument.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a, N>(pub &'a [&'a [N]]);

/// Reads the argument with an index; a missing array counts as empty.
#[inline(always)]
pub fn given<N, A: Argument<N>>(all: Given<'_, N>, k: usize) -> A {
    A::take(all.0.get(k).copied().unwrap_or_default())
}

impl<N: Number> Given<'_, N> {
    /// Reads argument `k`, which marks a selection by nonzero entries, as their indices.
    pub fn marked(self, k: usize) -> Marked {
        given(self, k)
    }
}

/// Arrays for the results of a function, which are filled in order.
#[derive(Debug)]
pub struct Sink<'a, 'b, N> {
    arrays: &'a mut [&'b mut [N]],
    next: usize,
}

impl<'a, 'b, N> Sink<'a, 'b, N> {
    /// Creates a writer that starts at the first result array.
    pub fn new(arrays: &'a mut [&'b mut [N]]) -> Self {
        Sink { arrays, next: 0 }
    }

    fn next(&mut self) -> &mut [N] {
        let k = self.next;
        self.next += 1;
        self.arrays.get_mut(k).map_or(&mut [], |array| &mut **array)
    }
}

/// Result of a generated function that is written to arrays: matrices in column-major order, placements as 4
/// × 4 matrices.
pub trait Results<N> {
    /// Writes the result of a generated function to arrays.
    ///
    /// # Errors
    ///
    /// The error of the function, if the result is one.
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure>;
}

impl<N, E: Entry<N>, const R: usize, const C: usize> Results<N> for SMatrix<E, R, C> {
    #[inline(always)]
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        E::write_all(self.data.0.as_flattened(), to.next());
        Ok(())
    }
}

impl<N: Number> Results<N> for IsometryMatrix3<N> {
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        self.to_homogeneous().copy_entries_to_array(to.next(), 0);
        Ok(())
    }
}

impl<N: Number, const F: usize> Results<N> for [IsometryMatrix3<N>; F] {
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        let array = to.next();
        for (k, placement) in self.into_iter().enumerate() {
            placement.to_homogeneous().copy_entries_to_array(array, 16 * k);
        }
        Ok(())
    }
}

trait EntrySource<N> {
    fn copy_entries_to_array(&self, array: &mut [N], first: usize);
}

impl<N: Number> EntrySource<N> for SMatrix<N, 4, 4> {
    fn copy_entries_to_array(&self, array: &mut [N], first: usize) {
        for (place, entry) in array.iter_mut().skip(first).zip(self.iter()) {
            *place = *entry;
        }
    }
}

macro_rules! tuples {
    ($(($($part:ident $k:tt),*))*) => {$(
        impl<N, $($part: Results<N>),*> Results<N> for ($($part),*) {
            #[inline(always)]
            fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
                $(self.$k.write_to_sink(to)?;)*
                Ok(())
            }
        }
    )*};
}

tuples! {
    (A 0, B 1)
    (A 0, B 1, C 2)
    (A 0, B 1, C 2, D 3)
    (A 0, B 1, C 2, D 3, E 4)
    (A 0, B 1, C 2, D 3, E 4, F 5)
}

impl<N, A: Results<N>, E: Display> Results<N> for Result<A, E> {
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        self.map_err(Failure::new)?.write_to_sink(to)
    }
}

impl<N, A: Results<N>> Results<N> for Option<A> {
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        self.ok_or_else(|| Failure::new("there is no frame with this number"))?.write_to_sink(to)
    }
}

impl<N, E: Entry<N>, const R: usize, const V: usize, const U: usize> Results<N>
    for OutputJacobians<E, R, V, U>
{
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        self.by_q.write_to_sink(to)?;
        self.by_v.write_to_sink(to)?;
        self.by_a.write_to_sink(to)?;
        self.by_u.write_to_sink(to)
    }
}

impl<N: Number, const X: usize, const U: usize, const P: usize, const S: usize> Results<N>
    for Linearization<N, X, U, P, S>
where
    N: Entry<N>,
{
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        self.a.write_to_sink(to)?;
        self.b.write_to_sink(to)?;
        for indices in [&self.coordinates[..], &self.speeds[..]] {
            for (place, index) in to.next().iter_mut().zip(indices) {
                *place = linkwork::nalgebra::convert(*index as f64);
            }
        }
        Ok(())
    }
}

impl<N: Number + Entry<N>, const NQ: usize, const NV: usize, const NU: usize> Results<N>
    for Transition<N, NQ, NV, NU>
{
    fn write_to_sink(self, to: &mut Sink<'_, '_, N>) -> Result<(), Failure> {
        self.q.write_to_sink(to)?;
        self.v.write_to_sink(to)?;
        self.q_by_q.write_to_sink(to)?;
        self.q_by_v.write_to_sink(to)?;
        self.q_by_u.write_to_sink(to)?;
        self.v_by_q.write_to_sink(to)?;
        self.v_by_v.write_to_sink(to)?;
        self.v_by_u.write_to_sink(to)
    }
}
