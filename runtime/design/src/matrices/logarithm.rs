//! Matrix logarithm.

use super::{C, CMatrix, Schur, checked_square_size, to_complex_matrix};
use crate::Error;
use nalgebra::DMatrix;

/// Maximum number of square roots; each halves the distance from the identity.
const MAX_ROOTS: usize = 100;
/// Nodes and weights of the Gauss–Legendre rule with eight points on [0, 1].
const RULE: [(f64, f64); 8] = [
    (0.019855071751231884, 0.05061426814518813),
    (0.10166676129318664, 0.11119051722668724),
    (0.2372337950418355, 0.15685332293894364),
    (0.4082826787521751, 0.181341891689181),
    (0.591717321247825, 0.181341891689181),
    (0.7627662049581645, 0.15685332293894364),
    (0.8983332387068134, 0.11119051722668724),
    (0.9801449282487681, 0.05061426814518813),
];

/// Computes the principal logarithm: `X` with `e^X = A` whose eigenvalues have imaginary parts within `±π`.
/// Square roots of the Schur form are followed by a Padé approximation as partial fractions (Higham,
/// *Functions of Matrices*, 2008, ch. 11).
///
/// # Errors
///
/// [`Error::Range`] with a zero or negative eigenvalue, for which no real logarithm exists.
pub fn logarithm(a: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let n = checked_square_size("A", a)?;
    if n == 0 {
        return Ok(a.clone());
    }
    let Schur { q, mut t } = Schur::new(&to_complex_matrix(a))?;
    let largest = t.diagonal().iter().map(|x| x.norm()).fold(0.0, f64::max);
    for x in t.diagonal().iter() {
        let rounding = 1e-13 * largest;
        if x.norm() <= rounding || (x.re < 0.0 && x.im.abs() <= rounding) {
            return Err(Error::Range { what: "the logarithm of an eigenvalue", value: x.re });
        }
    }
    let identity = CMatrix::identity(n, n);
    let mut roots = 0;
    while (&t - &identity).norm() > 0.25 {
        if roots == MAX_ROOTS {
            return Err(Error::NotConverged { what: "the logarithm" });
        }
        t = square_root_of_triangular(&t);
        roots += 1;
    }
    let e = &t - &identity;
    let mut log = CMatrix::zeros(n, n);
    for (node, weight) in RULE {
        let denominator = &identity + &e * C::new(node, 0.0);
        let term = denominator.solve_upper_triangular(&e).ok_or(Error::Singular { what: "A" })?;
        log += term * C::new(weight, 0.0);
    }
    let log = &q * log * q.adjoint() * C::new((roots as f64).exp2(), 0.0);
    Ok(log.map(|x| x.re))
}

/// Returns the square root of an upper triangular matrix (Björck and Hammarling, 1983).
fn square_root_of_triangular(t: &CMatrix) -> CMatrix {
    let n = t.nrows();
    let mut r = CMatrix::zeros(n, n);
    for j in 0..n {
        r[(j, j)] = t[(j, j)].sqrt();
        for i in (0..j).rev() {
            let sum: C = (i + 1..j).map(|k| r[(i, k)] * r[(k, j)]).sum();
            r[(i, j)] = (t[(i, j)] - sum) / (r[(i, i)] + r[(j, j)]);
        }
    }
    r
}
