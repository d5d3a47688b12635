//! Solvers of Riccati equations. The continuous equation is solved by an ordered Schur form, the discrete one
//! by an invariant subspace or by doubling; Newton's method refines both solutions.

use super::{
    C, CMatrix, Schur, balance_matrix, balance_system, check_matrix, checked_square_size, discrete_lyapunov,
    eigenvalues, lyapunov, smallest_singular_value, solve_linear_system, symmetric_part, to_complex_matrix,
};
use crate::Error;
use nalgebra::DMatrix;

/// Maximum number of doubling steps; ten are usual.
const MAX_ITERATIONS: usize = 60;

/// Weights of a quadratic cost `∫ xᵀQx + 2xᵀNu + uᵀRu dt` (or the corresponding sum): `Q` positive
/// semidefinite, `R` positive definite.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Weight matrix `Q` of the states in the quadratic cost.
    pub q: DMatrix<f64>,
    /// Weight matrix `R` of the inputs in the quadratic cost.
    pub r: DMatrix<f64>,
    /// Weight matrix `N` of products of states and inputs in the quadratic cost.
    pub n: DMatrix<f64>,
}

impl Cost {
    /// Creates a quadratic cost without products of states and inputs.
    pub fn new(q: DMatrix<f64>, r: DMatrix<f64>) -> Self {
        let n = DMatrix::zeros(q.nrows(), r.nrows());
        Self { q, r, n }
    }

    /// Creates a quadratic cost with diagonal weights. Bryson's rule chooses the reciprocal of the square of
    /// the maximum acceptable deviation.
    pub fn diagonal(states: &[f64], inputs: &[f64]) -> Self {
        let diagonal_matrix = |x: &[f64]| DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(x));
        Self::new(diagonal_matrix(states), diagonal_matrix(inputs))
    }

    /// Sets the weight of products of states and inputs in the quadratic cost.
    pub fn with_products(mut self, n: DMatrix<f64>) -> Self {
        self.n = n;
        self
    }

    fn checked_state_count(&self, a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<usize, Error> {
        let n = checked_square_size("A", a)?;
        check_matrix("B", b, n, b.ncols())?;
        check_matrix("Q", &self.q, n, n)?;
        check_matrix("R", &self.r, b.ncols(), b.ncols())?;
        check_matrix("N", &self.n, n, b.ncols())?;
        for (matrix, m) in [("Q", &self.q), ("R", &self.r)] {
            if (m - m.transpose()).amax() > 1e-10 * m.amax() {
                return Err(Error::Indefinite { matrix });
            }
        }
        if b.ncols() > 0 {
            let values = symmetric_part(&self.r).symmetric_eigenvalues();
            if values.iter().all(|x| x.abs() <= f64::EPSILON * self.r.amax()) || values.amin() == 0.0 {
                return Err(Error::Singular { what: "R" });
            }
            if values.min() <= 0.0 {
                return Err(Error::Indefinite { matrix: "R" });
            }
        }
        Ok(n)
    }

    /// Returns `A − B R⁻¹ Nᵀ`, `B R⁻¹ Bᵀ` and `Q − N R⁻¹ Nᵀ`: the equivalent regulator problem whose cost has
    /// no products of states and inputs.
    fn regulator_without_cross_terms(
        &self,
        a: &DMatrix<f64>,
        b: &DMatrix<f64>,
    ) -> Result<[DMatrix<f64>; 3], Error> {
        let both = solve_linear_system("R", &self.r, &self.n.transpose())?;
        let g = b * solve_linear_system("R", &self.r, &b.transpose())?;
        Ok([a - b * &both, symmetric_part(&g), symmetric_part(&(&self.q - &self.n * both))])
    }
}

/// Stabilising solution of an algebraic Riccati equation.
#[derive(Clone, Debug, PartialEq)]
pub struct Riccati {
    /// Solution `X`; `x₀ᵀ X x₀` is the minimum cost from the initial state `x₀`.
    pub x: DMatrix<f64>,
    /// Gain `K` of the optimal inputs `u = −K x`.
    pub gain: DMatrix<f64>,
    /// Closed-loop poles: the eigenvalues of `A − B K`.
    pub poles: Vec<C>,
}

