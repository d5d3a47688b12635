//! Modes of linear systems: eigenvalues, mode shapes, participation factors and damping.

use crate::matrices::{C, CMatrix, Schur, balance_matrix, to_complex_matrix};
use crate::{Error, Signal, StateSpace};
use std::f64::consts::{LN_2, TAU};
use std::fmt;

/// Condition number `1 / |wᴴ v|` of an eigenvalue above which its left and right eigenvectors count as
/// orthogonal, so that the eigenvalue is defective.
const DEFECTIVE: f64 = 1e7;

/// Mode of a system: a real pole, or a conjugate pair of poles.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Eigenvalue of `A`, with positive imaginary part for a pair: 1/s, or dimensionless for a discrete
    /// system.
    pub pole: C,
    /// Eigenvalue of the mode in continuous time, 1/s; `ln(z) / h` for a discrete system.
    pub exponent: C,
    /// Mode shape: the component of each state in the eigenvector, normalised to unit length with a real
    /// largest entry. Only components with the same unit are comparable.
    pub shape: Vec<C>,
    /// Participation factor of each state in the mode, dimensionless: the magnitudes of `wₖ vₖ` of the left
    /// and right eigenvectors, normalised to a sum of one (Pérez-Arriaga, Verghese and Schweppe, *Selective
    /// modal analysis*, 1982).
    pub participation: Vec<f64>,
    /// Condition number of the eigenvalue, `1 / |wᴴ v|` of the unit left and right eigenvectors in balanced
    /// units: one for a symmetric matrix, infinite for a defective one.
    pub condition: f64,
    states: Vec<Signal>,
}

impl Mode {
    /// Returns the natural frequency `|s|` of the mode, rad/s.
    pub fn frequency(&self) -> f64 {
        self.exponent.norm()
    }

    /// Returns the frequency of the oscillation, `Im s`, rad/s; zero for a real pole.
    pub fn damped_frequency(&self) -> f64 {
        self.exponent.im
    }

    /// Returns the damping ratio of the mode, `−Re s / |s|`: one for a stable real pole, negative for a
    /// growing mode, one for a zero pole.
    pub fn damping_ratio(&self) -> f64 {
        let size = self.exponent.norm();
        if size == 0.0 { 1.0 } else { -self.exponent.re / size }
    }

    /// Returns the period of the oscillation, s; `None` for a real pole.
    pub fn period(&self) -> Option<f64> {
        (self.exponent.im != 0.0).then(|| TAU / self.exponent.im)
    }

    /// Returns the time constant `1 / |Re s|`, s; infinite on the stability boundary.
    pub fn time_constant(&self) -> f64 {
        1.0 / self.exponent.re.abs()
    }

    /// Returns the time in which the mode halves, s; `None` unless the mode decays.
    pub fn time_to_half(&self) -> Option<f64> {
        (self.exponent.re < 0.0).then(|| -LN_2 / self.exponent.re)
    }

    /// Returns the time in which the mode doubles, s; `None` unless the mode grows.
    pub fn time_to_double(&self) -> Option<f64> {
        (self.exponent.re > 0.0).then(|| LN_2 / self.exponent.re)
    }

    /// Returns the number of cycles in which the mode halves; `None` for a real pole and for a mode that does
    /// not decay.
    pub fn cycles_to_half(&self) -> Option<f64> {
        Some(self.time_to_half()? / self.period()?)
    }

    /// Returns whether the mode is stable: its eigenvalue in continuous time has a negative real part.
    pub fn is_stable(&self) -> bool {
        self.exponent.re < 0.0
    }

    /// Returns whether the eigenvalue is defective: the motion has terms `t eˢᵗ`. Mode shape and
    /// participation factors then belong to one of several coinciding eigenvectors.
    pub fn is_defective(&self) -> bool {
        self.condition > DEFECTIVE
    }

    /// Returns the states with their participation factors, in descending order.
    pub fn participants(&self) -> Vec<(&str, f64)> {
        let names = self.states.iter().map(|s| s.name.as_str());
        let mut all: Vec<_> = names.zip(self.participation.iter().copied()).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }

    /// Returns the index of a state by name; zero for an unknown name.
    pub(crate) fn state_index_or_zero(&self, state: &str) -> usize {
        self.states.iter().position(|s| s.name == state).unwrap_or(0)
    }

    /// Returns the unit of a state; `None` if it has no unit.
    pub(crate) fn unit_of_state(&self, state: &str) -> Option<&str> {
        let found = self.states.iter().find(|s| s.name == state)?;
        Some(found.unit.as_str()).filter(|unit| !unit.is_empty())
    }

    /// Returns the participation factor of a named state in the mode, between zero and one; `None` for an
    /// unknown name.
    pub fn participation_of(&self, state: &str) -> Option<f64> {
        let k = self.states.iter().position(|s| s.name == state)?;
        self.participation.get(k).copied()
    }

    /// Returns the component of the mode shape for a state; `None` for an unknown name.
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
        let format_participation = |(name, part): &(&str, f64)| format!("{name} {:.0} %", 100.0 * part);
        let parts: Vec<_> = self.participants().iter().take(3).map(format_participation).collect();
        write!(f, ": {}", parts.join(", "))
    }
}

impl StateSpace {
    /// Computes the modes of the system, in ascending order of natural frequency. A conjugate pair is one
    /// mode.
    ///
    /// ```
    /// use linkwork_design::StateSpace;
    /// use nalgebra::{DMatrix, dmatrix};
    ///
    /// let system = StateSpace::new(dmatrix![0.0, 1.0; -4.0, -0.4], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0])?
    ///     .with_states(["position", "velocity"])?;
    /// let modes = system.modes()?;
    /// assert!((modes[0].frequency() - 2.0).abs() < 1e-14 && (modes[0].damping_ratio() - 0.1).abs() < 1e-14);
    /// // Position and velocity participate equally in the oscillation.
    /// assert!((modes[0].participation_of("position").unwrap() - 0.5).abs() < 1e-14);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] if the QR algorithm does not converge.
    pub fn modes(&self) -> Result<Vec<Mode>, Error> {
        let (a, d) = balance_matrix(&self.a);
        let schur = Schur::new(&to_complex_matrix(&a))?;
        let n = self.order();
        let mut taken = vec![false; n];
        let mut modes = Vec::new();
        for pole in self.poles()?.into_iter().filter(|p| p.im >= 0.0) {
            let distance_to_pole = |k: &usize| (schur.t[(*k, *k)] - pole).norm();
            let nearest = (0..n)
                .filter(|k| !taken[*k])
                .min_by(|i, j| distance_to_pole(i).total_cmp(&distance_to_pole(j)));
            let Some(k) = nearest else { break };
            taken[k] = true;
            if pole.im > 0.0 {
                let distance_to_conjugate_pole = |k: &usize| (schur.t[(*k, *k)] - pole.conj()).norm();
                let pair = (0..n)
                    .filter(|k| !taken[*k])
                    .min_by(|i, j| distance_to_conjugate_pole(i).total_cmp(&distance_to_conjugate_pole(j)));
                pair.into_iter().for_each(|k| taken[k] = true);
            }
            modes.push(self.mode_of_pole(pole, &schur.right_eigenvector(k), &schur.left_eigenvector(k), &d));
        }
        modes.sort_by(|a, b| a.frequency().total_cmp(&b.frequency()));
        Ok(modes)
    }

    fn mode_of_pole(&self, pole: C, right: &CMatrix, left: &CMatrix, d: &[f64]) -> Mode {
        let product: C = left.iter().zip(right.iter()).map(|(w, v)| w.conj() * v).sum();
        // The balancing scales cancel in each product.
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
