//! Modes: how a system moves by itself.

use crate::matrices::{C, CMatrix, Schur, balanced, complex};
use crate::{Error, Signal, StateSpace};
use std::f64::consts::{LN_2, TAU};
use std::fmt;

/// Beyond this, eigenvectors of an eigenvalue are as good as parallel: `1 / |wᴴ v|`.
const DEFECTIVE: f64 = 1e7;

/// A mode: a real pole, or a pair of complex ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The eigenvalue, that with the positive imaginary part of a pair: 1/s, or of one period.
    pub pole: C,
    /// The eigenvalue in continuous time, 1/s; that of a discrete system is `ln(z) / h`.
    pub exponent: C,
    /// What each state has of the mode, of unit length, the largest entry real. Only directions of one unit
    /// compare.
    pub shape: Vec<C>,
    /// What each state takes part, without units: the magnitudes of `wₖ vₖ` of the left and right
    /// eigenvectors, in sum one (Pérez-Arriaga, Verghese and Schweppe, *Selective modal analysis*, 1982).
    pub participation: Vec<f64>,
    /// How much the eigenvalue changes with the matrix, `1 / |wᴴ v|` of unit vectors in balanced units: one
    /// of a symmetric matrix, infinite of a defective one.
    pub condition: f64,
    states: Vec<Signal>,
}

impl Mode {
    /// Natural frequency `|s|`, rad/s.
    pub fn frequency(&self) -> f64 {
        self.exponent.norm()
    }

    /// Frequency of the oscillation, `Im s`, rad/s; zero of a real pole.
    pub fn damped_frequency(&self) -> f64 {
        self.exponent.im
    }

    /// Damping ratio `−Re s / |s|`: one of a real stable pole, negative where the mode grows; one at rest.
    pub fn damping_ratio(&self) -> f64 {
        let size = self.exponent.norm();
        if size == 0.0 { 1.0 } else { -self.exponent.re / size }
    }

    /// Period of the oscillation, s; `None` of a real pole.
    pub fn period(&self) -> Option<f64> {
        (self.exponent.im != 0.0).then(|| TAU / self.exponent.im)
    }

    /// Time constant `1 / |Re s|`, s; infinite on the border of stability.
    pub fn time_constant(&self) -> f64 {
        1.0 / self.exponent.re.abs()
    }

    /// In which time the mode halves, s; `None` unless it decays.
    pub fn time_to_half(&self) -> Option<f64> {
        (self.exponent.re < 0.0).then(|| -LN_2 / self.exponent.re)
    }

    /// In which time the mode doubles, s; `None` unless it grows.
    pub fn time_to_double(&self) -> Option<f64> {
        (self.exponent.re > 0.0).then(|| LN_2 / self.exponent.re)
    }

    /// Cycles until the mode has halved; `None` of a real pole or one that does not decay.
    pub fn cycles_to_half(&self) -> Option<f64> {
        Some(self.time_to_half()? / self.period()?)
    }

    /// Whether the pole is stable.
    pub fn is_stable(&self) -> bool {
        self.exponent.re < 0.0
    }

    /// Whether eigenvectors are missing: the motion has terms `t eˢᵗ`, and shape and participation are those
    /// of one of several eigenvectors that coincide.
    pub fn is_defective(&self) -> bool {
        self.condition > DEFECTIVE
    }

    /// States by how much they take part, most first.
    pub fn participants(&self) -> Vec<(&str, f64)> {
        let names = self.states.iter().map(|s| s.name.as_str());
        let mut all: Vec<_> = names.zip(self.participation.iter().copied()).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }

    /// The place of a state; zero if there is none of this name.
    pub(crate) fn place_of(&self, state: &str) -> usize {
        self.states.iter().position(|s| s.name == state).unwrap_or(0)
    }

    /// The unit of a state, if one was said.
    pub(crate) fn unit_of(&self, state: &str) -> Option<&str> {
        let found = self.states.iter().find(|s| s.name == state)?;
        Some(found.unit.as_str()).filter(|unit| !unit.is_empty())
    }

    /// How much a state takes part, between zero and one; `None` if there is none of this name.
    pub fn participation_of(&self, state: &str) -> Option<f64> {
        let k = self.states.iter().position(|s| s.name == state)?;
        self.participation.get(k).copied()
    }

