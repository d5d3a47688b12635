//! Controllability and observability.

use crate::matrices::{
    C, CMatrix, Compression, balance_system, discrete_lyapunov, lyapunov, smallest_singular,
};
use crate::{Error, Signal, StateSpace};
use nalgebra::DMatrix;

/// What stands for rounding beside the norm of the matrices: those of computed systems are off by more than
/// one digit.
const ROUNDING: f64 = 1e-12;

/// The controllable part of a system on top: `[A₁₁ A₁₂; 0 A₂₂]`, `[B₁; 0]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Staircase {
    /// The system in the new states.
    pub system: StateSpace,
    /// Orthogonal `T` (times the diagonal scales if it was balanced): `x = T z`.
    pub transformation: DMatrix<f64>,
    /// The dimension of the part on top.
    pub rank: usize,
    /// The ranks of the steps: the controllability indices are their conjugate partition.
    pub steps: Vec<usize>,
}

/// The dimensions of Kalman's decomposition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KalmanRanks {
    /// Controllable and observable: the order of a minimal realisation.
    pub both: usize,
    /// Controllable, not observable.
    pub controllable_only: usize,
    /// Observable, not controllable.
    pub observable_only: usize,
    /// Neither.
    pub neither: usize,
}

impl StateSpace {
    fn scaled(&self) -> (Self, Vec<f64>) {
        let (a, b, c, d) = balance_system(&self.a, &self.b, &self.c);
        (Self { a, b, c, ..self.clone() }, d)
    }

    /// The system with inputs and outputs exchanged and matrices transposed.
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

    /// The staircase form by orthogonal transformations (Rosenbrock; Varga, *Numerically stable algorithm for
    /// standard controllability form determination*, 1981). `tolerance` is what counts as zero beside the
    /// norm of the matrices; zero stands for rounding.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] for a tolerance that is negative or no number.
    pub fn controllable_staircase(&self, tolerance: f64) -> Result<Staircase, Error> {
        if !(0.0..1.0).contains(&tolerance) {
            return Err(Error::Range { what: "a tolerance", value: tolerance });
        }
        let (scaled, scales) = self.scaled();
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
            let compression = Compression::rows(&block, least.max(f64::MIN_POSITIVE));
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
        clear(&mut a, &mut b, &steps, top);
        let transformation = DMatrix::from_fn(n, n, |i, j| scales[i] * t[(i, j)]);
        let states = (1..=n).map(|k| Signal::from(format!("z{k}"))).collect();
        let system = Self { c: &self.c * &transformation, a, b, states, ..self.clone() };
        Ok(Staircase { system, transformation, rank: top, steps })
    }

    /// Whether inputs can lead from every state to every other.
    ///
    /// # Errors
    ///
    /// Those of [`controllable_staircase`](Self::controllable_staircase).
    pub fn is_controllable(&self) -> Result<bool, Error> {
        Ok(self.controllable_staircase(0.0)?.rank == self.order())
    }

    /// Whether the outputs tell every state.
    ///
    /// # Errors
    ///
    /// Those of [`controllable_staircase`](Self::controllable_staircase).
    pub fn is_observable(&self) -> Result<bool, Error> {
        self.dual().is_controllable()
    }

    /// `[B, A B, A² B, …]`: for textbooks; ranks of large systems come from
    /// [the staircase](Self::controllable_staircase).
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

    /// `[C; C A; C A²; …]`.
    pub fn observability_matrix(&self) -> DMatrix<f64> {
        self.dual().controllability_matrix().transpose()
    }

    /// The controllability Gramian of a stable system: `A W + W Aᵀ + B Bᵀ = 0`, or `A W Aᵀ − W + B Bᵀ = 0`.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] names a pole.
    pub fn controllability_gramian(&self) -> Result<DMatrix<f64>, Error> {
        self.check_stable()?;
        let (scaled, d) = self.scaled();
        let q = &scaled.b * scaled.b.transpose();
        let w = match self.period {
            Some(_) => discrete_lyapunov(&scaled.a, &q)?,
            None => lyapunov(&scaled.a, &q)?,
        };
        Ok(DMatrix::from_fn(self.order(), self.order(), |i, j| w[(i, j)] * d[i] * d[j]))
    }

