//! Invariant zeros of linear systems.

use crate::matrices::{C, RowCompression, balance_system, eigenvalues, solve_linear_system};
use crate::{Error, StateSpace};
use nalgebra::DMatrix;

/// State-space system during the reduction to one with invertible `D`, whose eigenvalues are the invariant
/// zeros.
struct ReducedSystem {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    /// Magnitude below which matrix entries count as rounding errors.
    least: f64,
}

impl ReducedSystem {
    fn new(system: &StateSpace) -> Self {
        let (a, b, c, _) = balance_system(&system.a, &system.b, &system.c);
        // Inputs and outputs are scaled to the same norm as the states.
        let size = a.norm().max(f64::MIN_POSITIVE);
        let mut m = Self { a, b, c, d: system.d.clone(), least: 0.0 };
        for j in 0..m.b.ncols() {
            let norm = m.b.column(j).norm().hypot(m.d.column(j).norm());
            if norm > 0.0 {
                m.b.column_mut(j).scale_mut(size / norm);
                m.d.column_mut(j).scale_mut(size / norm);
            }
        }
        for i in 0..m.c.nrows() {
            let norm = m.c.row(i).norm().hypot(m.d.row(i).norm());
            if norm > 0.0 {
                m.c.row_mut(i).scale_mut(size / norm);
                m.d.row_mut(i).scale_mut(size / norm);
            }
        }
        m.least = 10.0 * f64::EPSILON * (m.a.nrows() + m.b.ncols() + m.c.nrows()) as f64 * size;
        m
    }

    fn transpose_system(self) -> Self {
        Self {
            a: self.a.transpose(),
            b: self.c.transpose(),
            c: self.b.transpose(),
            d: self.d.transpose(),
            ..self
        }
    }

    /// Eliminates states until the matrix `D` has full row rank. At a zero the outputs vanish, so that
    /// outputs without feedthrough restrict the states to a subspace, and the other states are removed.
    fn eliminate_states(mut self) -> Self {
        loop {
            let (n, p) = (self.a.nrows(), self.d.nrows());
            let of_d = RowCompression::compress_rows(&self.d, self.least);
            let sigma = of_d.rank;
            self.c = of_d.q.transpose() * &self.c;
            self.d = of_d.q.transpose() * &self.d;
            if sigma == p {
                return self;
            }
            let fixed = self.c.rows(sigma, p - sigma).transpose();
            let of_c = RowCompression::compress_rows(&fixed, self.least);
            let mu = of_c.rank;
            // The determined states come first; the others remain.
            let v = of_c.q;
            let a = v.transpose() * &self.a * &v;
            let b = v.transpose() * &self.b;
            let c = self.c.rows(0, sigma) * &v;
            let (stay, m) = (n - mu, self.d.ncols());
            let mut c_next = DMatrix::zeros(sigma + mu, stay);
            let mut d_next = DMatrix::zeros(sigma + mu, m);
            c_next.view_mut((0, 0), (sigma, stay)).copy_from(&c.columns(mu, stay));
            c_next.view_mut((sigma, 0), (mu, stay)).copy_from(&a.view((0, mu), (mu, stay)));
            d_next.view_mut((0, 0), (sigma, m)).copy_from(&self.d.rows(0, sigma));
            d_next.view_mut((sigma, 0), (mu, m)).copy_from(&b.rows(0, mu));
            self.a = a.view((mu, mu), (stay, stay)).into_owned();
            self.b = b.rows(mu, stay).into_owned();
            (self.c, self.d) = (c_next, d_next);
            if mu == 0 {
                return self;
            }
        }
    }
}

impl StateSpace {
    /// Computes the invariant zeros of the system: the values of `s` at which the system matrix
    /// `[A − s I, B; C, D]` has less than its normal rank. The method is the reduction of Emami-Naeini and
    /// Van Dooren (*Computation of zeros of linear multivariable systems*, Automatica 18, 1982). For a
    /// controllable and observable system they are the transmission zeros; otherwise they also include
    /// uncontrollable and unobservable modes.
    ///
    /// ```
    /// use linkwork_design::StateSpace;
    /// use nalgebra::dmatrix;
    ///
    /// // (s + 3) / (s² + s + 1).
    /// let g = StateSpace::new(dmatrix![0.0, 1.0; -1.0, -1.0], dmatrix![0.0; 1.0], dmatrix![3.0, 1.0], dmatrix![0.0])?;
    /// assert!((g.zeros()?[0].re + 3.0).abs() < 1e-14);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] if the eigenvalues of the reduced system do not converge.
    pub fn zeros(&self) -> Result<Vec<C>, Error> {
        let reduced = ReducedSystem::new(self)
            .eliminate_states()
            .transpose_system()
            .eliminate_states()
            .transpose_system();
        let (n, m) = (reduced.a.nrows(), reduced.d.ncols());
        if n == 0 {
            return Ok(Vec::new());
        }
        // A well-conditioned `D` is eliminated directly, which has the smallest rounding errors.
        if m > 0 {
            let values = reduced.d.clone().svd_unordered(false, false).singular_values;
            if values.min() > 0.01 * values.max() {
                let held = solve_linear_system("D", &reduced.d, &reduced.c)?;
                return eigenvalues(&(&reduced.a - &reduced.b * held));
            }
        }
        // Here D is square with full column rank. With `[D C] = [R 0] Qᵀ`, the inputs that keep the
        // outputs zero leave a pencil of the states alone.
        let mut both = DMatrix::zeros(reduced.d.nrows(), m + n);
        both.columns_mut(0, m).copy_from(&reduced.d);
        both.columns_mut(m, n).copy_from(&reduced.c);
        let compression = RowCompression::compress_rows(&both.transpose(), 0.0);
        let kernel = compression.q.columns(m, n);
        let (u, x) = (kernel.rows(0, m), kernel.rows(m, n));
        let left = &reduced.a * x + &reduced.b * u;
        let solved =
            solve_linear_system("the reduced pencil", &x.into_owned().transpose(), &left.transpose())?;
        eigenvalues(&solved.transpose())
    }
}
