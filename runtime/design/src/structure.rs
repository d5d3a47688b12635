//! Controllability and observability of linear systems.

use crate::matrices::{
    C, CMatrix, RowCompression, balance_system, discrete_lyapunov, lyapunov, smallest_singular_value,
};
use crate::{Error, Signal, StateSpace};
use nalgebra::DMatrix;

/// Default tolerance relative to the norm of the matrices. Matrices of computed systems have errors of
/// several digits.
const ROUNDING: f64 = 1e-12;

/// Staircase form of a system, with the controllable part first: `[A₁₁ A₁₂; 0 A₂₂]`, `[B₁; 0]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Staircase {
    /// System in the transformed states of the staircase form.
    pub system: StateSpace,
    /// Transformation `x = T z` between the states of both systems: orthogonal, or orthogonal times diagonal
    /// scales if the system was balanced.
    pub transformation: DMatrix<f64>,
    /// Dimension of the controllable subspace.
    pub rank: usize,
    /// Ranks of the blocks of the staircase form. The controllability indices are the conjugate partition of
    /// these ranks.
    pub steps: Vec<usize>,
}

/// Dimensions of the four subspaces of Kalman's decomposition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KalmanRanks {
    /// Dimension of the controllable and observable part, which is the order of a minimal realisation.
    pub both: usize,
    /// Dimension of the controllable and unobservable part.
    pub controllable_only: usize,
    /// Dimension of the uncontrollable and observable part.
    pub observable_only: usize,
    /// Dimension of the uncontrollable and unobservable part.
    pub neither: usize,
}

impl StateSpace {
    fn diagonally_balanced_system(&self) -> (Self, Vec<f64>) {
        let (a, b, c, d) = balance_system(&self.a, &self.b, &self.c);
        (Self { a, b, c, ..self.clone() }, d)
    }

    /// Returns the dual system: inputs and outputs exchanged, and matrices transposed.
    pub fn dual(&self) -> Self {
        Self {
            a: self.a.transpose(),
            b: self.c.transpose(),
            c: self.b.transpose(),
            d: self.d.transpose(),
            states: self.states.clone(),
            inputs: self.outputs.clone(),
            outputs: self.inputs.clone(),
            period: self.period,
        }
    }

    /// Computes the staircase form by orthogonal transformations (Rosenbrock; Varga, *Numerically stable
    /// algorithm for standard controllability form determination*, 1981). Values below `tolerance` times the
    /// norm of the matrices count as zero; a tolerance of zero selects a default for rounding errors.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] for a tolerance that is NaN or not between 0 and 1.
    pub fn controllable_staircase(&self, tolerance: f64) -> Result<Staircase, Error> {
        if !(0.0..1.0).contains(&tolerance) {
            return Err(Error::Range { what: "a tolerance", value: tolerance });
        }
        let (scaled, scales) = self.diagonally_balanced_system();
        let n = self.order();
        let relative = if tolerance > 0.0 { tolerance } else { ROUNDING.max(10.0 * f64::EPSILON * n as f64) };
        let (size_a, size_b) = (scaled.a.norm(), scaled.b.norm());
        let (mut a, mut b, mut t) = (scaled.a, scaled.b, DMatrix::<f64>::identity(n, n));
        let mut steps = Vec::new();
        let (mut top, mut before) = (0, 0);
        while top < n {
            let (block, least) = match steps.is_empty() {
                true => (b.clone(), relative * size_b),
                false => (a.view((top, before), (n - top, top - before)).into_owned(), relative * size_a),
            };
            let compression = RowCompression::compress_rows(&block, least.max(f64::MIN_POSITIVE));
            if compression.rank == 0 {
                break;
            }
            let mut q = DMatrix::identity(n, n);
            q.view_mut((top, top), (n - top, n - top)).copy_from(&compression.q);
            a = q.transpose() * a * &q;
            b = q.transpose() * b;
            t *= q;
            steps.push(compression.rank);
            (before, top) = (top, top + compression.rank);
        }
        clear_below_stairs(&mut a, &mut b, &steps, top);
        let transformation = DMatrix::from_fn(n, n, |i, j| scales[i] * t[(i, j)]);
        let states = (1..=n).map(|k| Signal::from(format!("z{k}"))).collect();
        let system = Self { c: &self.c * &transformation, a, b, states, ..self.clone() };
        Ok(Staircase { system, transformation, rank: top, steps })
    }