/// Solves the continuous Riccati equation `Aᵀ X + X A − (X B + N) R⁻¹ (Bᵀ X + Nᵀ) + Q = 0`. The solution is
/// computed from the stable invariant subspace of the balanced Hamiltonian matrix, by an ordered Schur form
/// (Laub, *A Schur method for solving algebraic Riccati equations*, 1979), and refined by Kleinman's
/// iteration.
///
/// ```
/// use linkwork_design::matrices::{Cost, riccati};
/// use nalgebra::dmatrix;
///
/// let (a, b) = (dmatrix![-3.0, 2.0; 1.0, 1.0], dmatrix![0.0; 1.0]);
/// let best = riccati(&a, &b, &Cost::new(dmatrix![1.0, -1.0; -1.0, 1.0], dmatrix![3.0]))?;
/// assert!((best.gain[(0, 1)] - 2.93961326897437).abs() < 1e-13);
/// # Ok::<(), linkwork_design::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Unstabilizable`] and [`Error::Undetectable`] with the mode that causes it; [`Error::Singular`]
/// and [`Error::Indefinite`] with the weight; [`Error::Shape`] and [`Error::NotFinite`] with the matrix.
pub fn riccati(a: &DMatrix<f64>, b: &DMatrix<f64>, cost: &Cost) -> Result<Riccati, Error> {
    let n = cost.checked_state_count(a, b)?;
    check_stabilisable_modes(a, b, cost, |mode| mode.re >= 0.0, |mode| mode.re.abs())?;
    let [f, g, q] = cost.regulator_without_cross_terms(a, b)?;
    let mut h = DMatrix::zeros(2 * n, 2 * n);
    h.view_mut((0, 0), (n, n)).copy_from(&f);
    h.view_mut((0, n), (n, n)).copy_from(&-&g);
    h.view_mut((n, 0), (n, n)).copy_from(&-&q);
    h.view_mut((n, n), (n, n)).copy_from(&-f.transpose());
    let d = symplectic_scaling(&h);
    let scaled = DMatrix::from_fn(2 * n, 2 * n, |i, j| h[(i, j)] * d[j] / d[i]);
    let mut schur = Schur::new(&to_complex_matrix(&scaled))?;
    if schur.reorder(|x| x.re < 0.0) != n {
        return Err(Error::NotConverged {
            what: "Riccati's equation, with eigenvalues on the imaginary axis,",
        });
    }
    let x = subspace_solution(&schur, &d)?;
    let riccati_residual = |x: &DMatrix<f64>| f.transpose() * x + x * &f - x * &g * x + &q;
    let newton_step = |x: &DMatrix<f64>| {
        let closed = &f - &g * x;
        Ok(x + lyapunov(&closed.transpose(), &riccati_residual(x))?)
    };
    let x = refine_by_newton(x, riccati_residual, newton_step)?;
    let gain = solve_linear_system("R", &cost.r, &(b.transpose() * &x + cost.n.transpose()))?;
    let poles = eigenvalues(&(a - b * &gain))?;
    if poles.iter().any(|p| p.re >= 0.0) {
        return Err(Error::NotConverged { what: "Riccati's equation" });
    }
    Ok(Riccati { x, gain, poles })
}

/// Returns powers of two that balance a Hamiltonian matrix and preserve its structure: the second half are
/// the reciprocals of the first half.
fn symplectic_scaling(h: &DMatrix<f64>) -> Vec<f64> {
    let n = h.nrows() / 2;
    let sizes = h.map(f64::abs);
    let (_, d) = balance_matrix(&sizes);
    let balancing_scale = |i: usize| (0.5 * (d[i].log2() - d[n + i].log2())).round().exp2();
    (0..n).map(balancing_scale).chain((0..n).map(|i| 1.0 / balancing_scale(i))).collect()
}

/// Refines the solution of a Riccati equation by at most four Newton steps, as long as they reduce the
/// residual.
fn refine_by_newton(
    mut x: DMatrix<f64>,
    residual: impl Fn(&DMatrix<f64>) -> DMatrix<f64>,
    newton: impl Fn(&DMatrix<f64>) -> Result<DMatrix<f64>, Error>,
) -> Result<DMatrix<f64>, Error> {
    let mut size = residual(&x).norm();
    for _ in 0..4 {
        if size == 0.0 {
            break;
        }
        // A step may fail if the equation is nearly singular; the solution so far is returned then.
        let Ok(next) = newton(&x) else { break };
        let next = symmetric_part(&next);
        let smaller = residual(&next).norm();
        if smaller.is_nan() || smaller >= size {
            break;
        }
        (x, size) = (next, smaller);
    }
    Ok(x)
}

