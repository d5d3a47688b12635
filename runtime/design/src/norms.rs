//! Norms of systems.

use crate::matrices::{C, eigenvalues, solve};
use crate::{Error, Hold, StateSpace};
use nalgebra::DMatrix;

/// The largest gain over all frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakGain {
    /// The largest singular value of the response.
    pub gain: f64,
    /// Where, rad/s; infinite where it is approached by high frequencies.
    pub frequency: f64,
}

impl StateSpace {
    /// The H₂ norm of a stable system: the root mean square of the outputs under white noise of unit intensity; by Parseval's
    /// theorem the norm of the impulse response.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] names a pole; [`Error::Infinite`] of a continuous system with a direct way.
    pub fn h2_norm(&self) -> Result<f64, Error> {
        let w = self.controllability_gramian()?;
        let direct = self.d.norm_squared();
        if self.period.is_none() && direct > 0.0 {
            return Err(Error::Infinite { what: "the H₂ norm, with a direct way from inputs to outputs," });
        }
        let square = (&self.c * w * self.c.transpose()).trace();
        Ok((square.max(0.0) + if self.period.is_some() { direct } else { 0.0 }).sqrt())
    }

    /// The H∞ norm of a stable system and where it is taken: by the imaginary eigenvalues of Hamiltonian matrices (Bruinsma and
    /// Steinbuch, *A fast algorithm to compute the H∞-norm of a transfer function matrix*, 1990). A discrete system is mapped by
    /// Tustin's rule, which keeps the norm.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] names a pole; [`Error::NotConverged`].
    pub fn peak_gain(&self) -> Result<PeakGain, Error> {
        self.check_stable()?;
        if let Some(h) = self.period {
            let PeakGain { gain, frequency } = self.undiscretize(Hold::Tustin)?.peak_gain()?;
            return Ok(PeakGain { gain, frequency: 2.0 / h * (0.5 * frequency * h).atan() });
        }
        self.largest_gain()
    }

    /// The largest gain at real frequencies of a continuous system, stable or not.
    pub(crate) fn largest_gain(&self) -> Result<PeakGain, Error> {
        let map = self.frequency_map()?;
        let gain = |w: f64| -> Result<f64, Error> {
            let m = map.response(w)?;
            Ok(if m.is_empty() { 0.0 } else { m.svd_unordered(false, false).singular_values.max() })
        };
        let direct = if self.d.is_empty() {
            0.0
        } else {
            self.d.clone().svd_unordered(false, false).singular_values.max()
        };
        let mut best = PeakGain { gain: direct, frequency: f64::INFINITY };
        let own = self.poles()?.into_iter().flat_map(|p: C| [p.norm(), p.im.abs()]);
        for w in own.chain([0.0]) {
            let gain = gain(w)?;
            if gain > best.gain {
                best = PeakGain { gain, frequency: w };
            }
        }
        for _ in 0..60 {
            let level = best.gain * (1.0 + 1e-12);
            if level == 0.0 {
                break;
            }
            // Where the level is nearly the peak, two eigenvalues that nearly coincide may lie beside the axis.
            let crossings = self.level_crossings(level, 1e-4)?;
            let mut higher = best;
            let between = crossings.windows(2).flat_map(|pair| {
                let w = (pair[0] * pair[1]).sqrt().max(0.5 * pair[0]);
                [w, 0.5 * (pair[0] + pair[1])]
            });
            for w in between.chain(crossings.iter().copied()) {
                let gain = gain(w)?;
                if gain > higher.gain {
                    higher = PeakGain { gain, frequency: w };
                }
            }
            if higher.gain <= best.gain * (1.0 + 1e-13) {
                break;
            }
            best = higher;
        }
        Ok(best)
    }

    /// Frequencies at which a singular value is `level`, from low to high: eigenvalues as near to the imaginary axis, beside their
    /// size, as is said.
    pub(crate) fn level_crossings(&self, level: f64, near: f64) -> Result<Vec<f64>, Error> {
        let (a, b, c, _) = crate::matrices::balance_system(&self.a, &self.b, &self.c);
        let (n, m) = b.shape();
        let d = &self.d;
        let r = DMatrix::identity(m, m) * (level * level) - d.transpose() * d;
        let inverse_b = solve("γ² − DᵀD", &r, &b.transpose())?;
        let inverse_dc = solve("γ² − DᵀD", &r, &(d.transpose() * &c))?;
        let f = &a + &b * &inverse_dc;
        let mut h = DMatrix::zeros(2 * n, 2 * n);
        h.view_mut((0, 0), (n, n)).copy_from(&f);
        h.view_mut((0, n), (n, n)).copy_from(&(&b * inverse_b * level));
        let lower = c.transpose() * &c + c.transpose() * d * inverse_dc;
        h.view_mut((n, 0), (n, n)).copy_from(&(lower * (-1.0 / level)));
        h.view_mut((n, n), (n, n)).copy_from(&-f.transpose());
        let size = a.norm();
        let near = |s: &C| s.re.abs() <= near * s.norm() + 1e-8 * size;
        let mut all: Vec<f64> =
            eigenvalues(&h)?.iter().filter(|s| near(s) && s.im >= 0.0).map(|s| s.im).collect();
        all.sort_by(f64::total_cmp);
        Ok(all)
    }
}
