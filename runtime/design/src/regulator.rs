//! Regulators and estimators.

use crate::matrices::{Cost, Riccati, discrete_riccati, riccati};
use crate::{Error, Hold, StateSpace};
use nalgebra::DMatrix;

/// The noise of a system: covariances (intensities of a continuous one) of what disturbs the states, and of
/// the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Of the states, `G W Gᵀ`.
    pub states: DMatrix<f64>,
    /// Of the outputs.
    pub outputs: DMatrix<f64>,
}

/// The gain of a stationary Kalman filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Kalman {
    /// `L` of `x̂˙ = A x̂ + B u + L (y − C x̂ − D u)`; of a discrete filter, of its prediction `x̂⁺`.
    pub gain: DMatrix<f64>,
    /// Of a discrete filter `L = A K` with this gain `K` of its correction; of a continuous one the same as
    /// `gain`.
    pub correction: DMatrix<f64>,
    /// The covariance of the estimate's error (of a discrete filter before its correction).
    pub covariance: DMatrix<f64>,
    /// The eigenvalues of `A − L C`.
    pub poles: Vec<nalgebra::Complex<f64>>,
}

impl StateSpace {
    /// The linear–quadratic regulator `u = −K x` of all states: least `∫ xᵀQx + 2xᵀNu + uᵀRu dt`, or a sum of
    /// a discrete system.
    ///
    /// ```
    /// use linkwork_design::{StateSpace, matrices::Cost};
    /// use nalgebra::{DMatrix, dmatrix};
    ///
    /// // A mass that is pushed: K = (1, √3) for weights of one.
    /// let mass = StateSpace::new(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0])?;
    /// let best = mass.lqr(&Cost::diagonal(&[1.0, 1.0], &[1.0]))?;
    /// assert!((best.gain[(0, 1)] - 3.0_f64.sqrt()).abs() < 1e-14);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`riccati`].
    pub fn lqr(&self, cost: &Cost) -> Result<Riccati, Error> {
        match self.period {
            Some(_) => discrete_riccati(&self.a, &self.b, cost),
            None => riccati(&self.a, &self.b, cost),
        }
    }

    /// The regulator for inputs that are held over `period` seconds, with the cost of the continuous motion
    /// in between (Van Loan, *Computing integrals involving the matrix exponential*, 1978).
    ///
    /// # Errors
    ///
    /// Those of [`riccati`], [`Error::Period`], [`Error::Time`] of a discrete system.
    pub fn lqr_held(&self, cost: &Cost, period: f64) -> Result<Riccati, Error> {
        let held = self.discretize(period, Hold::Zero)?;
        let (n, m) = self.b.shape();
        let k = n + m;
        crate::matrices::check("Q", &cost.q, n, n)?;
        crate::matrices::check("R", &cost.r, m, m)?;
        crate::matrices::check("N", &cost.n, n, m)?;
        // exp([−Fᵀ W; 0 F] h) = [·, F₃⁻ᵀ ∫; 0 F₃] with F of state and input.
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
        let sum = crate::matrices::symmetric(&sum);
        let cost = Cost {
            q: sum.view((0, 0), (n, n)).into_owned(),
            r: sum.view((n, n), (m, m)).into_owned(),
            n: sum.view((0, n), (n, m)).into_owned(),
        };
        held.lqr(&cost)
    }

    /// The stationary Kalman filter.
    ///
    /// # Errors
    ///
    /// Those of [`riccati`], of the dual system: [`Error::Undetectable`] names a mode that no output shows,
    /// [`Error::Shape`] the noise that does not fit.
    pub fn kalman(&self, noise: &Noise) -> Result<Kalman, Error> {
        let (n, p) = (self.order(), self.outputs.len());
        crate::matrices::check("the states' noise", &noise.states, n, n)?;
        crate::matrices::check("the outputs' noise", &noise.outputs, p, p)?;
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
                crate::matrices::solve("the outputs' noise", &spread, &seen)?.transpose()
            }
        };
        Ok(Kalman { gain, correction, covariance: dual.x, poles: dual.poles })
    }

    /// The controller of a regulator and an estimator: from measurements `y` to inputs, `u = −K x̂`, for
    /// [negative feedback](Self::feedback) with its sign turned: from `y` to `K x̂`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] of gains that do not fit.
    pub fn compensator(&self, gain: &DMatrix<f64>, estimator: &DMatrix<f64>) -> Result<Self, Error> {
        let (n, m, p) = (self.order(), self.inputs.len(), self.outputs.len());
        crate::matrices::check("the regulator's gain", gain, m, n)?;
        crate::matrices::check("the estimator's gain", estimator, n, p)?;
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