/// Returns an error that names the mode for which the Riccati equation has no stabilising solution: unstable
/// modes must be controllable, and modes on the stability boundary must contribute to the cost.
fn check_stabilisable_modes(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    cost: &Cost,
    unstable: impl Fn(C) -> bool,
    distance: impl Fn(C) -> f64,
) -> Result<(), Error> {
    let size = balance_matrix(a).0.norm().max(f64::MIN_POSITIVE);
    for mode in eigenvalues(a)? {
        if (unstable(mode) || distance(mode) <= 1e-10 * size) && is_uncontrollable_mode(a, b, mode) {
            return Err(Error::Unstabilizable { mode });
        }
    }
    let [f, _, q] = cost.regulator_without_cross_terms(a, b)?;
    for mode in eigenvalues(&f)? {
        if distance(mode) <= 1e-10 * size && is_uncontrollable_mode(&f.transpose(), &q, mode) {
            return Err(Error::Undetectable { mode });
        }
    }
    Ok(())
}

/// Whether no input controls a mode: whether `[A − λ I, B]` loses rank numerically (test of Popov, Belevitch
/// and Hautus), with `A` and `B` scaled separately.
pub(crate) fn is_uncontrollable_mode(a: &DMatrix<f64>, b: &DMatrix<f64>, mode: C) -> bool {
    let n = a.nrows();
    let (a, b, _, _) = balance_system(a, b, &DMatrix::zeros(0, n));
    let reciprocal_norm = |m: &DMatrix<f64>| if m.norm() > 0.0 { 1.0 / m.norm() } else { 1.0 };
    let (of_a, of_b) = (reciprocal_norm(&a), reciprocal_norm(&b));
    let m = CMatrix::from_fn(n, n + b.ncols(), |i, j| {
        if j >= n {
            return C::new(b[(i, j - n)] * of_b, 0.0);
        }
        let entry = C::new(a[(i, j)], 0.0);
        (if i == j { entry - mode } else { entry }) * of_a
    });
    smallest_singular_value(&m) <= 1e-12 * n as f64
}

/// Solves the discrete Riccati equation `Aᵀ X A − X − (Aᵀ X B + N) (R + Bᵀ X B)⁻¹ (Bᵀ X A + Nᵀ) + Q = 0`. Two
/// candidates are computed and refined by Newton's method, and the one with the smaller residual is returned.
/// One is from the symplectic matrix. The other is from structure-preserving doubling, which needs no inverse
/// of `A` (Chu, Fan, Lin and Wang, *Structure-preserving algorithms for periodic discrete-time algebraic
/// Riccati equations*, 2004). `R` may be singular if `R + Bᵀ X B` is not.
///
/// # Errors
///
/// [`Error::Unstabilizable`] and [`Error::Undetectable`] with the mode that causes it; [`Error::Singular`]
/// and [`Error::Indefinite`] with the weight; [`Error::Shape`] and [`Error::NotFinite`] with the matrix.
pub fn discrete_riccati(a: &DMatrix<f64>, b: &DMatrix<f64>, cost: &Cost) -> Result<Riccati, Error> {
    match cost.checked_state_count(a, b) {
        Err(Error::Singular { .. }) if cost.r.clone().symmetric_eigenvalues().iter().all(|x| *x >= 0.0) => {
            return solve_with_singular_input_weight(a, b, cost);
        }
        checked => checked?,
    };
    check_stabilisable_modes(a, b, cost, |mode| mode.norm() >= 1.0, |mode| (mode.norm() - 1.0).abs())?;
    let [f, g, q] = cost.regulator_without_cross_terms(a, b)?;
    // The symplectic matrix loses digits if A is nearly singular, doubling if A is far from stable.
    let ways = [solve_by_symplectic_subspace(&f, &g, &q), doubling_limit(&f, &g, &q)];
    let mut best = Err(Error::NotConverged { what: "the discrete Riccati equation" });
    let mut least = f64::INFINITY;
    for x in ways.into_iter().flatten() {
        let Ok((found, residual)) = refine_discrete_solution(a, b, cost, x) else { continue };
        if residual < least {
            (best, least) = (Ok(found), residual);
        }
    }
    best
}

/// Solves a discrete Riccati equation with singular `R` by Newton's method, starting from the solution for
/// slightly increased `R`.
fn solve_with_singular_input_weight(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    cost: &Cost,
) -> Result<Riccati, Error> {
    let little = 1e-6 * (cost.r.norm() + cost.q.norm() * b.norm_squared());
    if little == 0.0 {
        return Err(Error::Singular { what: "R" });
    }
    let m = b.ncols();
    let near = Cost { r: &cost.r + DMatrix::identity(m, m) * little, ..cost.clone() };
    let found = discrete_riccati(a, b, &near)?;
    Ok(refine_discrete_solution(a, b, cost, found.x)?.0)
}

