//! Linear–quadratic regulators and Kalman filters.

use crate::matrices::{Cost, Riccati, discrete_riccati, riccati};
use crate::{Error, Hold, StateSpace};
use nalgebra::DMatrix;

/// Covariances of process and measurement noise; intensities for a continuous system.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Covariance of the process noise on the states, `G W Gᵀ`.
    pub states: DMatrix<f64>,
    /// Covariance of the measurement noise on the outputs.
    pub outputs: DMatrix<f64>,
}

/// Stationary Kalman filter of a linear system.
#[derive(Clone, Debug, PartialEq)]
pub struct Kalman {
    /// Gain `L` of the Kalman filter `x̂˙ = A x̂ + B u + L (y − C x̂ − D u)`, or of the prediction `x̂⁺` of a
    /// discrete filter.
    pub gain: DMatrix<f64>,
    /// Correction gain `K` of a discrete Kalman filter, with `L = A K`; equal to `gain` for a continuous
    /// filter.
    pub correction: DMatrix<f64>,
    /// Covariance of the estimation error of the Kalman filter (for a discrete filter before the correction).
    pub covariance: DMatrix<f64>,
    /// Poles of the Kalman filter: the eigenvalues of `A − L C`.
    pub poles: Vec<nalgebra::Complex<f64>>,
}

impl StateSpace {
    /// Computes the linear–quadratic regulator `u = −K x`, which minimises `∫ xᵀQx + 2xᵀNu + uᵀRu dt`, or the
    /// corresponding sum for a discrete system.
    ///
    /// ```
    /// use linkwork_design::{StateSpace, matrices::Cost};
    /// use nalgebra::{DMatrix, dmatrix};
    ///
    /// // A mass under a force: K = (1, √3) for unit weights.
    /// let mass = StateSpace::new(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0])?;
    /// let best = mass.lqr(&Cost::diagonal(&[1.0, 1.0], &[1.0]))?;
    /// assert!((best.gain[(0, 1)] - 3.0_f64.sqrt()).abs() < 1e-14);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`riccati`].
    pub fn lqr(&self, cost: &Cost) -> Result<Riccati, Error> {
        match self.period {
            Some(_) => discrete_riccati(&self.a, &self.b, cost),
            None => riccati(&self.a, &self.b, cost),
        }
    }

    /// Computes the linear–quadratic regulator for inputs with a zero-order hold of `period` seconds. The
    /// cost is that of the continuous motion, including the motion between sampling instants (Van Loan,
    /// *Computing integrals involving the matrix exponential*, 1978).
    ///
    /// # Errors
    ///
    /// As for [`riccati`], [`Error::Period`], [`Error::Time`] for a discrete system.
    pub fn lqr_held(&self, cost: &Cost, period: f64) -> Result<Riccati, Error> {
        let held = self.discretize(period, Hold::Zero)?;
        let (n, m) = self.b.shape();
        let k = n + m;
        crate::matrices::check_matrix("Q", &cost.q, n, n)?;
        crate::matrices::check_matrix("R", &cost.r, m, m)?;
        crate::matrices::check_matrix("N", &cost.n, n, m)?;
        // exp([−Fᵀ W; 0 F] h) = [·, F₃⁻ᵀ ∫; 0 F₃], where F is the matrix of state and input.
        let mut f = DMatrix::zeros(k, k);
        f.view_mut((0, 0), (n, n)).copy_from(&self.a);
        f.view_mut((0, n), (n, m)).copy_from(&self.b);
        let mut w = DMatrix::zeros(k, k);
        w.view_mut((0, 0), (n, n)).copy_from(&cost.q);
        w.view_mut((0, n), (n, m)).copy_from(&cost.n);
        w.view_mut((n, 0), (m, n)).copy_from(&cost.n.transpose());
        w.view_mut((n, n), (m, m)).copy_from(&cost.r);
        let mut all = DMatrix::zeros(2 * k, 2 * k);
        all.view_mut((0, 0), (k, k)).copy_from(&(f.transpose() * -period));
        all.view_mut((0, k), (k, k)).copy_from(&(w * period));
        all.view_mut((k, k), (k, k)).copy_from(&(f * period));
        let e = crate::matrices::exponential(&all)?;
        let sum = e.view((k, k), (k, k)).transpose() * e.view((0, k), (k, k));
        let sum = crate::matrices::symmetric_part(&sum);
        let cost = Cost {
            q: sum.view((0, 0), (n, n)).into_owned(),
            r: sum.view((n, n), (m, m)).into_owned(),
            n: sum.view((0, n), (n, m)).into_owned(),
        };
        held.lqr(&cost)
    }

    /// Computes the stationary Kalman filter of the system for these noise covariances.
    ///
    /// # Errors
    ///
    /// As for [`riccati`] of the dual system: [`Error::Undetectable`] with a mode that no output shows,
    /// [`Error::Shape`] with the name of a noise covariance of another shape.
    pub fn kalman(&self, noise: &Noise) -> Result<Kalman, Error> {
        let (n, p) = (self.order(), self.outputs.len());
        crate::matrices::check_matrix("the states' noise", &noise.states, n, n)?;
        crate::matrices::check_matrix("the outputs' noise", &noise.outputs, p, p)?;
        let cost = Cost::new(noise.states.clone(), noise.outputs.clone());
        let dual = self.dual().lqr(&cost).map_err(|error| match error {
            Error::Unstabilizable { mode } => Error::Undetectable { mode },
            Error::Undetectable { mode } => Error::Unstabilizable { mode },
            Error::Indefinite { matrix: "R" } => Error::Indefinite { matrix: "the outputs' noise" },
            Error::Indefinite { matrix: "Q" } => Error::Indefinite { matrix: "the states' noise" },
            Error::Singular { what: "R" } => Error::Singular { what: "the outputs' noise" },
            other => other,
        })?;
        let gain = dual.gain.transpose();
        let correction = match self.period {
            None => gain.clone(),
            Some(_) => {
                let seen = &self.c * &dual.x;
                let spread = &seen * self.c.transpose() + &noise.outputs;
                crate::matrices::solve_linear_system("the outputs' noise", &spread, &seen)?.transpose()
            }
        };
        Ok(Kalman { gain, correction, covariance: dual.x, poles: dual.poles })
    }

    /// Returns the controller that combines a regulator and an estimator, with the inverted sign that
    /// [negative feedback](Self::feedback) requires: it maps the measurements `y` to `K x̂`, so that
    /// `u = −K x̂`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for gains of another shape.
    pub fn compensator(&self, gain: &DMatrix<f64>, estimator: &DMatrix<f64>) -> Result<Self, Error> {
        let (n, m, p) = (self.order(), self.inputs.len(), self.outputs.len());
        crate::matrices::check_matrix("the regulator's gain", gain, m, n)?;
        crate::matrices::check_matrix("the estimator's gain", estimator, n, p)?;
        let a = &self.a - &self.b * gain - estimator * &self.c + estimator * &self.d * gain;
        Ok(Self {
            a,
            b: estimator.clone(),
            c: gain.clone(),
            d: DMatrix::zeros(m, p),
            states: self.states.clone(),
            inputs: self.outputs.clone(),
            outputs: self.inputs.clone(),
            period: self.period,
        })
    }
}
