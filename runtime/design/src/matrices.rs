//! Matrix equations and functions for dense matrices of any size: eigenvalues, exponential and logarithm,
//! Sylvester, Lyapunov and Riccati equations. All of them use orthogonal transformations: Hessenberg and
//! Schur forms, and QR decompositions with pivoting.

use crate::Error;
use nalgebra::{Complex, DMatrix};

mod balance;
mod eigenvalues;
mod exponential;
mod logarithm;
mod lyapunov;
mod rank;
mod riccati;
mod schur;

pub(crate) use balance::{balance_matrix, balance_system};
pub use eigenvalues::eigenvalues;
pub use exponential::exponential;
pub use logarithm::logarithm;
pub use lyapunov::{discrete_lyapunov, discrete_sylvester, lyapunov, sylvester};
pub use rank::rank;
pub(crate) use rank::{RowCompression, smallest_singular_value};
pub(crate) use riccati::is_uncontrollable_mode;
pub use riccati::{Cost, Riccati, discrete_riccati, riccati};
pub(crate) use schur::Schur;

/// Complex number in double precision.
pub(crate) type C = Complex<f64>;
/// Dynamically sized complex matrix.
pub(crate) type CMatrix = DMatrix<C>;

/// Returns an error for a matrix of the wrong shape, or with entries that are not finite.
pub(crate) fn check_matrix(
    matrix: &'static str,
    m: &DMatrix<f64>,
    rows: usize,
    columns: usize,
) -> Result<(), Error> {
    if m.shape() != (rows, columns) {
        return Err(Error::Shape { matrix, expected: (rows, columns), found: m.shape() });
    }
    if m.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Error::NotFinite { what: matrix }) }
}

/// Returns the number of rows of a matrix, or an error if the matrix is not square or not finite.
pub(crate) fn checked_square_size(matrix: &'static str, m: &DMatrix<f64>) -> Result<usize, Error> {
    check_matrix(matrix, m, m.nrows(), m.nrows())?;
    Ok(m.nrows())
}

/// Converts a real matrix to a complex one.
pub(crate) fn to_complex_matrix(m: &DMatrix<f64>) -> CMatrix {
    m.map(|x| C::new(x, 0.0))
}

/// Returns the one-norm of a matrix: the maximum over columns of the sum of magnitudes.
pub(crate) fn norm_one(m: &DMatrix<f64>) -> f64 {
    m.column_iter().map(|c| c.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max)
}

/// Returns the symmetric part of a matrix.
pub(crate) fn symmetric_part(m: &DMatrix<f64>) -> DMatrix<f64> {
    (m + m.transpose()) * 0.5
}

/// Solves the linear system `M X = R` for `X`.
pub(crate) fn solve_linear_system(
    what: &'static str,
    m: &DMatrix<f64>,
    right: &DMatrix<f64>,
) -> Result<DMatrix<f64>, Error> {
    if m.is_empty() {
        return Ok(right.clone());
    }
    let x = m.clone().lu().solve(right).ok_or(Error::Singular { what })?;
    if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(Error::Singular { what }) }
}