    /// What a state has of the mode; `None` if there is none of this name.
    pub fn shape_of(&self, state: &str) -> Option<C> {
        let k = self.states.iter().position(|s| s.name == state)?;
        self.shape.get(k).copied()
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = self.exponent;
        if s.im == 0.0 {
            write!(f, "{:.5} 1/s", s.re)?;
        } else {
            write!(
                f,
                "{:.5} ± {:.5}i 1/s, ω {:.4} rad/s, ζ {:.4}",
                s.re,
                s.im,
                self.frequency(),
                self.damping_ratio()
            )?;
        }
        if let Some(time) = self.time_to_half() {
            write!(f, ", halves in {time:.4} s")?;
        }
        if let Some(time) = self.time_to_double() {
            write!(f, ", doubles in {time:.4} s")?;
        }
        let part = |(name, part): &(&str, f64)| format!("{name} {:.0} %", 100.0 * part);
        let parts: Vec<_> = self.participants().iter().take(3).map(part).collect();
        write!(f, ": {}", parts.join(", "))
    }
}

impl StateSpace {
    /// The modes, slowest natural frequency first; conjugate pairs are one mode.
    ///
    /// ```
    /// use linkwork_design::StateSpace;
    /// use nalgebra::{DMatrix, dmatrix};
    ///
    /// let system = StateSpace::new(dmatrix![0.0, 1.0; -4.0, -0.4], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0])?
    ///     .with_states(["position", "velocity"])?;
    /// let modes = system.modes()?;
    /// assert!((modes[0].frequency() - 2.0).abs() < 1e-14 && (modes[0].damping_ratio() - 0.1).abs() < 1e-14);
    /// // Half of an oscillation is position, half is velocity.
    /// assert!((modes[0].participation_of("position").unwrap() - 0.5).abs() < 1e-14);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] if the QR algorithm does not settle.
    pub fn modes(&self) -> Result<Vec<Mode>, Error> {
        let (a, d) = balanced(&self.a);
        let schur = Schur::new(&complex(&a))?;
        let n = self.order();
        let mut taken = vec![false; n];
        let mut modes = Vec::new();
        for pole in self.poles()?.into_iter().filter(|p| p.im >= 0.0) {
            let distance = |k: &usize| (schur.t[(*k, *k)] - pole).norm();
            let nearest = (0..n).filter(|k| !taken[*k]).min_by(|i, j| distance(i).total_cmp(&distance(j)));
            let Some(k) = nearest else { break };
            taken[k] = true;
            if pole.im > 0.0 {
                let other = |k: &usize| (schur.t[(*k, *k)] - pole.conj()).norm();
                let pair = (0..n).filter(|k| !taken[*k]).min_by(|i, j| other(i).total_cmp(&other(j)));
                pair.into_iter().for_each(|k| taken[k] = true);
            }
            modes.push(self.mode(pole, &schur.right(k), &schur.left(k), &d));
        }
        modes.sort_by(|a, b| a.frequency().total_cmp(&b.frequency()));
        Ok(modes)
    }

    fn mode(&self, pole: C, right: &CMatrix, left: &CMatrix, d: &[f64]) -> Mode {
        let product: C = left.iter().zip(right.iter()).map(|(w, v)| w.conj() * v).sum();
        // The scales cancel in each product.
        let mut participation: Vec<f64> =
            left.iter().zip(right.iter()).map(|(w, v)| (w.conj() * v).norm()).collect();
        let sum: f64 = participation.iter().sum();
        if sum > 0.0 {
            participation.iter_mut().for_each(|p| *p /= sum);
        }
        let mut shape: Vec<C> = right.iter().zip(d).map(|(v, d)| v * *d).collect();
        let size = shape.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
        let largest = shape.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()));
        if let Some(turn) = largest.filter(|x| x.norm() > 0.0).map(|x| x.conj() / x.norm() / size) {
            shape.iter_mut().for_each(|x| *x *= turn);
        }
        if pole.im == 0.0 {
            shape.iter_mut().for_each(|x| x.im = 0.0);
        }
        Mode {
            pole,
            exponent: self.period.map_or(pole, |h| pole.ln() / h),
            shape,
            participation,
            condition: 1.0 / product.norm(),
            states: self.states.clone(),
        }
    }
}