    /// Whether inputs can steer the system from every state to every other state.
    ///
    /// # Errors
    ///
    /// As for [`controllable_staircase`](Self::controllable_staircase).
    pub fn is_controllable(&self) -> Result<bool, Error> {
        Ok(self.controllable_staircase(0.0)?.rank == self.order())
    }

    /// Whether the outputs determine the state of the system.
    ///
    /// # Errors
    ///
    /// As for [`controllable_staircase`](Self::controllable_staircase).
    pub fn is_observable(&self) -> Result<bool, Error> {
        self.dual().is_controllable()
    }

    /// Returns the controllability matrix `[B, A B, A² B, …]`. It serves teaching; for ranks of large systems
    /// use [the staircase form](Self::controllable_staircase).
    pub fn controllability_matrix(&self) -> DMatrix<f64> {
        let (n, m) = self.b.shape();
        let mut all = DMatrix::zeros(n, n * m);
        let mut block = self.b.clone();
        for k in 0..n {
            all.columns_mut(k * m, m).copy_from(&block);
            block = &self.a * block;
        }
        all
    }

    /// Returns the observability matrix `[C; C A; C A²; …]`.
    pub fn observability_matrix(&self) -> DMatrix<f64> {
        self.dual().controllability_matrix().transpose()
    }

    /// Computes the controllability Gramian of a stable system: `A W + W Aᵀ + B Bᵀ = 0`, or
    /// `A W Aᵀ − W + B Bᵀ = 0` in discrete time.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] with an unstable pole.
    pub fn controllability_gramian(&self) -> Result<DMatrix<f64>, Error> {
        self.check_stable()?;
        let (scaled, d) = self.diagonally_balanced_system();
        let q = &scaled.b * scaled.b.transpose();
        let w = match self.period {
            Some(_) => discrete_lyapunov(&scaled.a, &q)?,
            None => lyapunov(&scaled.a, &q)?,
        };
        Ok(DMatrix::from_fn(self.order(), self.order(), |i, j| w[(i, j)] * d[i] * d[j]))
    }

    /// Computes the observability Gramian of a stable system: `Aᵀ W + W A + Cᵀ C = 0`, or
    /// `Aᵀ W A − W + Cᵀ C = 0` in discrete time.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] with an unstable pole.
    pub fn observability_gramian(&self) -> Result<DMatrix<f64>, Error> {
        self.dual().controllability_gramian()
    }

    /// Computes the Hankel singular values in descending order. They measure how strongly each state of a
    /// balanced realisation couples inputs and outputs.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] with an unstable pole.
    pub fn hankel_values(&self) -> Result<Vec<f64>, Error> {
        let (w, o) = (self.controllability_gramian()?, self.observability_gramian()?);
        if w.is_empty() {
            return Ok(Vec::new());
        }
        // Square root by symmetric eigenvectors: with W = L Lᵀ, the squares of the values are eigenvalues
        // of Lᵀ O L.
        let eigen = w.symmetric_eigen();
        let root = DMatrix::from_diagonal(&eigen.eigenvalues.map(|x| x.max(0.0).sqrt()));
        let l = eigen.eigenvectors * root;
        let middle = l.transpose() * o * l;
        let values = crate::matrices::symmetric_part(&middle).symmetric_eigenvalues();
        let mut values: Vec<f64> = values.iter().map(|x| x.max(0.0).sqrt()).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        Ok(values)
    }