    /// The observability Gramian of a stable system: `Aᵀ W + W A + Cᵀ C = 0`, or `Aᵀ W A − W + Cᵀ C = 0`.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] names a pole.
    pub fn observability_gramian(&self) -> Result<DMatrix<f64>, Error> {
        self.dual().controllability_gramian()
    }

    /// Hankel singular values, largest first: how much of each state of a balanced realisation passes from
    /// inputs to outputs.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] names a pole.
    pub fn hankel_values(&self) -> Result<Vec<f64>, Error> {
        let (w, o) = (self.controllability_gramian()?, self.observability_gramian()?);
        if w.is_empty() {
            return Ok(Vec::new());
        }
        // Square roots by symmetric eigenvectors: of W = L Lᵀ the values are those of Lᵀ O L.
        let eigen = w.symmetric_eigen();
        let root = DMatrix::from_diagonal(&eigen.eigenvalues.map(|x| x.max(0.0).sqrt()));
        let l = eigen.eigenvectors * root;
        let middle = l.transpose() * o * l;
        let values = crate::matrices::symmetric(&middle).symmetric_eigenvalues();
        let mut values: Vec<f64> = values.iter().map(|x| x.max(0.0).sqrt()).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        Ok(values)
    }

    /// For every pole, the smallest singular value of `[A − λ I, B]` in balanced units beside the norm of
    /// `A`: how near it is to one that no input moves (Popov, Belevitch and Hautus).
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`].
    pub fn mode_controllability(&self) -> Result<Vec<(C, f64)>, Error> {
        let (scaled, _) = self.scaled();
        let (n, m) = scaled.b.shape();
        let size = scaled.a.norm().max(f64::MIN_POSITIVE);
        let distance = |pole: C| {
            let test = CMatrix::from_fn(n, n + m, |i, j| {
                if j >= n {
                    return C::new(scaled.b[(i, j - n)], 0.0);
                }
                let entry = C::new(scaled.a[(i, j)], 0.0);
                if i == j { entry - pole } else { entry }
            });
            (pole, smallest_singular(&test) / size)
        };
        Ok(self.poles()?.into_iter().map(distance).collect())
    }

    /// For every pole, how near it is to one that no output shows.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`].
    pub fn mode_observability(&self) -> Result<Vec<(C, f64)>, Error> {
        self.dual().mode_controllability()
    }

    /// The controllable and observable part: a minimal realisation, in new states. `tolerance` as for
    /// [the staircase](Self::controllable_staircase).
    ///
    /// # Errors
    ///
    /// Those of [`controllable_staircase`](Self::controllable_staircase).
    pub fn minimal(&self, tolerance: f64) -> Result<Self, Error> {
        let top = self.controllable_staircase(tolerance)?;
        let controllable = if top.rank == self.order() { self.clone() } else { top.system.leading(top.rank) };
        let seen = controllable.dual().controllable_staircase(tolerance)?;
        if seen.rank == controllable.order() {
            return Ok(controllable);
        }
        Ok(seen.system.leading(seen.rank).dual())
    }

    fn leading(&self, n: usize) -> Self {
        Self {
            a: self.a.view((0, 0), (n, n)).into_owned(),
            b: self.b.rows(0, n).into_owned(),
            c: self.c.columns(0, n).into_owned(),
            states: self.states.iter().take(n).cloned().collect(),
            ..self.clone()
        }
    }

    /// The dimensions of Kalman's decomposition; `tolerance` as for
    /// [the staircase](Self::controllable_staircase).
    ///
    /// # Errors
    ///
    /// Those of [`controllable_staircase`](Self::controllable_staircase).
    pub fn kalman_ranks(&self, tolerance: f64) -> Result<KalmanRanks, Error> {
        let top = self.controllable_staircase(tolerance)?;
        let observable = self.dual().controllable_staircase(tolerance)?.rank;
        let both = top.system.leading(top.rank).dual().controllable_staircase(tolerance)?.rank;
        let (controllable_only, observable_only) =
            (top.rank - both.min(top.rank), observable.saturating_sub(both));
        let neither = self.order().saturating_sub(both + controllable_only + observable_only);
        Ok(KalmanRanks { both, controllable_only, observable_only, neither })
    }
}

/// Zeros below the stairs, where there is rounding.
fn clear(a: &mut DMatrix<f64>, b: &mut DMatrix<f64>, steps: &[usize], top: usize) {
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