/// Computes the solution of a discrete Riccati equation as the limit of the doubling iteration.
fn doubling_limit(f: &DMatrix<f64>, g: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let n = f.nrows();
    let (mut a_k, mut g_k, mut h_k) = (f.clone(), g.clone(), q.clone());
    let identity = DMatrix::<f64>::identity(n, n);
    for _ in 0..MAX_ITERATIONS {
        let lu = (&identity + &g_k * &h_k).lu();
        let singular = Error::Singular { what: "the doubled equation" };
        let (Some(wa), Some(wg)) = (lu.solve(&a_k), lu.solve(&g_k)) else { return Err(singular) };
        let change = symmetric_part(&(a_k.transpose() * &h_k * &wa));
        h_k += &change;
        g_k = symmetric_part(&(&g_k + &a_k * wg * a_k.transpose()));
        a_k *= wa;
        if !change.iter().all(|x| x.is_finite()) {
            break;
        }
        if change.norm() <= 1e-15 * h_k.norm() {
            return Ok(h_k);
        }
    }
    Err(Error::NotConverged { what: "the discrete Riccati equation" })
}

/// Computes the solution of a discrete Riccati equation from the invariant subspace of the symplectic matrix
/// inside the unit circle (Laub, 1979).
fn solve_by_symplectic_subspace(
    f: &DMatrix<f64>,
    g: &DMatrix<f64>,
    q: &DMatrix<f64>,
) -> Result<DMatrix<f64>, Error> {
    let n = f.nrows();
    let inverse = solve_linear_system("A", &f.transpose(), &DMatrix::identity(n, n))?;
    let below = solve_linear_system("A", &f.transpose(), q)?;
    let mut s = DMatrix::zeros(2 * n, 2 * n);
    s.view_mut((0, 0), (n, n)).copy_from(&(f + g * &below));
    s.view_mut((0, n), (n, n)).copy_from(&-(g * &inverse));
    s.view_mut((n, 0), (n, n)).copy_from(&-below);
    s.view_mut((n, n), (n, n)).copy_from(&inverse);
    let d = symplectic_scaling(&s);
    let scaled = DMatrix::from_fn(2 * n, 2 * n, |i, j| s[(i, j)] * d[j] / d[i]);
    let mut schur = Schur::new(&to_complex_matrix(&scaled))?;
    if schur.reorder(|x| x.norm() < 1.0) != n {
        return Err(Error::NotConverged { what: "the discrete Riccati equation" });
    }
    subspace_solution(&schur, &d)
}

/// Solves `X U₁ = U₂` for the leading invariant subspace `[U₁; U₂]`, in the units before scaling.
fn subspace_solution(schur: &Schur, d: &[f64]) -> Result<DMatrix<f64>, Error> {
    let n = d.len() / 2;
    let (upper, lower) = (schur.q.view((0, 0), (n, n)), schur.q.view((n, 0), (n, n)));
    let x: CMatrix =
        upper.transpose().lu().solve(&lower.transpose()).ok_or(Error::Singular { what: "the subspace" })?;
    let x = DMatrix::from_fn(n, n, |i, j| 0.5 * (x[(i, j)].re + x[(j, i)].re) * d[n + i] / d[j]);
    Ok(symmetric_part(&x))
}

/// Refines the solution of a discrete Riccati equation by Newton's method. Returns it with its gain and
/// relative residual, or an error if it does not stabilise.
fn refine_discrete_solution(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    cost: &Cost,
    x: DMatrix<f64>,
) -> Result<(Riccati, f64), Error> {
    let n = a.nrows();
    let feedback_gain = |x: &DMatrix<f64>| {
        let weight = symmetric_part(&(&cost.r + b.transpose() * x * b));
        solve_linear_system("R + BᵀXB", &weight, &(b.transpose() * x * a + cost.n.transpose()))
    };
    let riccati_residual = |x: &DMatrix<f64>| match feedback_gain(x) {
        Ok(k) => a.transpose() * x * a - x - (a.transpose() * x * b + &cost.n) * k + &cost.q,
        Err(_) => DMatrix::from_element(n, n, f64::INFINITY),
    };
    let newton_step = |x: &DMatrix<f64>| {
        let closed = a - b * feedback_gain(x)?;
        Ok(x + discrete_lyapunov(&closed.transpose(), &symmetric_part(&riccati_residual(x)))?)
    };
    let x = refine_by_newton(x, riccati_residual, newton_step)?;
    let left = riccati_residual(&x).norm() / (x.norm() + cost.q.norm());
    let gain = feedback_gain(&x)?;
    let poles = eigenvalues(&(a - b * &gain))?;
    if poles.iter().any(|p| p.norm() >= 1.0) {
        return Err(Error::NotConverged { what: "the discrete Riccati equation" });
    }
    Ok((Riccati { x, gain, poles }, left))
}
