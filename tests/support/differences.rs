//! Derivatives of functions by central differences, for tests.

use linkwork::nalgebra::{SMatrix, SVector};

/// Returns the derivative of `f` at zero by central differences of eighth order with step `h`. The function
/// is evaluated up to `4 h` from zero.
pub fn derivative_at_zero<const R: usize, const C: usize>(
    h: f64,
    f: impl Fn(f64) -> SMatrix<f64, R, C>,
) -> SMatrix<f64, R, C> {
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let terms = weights.iter().zip(1..).map(|(w, k)| (f(k as f64 * h) - f(-(k as f64) * h)) * *w);
    terms.fold(SMatrix::zeros(), |sum, term| sum + term) / h
}

/// Returns the derivatives of a matrix function along each entry of its argument, with a step for each entry.
pub fn derivatives_along_entries<const N: usize, const R: usize, const C: usize>(
    steps: [f64; N],
    f: impl Fn(SVector<f64, N>) -> SMatrix<f64, R, C>,
) -> [SMatrix<f64, R, C>; N] {
    std::array::from_fn(|k| {
        derivative_at_zero(steps[k], |s| f(SVector::from_fn(|i, _| if i == k { s } else { 0.0 })))
    })
}

/// Returns the derivatives of a vector function along each entry of its argument as columns, with a step for
/// each entry.
pub fn derivative_columns<const R: usize, const N: usize>(
    steps: [f64; N],
    f: impl Fn(SVector<f64, N>) -> SVector<f64, R>,
) -> SMatrix<f64, R, N> {
    let columns = derivatives_along_entries(steps, f);
    SMatrix::from_fn(|i, j| columns[j][i])
}