    /// Computes for every pole `λ` the smallest singular value of `[A − λ I, B]`, in balanced units and
    /// relative to the norm of `A`. A small value means that the mode is nearly uncontrollable (test of
    /// Popov, Belevitch and Hautus).
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`].
    pub fn mode_controllability(&self) -> Result<Vec<(C, f64)>, Error> {
        let (scaled, _) = self.diagonally_balanced_system();
        let (n, m) = scaled.b.shape();
        let size = scaled.a.norm().max(f64::MIN_POSITIVE);
        let pole_with_uncontrollability_distance = |pole: C| {
            let test = CMatrix::from_fn(n, n + m, |i, j| {
                if j >= n {
                    return C::new(scaled.b[(i, j - n)], 0.0);
                }
                let entry = C::new(scaled.a[(i, j)], 0.0);
                if i == j { entry - pole } else { entry }
            });
            (pole, smallest_singular_value(&test) / size)
        };
        Ok(self.poles()?.into_iter().map(pole_with_uncontrollability_distance).collect())
    }

    /// Computes for every pole its distance from unobservability, the dual of
    /// [`mode_controllability`](Self::mode_controllability).
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`].
    pub fn mode_observability(&self) -> Result<Vec<(C, f64)>, Error> {
        self.dual().mode_controllability()
    }

    /// Returns a minimal realisation: the controllable and observable part, in new states. `tolerance` is
    /// that of [the staircase form](Self::controllable_staircase).
    ///
    /// # Errors
    ///
    /// As for [`controllable_staircase`](Self::controllable_staircase).
    pub fn minimal(&self, tolerance: f64) -> Result<Self, Error> {
        let top = self.controllable_staircase(tolerance)?;
        let controllable =
            if top.rank == self.order() { self.clone() } else { top.system.leading_subsystem(top.rank) };
        let seen = controllable.dual().controllable_staircase(tolerance)?;
        if seen.rank == controllable.order() {
            return Ok(controllable);
        }
        Ok(seen.system.leading_subsystem(seen.rank).dual())
    }

    fn leading_subsystem(&self, n: usize) -> Self {
        Self {
            a: self.a.view((0, 0), (n, n)).into_owned(),
            b: self.b.rows(0, n).into_owned(),
            c: self.c.columns(0, n).into_owned(),
            states: self.states.iter().take(n).cloned().collect(),
            ..self.clone()
        }
    }

    /// Computes the dimensions of Kalman's decomposition. `tolerance` is that of [the staircase
    /// form](Self::controllable_staircase).
    ///
    /// # Errors
    ///
    /// As for [`controllable_staircase`](Self::controllable_staircase).
    pub fn kalman_ranks(&self, tolerance: f64) -> Result<KalmanRanks, Error> {
        let top = self.controllable_staircase(tolerance)?;
        let observable = self.dual().controllable_staircase(tolerance)?.rank;
        let both = top.system.leading_subsystem(top.rank).dual().controllable_staircase(tolerance)?.rank;
        let (controllable_only, observable_only) =
            (top.rank - both.min(top.rank), observable.saturating_sub(both));
        let neither = self.order().saturating_sub(both + controllable_only + observable_only);
        Ok(KalmanRanks { both, controllable_only, observable_only, neither })
    }
}

/// Sets entries below the stairs, which are rounding errors, to zero.
fn clear_below_stairs(a: &mut DMatrix<f64>, b: &mut DMatrix<f64>, steps: &[usize], top: usize) {
    let n = a.nrows();
    let (mut row, mut column) = (0, 0);
    for (k, step) in steps.iter().enumerate() {
        row += step;
        if k == 0 {
            b.rows_mut(row, n - row).fill(0.0);
        } else {
            a.view_mut((row, column), (n - row, steps[k - 1])).fill(0.0);
            column += steps[k - 1];
        }
    }
    a.view_mut((top, 0), (n - top, top)).fill(0.0);
}
