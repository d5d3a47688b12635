//! Solvers of Sylvester and Lyapunov equations by Schur forms (Bartels and Stewart, *Solution of the matrix
//! equation AX + XB = C*, 1972), with one step of iterative refinement.

use super::{C, CMatrix, Schur, check_matrix, checked_square_size, symmetric_part, to_complex_matrix};
use crate::Error;
use nalgebra::{DMatrix, DVector};

type CVector = DVector<C>;

/// Kind of Sylvester equation: `A X + X B = F` (continuous) or `A X B − X = F` (discrete).
#[derive(Clone, Copy)]
enum SylvesterKind {
    Continuous,
    Discrete,
}

/// Schur forms of both coefficient matrices of a Sylvester equation, reused for refinement.
struct SylvesterForms {
    left: Schur,
    right: Schur,
    kind: SylvesterKind,
}

impl SylvesterForms {
    fn new(a: &DMatrix<f64>, b: &DMatrix<f64>, kind: SylvesterKind) -> Result<Self, Error> {
        Ok(Self { left: Schur::new(&to_complex_matrix(a))?, right: Schur::new(&to_complex_matrix(b))?, kind })
    }

    /// Solves the Sylvester equation `A X + X B = F`, or `A X B − X = F`, for `X`.
    fn solve_sylvester_equation(&self, f: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
        let (t, s) = (&self.left.t, &self.right.t);
        let f = self.left.q.adjoint() * to_complex_matrix(f) * &self.right.q;
        let mut y = CMatrix::zeros(f.nrows(), f.ncols());
        for k in 0..f.ncols() {
            let mut before = CVector::zeros(f.nrows());
            for j in 0..k {
                before += y.column(j) * s[(j, k)];
            }
            let own = s[(k, k)];
            let (factor, plus, right) = match self.kind {
                SylvesterKind::Continuous => (C::new(1.0, 0.0), own, f.column(k) - before),
                SylvesterKind::Discrete => (own, C::new(-1.0, 0.0), f.column(k) - t * before),
            };
            y.set_column(k, &solve_shifted_triangular(t, factor, plus, right)?);
        }
        Ok((&self.left.q * y * self.right.q.adjoint()).map(|x| x.re))
    }
}

/// Solves `(factor T + plus I) x = right` for `x`, with an upper triangular matrix `T`.
fn solve_shifted_triangular(t: &CMatrix, factor: C, plus: C, mut right: CVector) -> Result<CVector, Error> {
    for i in (0..right.nrows()).rev() {
        let sum: C = (i + 1..right.nrows()).map(|j| factor * t[(i, j)] * right[j]).sum();
        let (one, other) = (factor * t[(i, i)], plus);
        if (one + other).norm() <= 4.0 * f64::EPSILON * (one.norm() + other.norm()) {
            return Err(Error::Singular { what: "the equation, whose eigenvalues cancel," });
        }
        right[i] = (right[i] - sum) / (one + other);
    }
    Ok(right)
}

/// Solves the Sylvester equation `A X + X B = C` for `X`.
///
/// ```
/// use linkwork_design::matrices::sylvester;
/// use nalgebra::dmatrix;
///
/// let (a, b, c) = (dmatrix![1.0, 2.0; 0.0, 3.0], dmatrix![4.0], dmatrix![5.0; 6.0]);
/// let x = sylvester(&a, &b, &c)?;
/// assert!((&a * &x + &x * &b - &c).norm() < 1e-14);
/// # Ok::<(), linkwork_design::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Shape`] and [`Error::NotFinite`] with the name of the matrix; [`Error::Singular`] if an
/// eigenvalue of `A` is the negative of an eigenvalue of `B`.
pub fn sylvester(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let (n, m) = (checked_square_size("A", a)?, checked_square_size("B", b)?);
    check_matrix("C", c, n, m)?;
    let sides = SylvesterForms::new(a, b, SylvesterKind::Continuous)?;
    let x = sides.solve_sylvester_equation(c)?;
    let residual = c - a * &x - &x * b;
    Ok(&x + sides.solve_sylvester_equation(&residual)?)
}

/// Solves the discrete Sylvester equation `A X B − X + C = 0` for `X`.
///
/// # Errors
///
/// [`Error::Shape`] and [`Error::NotFinite`] with the name of the matrix; [`Error::Singular`] if the product
/// of an eigenvalue of `A` and an eigenvalue of `B` is one.
pub fn discrete_sylvester(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    c: &DMatrix<f64>,
) -> Result<DMatrix<f64>, Error> {
    let (n, m) = (checked_square_size("A", a)?, checked_square_size("B", b)?);
    check_matrix("C", c, n, m)?;
    let sides = SylvesterForms::new(a, b, SylvesterKind::Discrete)?;
    let x = sides.solve_sylvester_equation(&-c)?;
    let residual = -(c + a * &x * b - &x);
    Ok(&x + sides.solve_sylvester_equation(&residual)?)
}

/// Solves the Lyapunov equation `A X + X Aᵀ + Q = 0` for `X`, the covariance of a stable system under white
/// noise. `X` is symmetric if `Q` is symmetric.
///
/// # Errors
///
/// [`Error::Shape`] and [`Error::NotFinite`] with the name of the matrix; [`Error::Singular`] if two
/// eigenvalues of `A` add up to zero.
pub fn lyapunov(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let n = checked_square_size("A", a)?;
    check_matrix("Q", q, n, n)?;
    Ok(restore_symmetry(q, sylvester(a, &a.transpose(), &-q)?))
}

/// Solves the discrete Lyapunov equation `A X Aᵀ − X + Q = 0` for `X`, which is symmetric if `Q` is
/// symmetric.
///
/// # Errors
///
/// [`Error::Shape`] and [`Error::NotFinite`] with the name of the matrix; [`Error::Singular`] if the product
/// of two eigenvalues of `A` is one.
pub fn discrete_lyapunov(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let n = checked_square_size("A", a)?;
    check_matrix("Q", q, n, n)?;
    Ok(restore_symmetry(q, discrete_sylvester(a, &a.transpose(), q)?))
}

/// Removes the asymmetric rounding error of the solution of a Lyapunov equation if `Q` is symmetric.
fn restore_symmetry(q: &DMatrix<f64>, x: DMatrix<f64>) -> DMatrix<f64> {
    if *q == q.transpose() { symmetric_part(&x) } else { x }
}
