//! Numeric constants and matrix blocks for any scalar type. Other functions for generated code are in
//! `arithmetic` and `lie`.

use crate::Real;
use nalgebra::SMatrix;

/// Returns the number of type `T` nearest to `x`.
#[inline(always)]
pub fn constant<T: Real>(x: f64) -> T {
    nalgebra::convert(x)
}

/// Converts a scalar to `f64` for error messages; NaN if the conversion is impossible.
pub(crate) fn to_f64<T: Real>(x: T) -> f64 {
    nalgebra::try_convert(x).unwrap_or(f64::NAN)
}

/// Returns the distance from 1 to the next larger number of type `T`.
pub(crate) fn epsilon<T: Real>() -> T {
    T::default_epsilon()
}

/// Returns `x` if it is positive, otherwise zero, always with the sign plus: the sign of the maximum of two
/// zeros depends on the target.
#[inline(always)]
pub(crate) fn positive_part<T: Real>(x: T) -> T {
    x.max(T::zero()) + T::zero()
}

/// Writes a block to the diagonal of a matrix, with its first entry at index `first` in both directions.
pub fn put_block<T: Real, const N: usize, const K: usize>(
    matrix: &mut SMatrix<T, N, N>,
    first: usize,
    block: &[[T; K]; K],
) {
    for (j, column) in block.iter().enumerate() {
        for (i, entry) in column.iter().enumerate() {
            if let Some(slot) = matrix.get_mut((first + i, first + j)) {
                *slot = *entry;
            }
        }
    }
}

/// Writes rows to a larger matrix, from row `first` on.
#[inline(always)]
pub fn put_rows<T: Real, const ROWS: usize, const R: usize, const C: usize>(
    into: &mut SMatrix<T, ROWS, C>,
    first: usize,
    rows: &SMatrix<T, R, C>,
) {
    for (column, from) in into.data.0.iter_mut().zip(&rows.data.0) {
        for (entry, value) in column.iter_mut().skip(first).zip(from) {
            *entry = *value;
        }
    }
}

/// Implements `Debug` of an error type by the text of `Display`, because `main` prints a returned error with
/// `Debug`.
#[doc(hidden)]
#[macro_export]
macro_rules! debug_as_display {
    ($error:ty) => {
        impl ::core::fmt::Debug for $error {
            fn fmt(&self, f: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                ::core::fmt::Display::fmt(self, f)
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_convert_to_and_from_f64() {
        assert_eq!(constant::<f32>(0.1), 0.1_f32);
        assert_eq!(to_f64(0.5_f32), 0.5);
    }
}
