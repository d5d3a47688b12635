//! H₂ and H∞ norms of linear systems.

use crate::frequency::{FrequencyMap, stability_boundary_point};
use crate::matrices::to_complex_matrix;
use crate::{Error, StateSpace};

/// Peak gain: maximum gain of a system over all frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakGain {
    /// Largest singular value of the response at the peak.
    pub gain: f64,
    /// Frequency of the peak gain, rad/s; infinite if the gain is the limit for high frequencies.
    pub frequency: f64,
}

impl StateSpace {
    /// Computes the H₂ norm of a stable system: the root mean square of the outputs under white noise of unit
    /// intensity. By Parseval's theorem it is the norm of the impulse response.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] with an unstable pole; [`Error::Infinite`] for a continuous system with nonzero
    /// `D`.
    pub fn h2_norm(&self) -> Result<f64, Error> {
        let w = self.controllability_gramian()?;
        let direct = self.d.norm_squared();
        if self.period.is_none() && direct > 0.0 {
            return Err(Error::Infinite { what: "the H₂ norm, with direct feedthrough," });
        }
        let square = (&self.c * w * self.c.transpose()).trace();
        Ok((square.max(0.0) + if self.period.is_some() { direct } else { 0.0 }).sqrt())
    }

    /// Computes the H∞ norm of a stable system and the frequency of the peak. The algorithm iterates on the
    /// frequencies at which a singular value has a given level; they are eigenvalues, on the stability
    /// boundary, of a pencil (Bruinsma and Steinbuch, *A fast algorithm to compute the H∞-norm of a transfer
    /// function matrix*, 1990).
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] with an unstable pole; [`Error::NotConverged`].
    pub fn peak_gain(&self) -> Result<PeakGain, Error> {
        self.check_stable()?;
        self.extreme_gain(GainExtremum::Largest)
    }

    /// Computes the maximum or minimum, over all real frequencies, of the largest singular value of a system,
    /// which may be unstable.
    pub(crate) fn extreme_gain(&self, extreme: GainExtremum) -> Result<PeakGain, Error> {
        let map = self.frequency_map()?;
        let gain_at_frequency = |w: f64| {
            let response = if w.is_finite() { map.response(w) } else { Ok(to_complex_matrix(&self.d)) };
            match response {
                Ok(m) if m.is_empty() => 0.0,
                // At a pole that a zero cancels, the value is rounding error and must not count as the
                // minimum.
                Ok(_)
                    if w.is_finite()
                        && extreme == GainExtremum::Least
                        && !self.is_rounding_error_negligible(&map, w) =>
                {
                    f64::INFINITY
                }
                Ok(m) => m.svd_unordered(false, false).singular_values.max(),
                Err(_) => f64::INFINITY,
            }
        };
        let top = self.upper_frequency_limit();
        let mut best = PeakGain { gain: gain_at_frequency(top), frequency: top };
        let mut improve_extreme_gain = |frequencies: &mut dyn Iterator<Item = f64>| {
            let before = best.gain;
            for w in frequencies {
                let gain = gain_at_frequency(w);
                // Smaller differences are rounding errors.
                if extreme.is_more_extreme(gain, extreme.level_beyond_gain(best.gain, 1e-14)) {
                    best = PeakGain { gain, frequency: w };
                }
            }
            (before, best)
        };
        let (_, mut found) =
            improve_extreme_gain(&mut self.pole_and_zero_frequencies()?.into_iter().chain([0.0]));
        // Levels near the gain of high frequencies are also crossed at very high frequencies; hence coarse
        // steps first.
        for step in [1e-3, 1e-6, 1e-9, 1e-12] {
            for _ in 0..60 {
                let level = extreme.level_beyond_gain(found.gain, step);
                if !(level > 0.0 && level.is_finite()) {
                    return Ok(found);
                }
                let crossings = self.frequencies_at_gain_level(level)?;
                let between = crossings.windows(2).flat_map(|pair| {
                    let (low, high) = (pair[0], pair[1]);
                    [(low * high).sqrt(), 0.5 * (low + high)]
                });
                // The first interval begins at zero frequency, the last one is unbounded.
                let ends = [crossings.first().map(|w| 0.1 * w), crossings.last().map(|w| 10.0 * w)];
                let ends = ends.into_iter().flatten().filter(|w| *w < top);
                let (before, now) =
                    improve_extreme_gain(&mut between.chain(ends).chain(crossings.iter().copied()));
                found = now;
                if !extreme.is_more_extreme(now.gain, extreme.level_beyond_gain(before, step)) {
                    break;
                }
            }
        }
        Ok(found)
    }

    /// Returns whether rounding changes the response of a single channel by less than a thousandth.
    fn is_rounding_error_negligible(&self, map: &FrequencyMap, frequency: f64) -> bool {
        map.sample_channel(stability_boundary_point(self.period, frequency))
            .is_ok_and(|sample| sample.error < 1e-3)
    }
}

/// Kind of extremum of the gain to search for: minima are supported for single channels only.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum GainExtremum {
    Largest,
    Least,
}

impl GainExtremum {
    fn is_more_extreme(self, one: f64, other: f64) -> bool {
        match self {
            Self::Largest => one > other,
            Self::Least => one < other,
        }
    }

    /// Returns a level that is beyond a gain by a fraction of it: above it for a maximum, below it for a
    /// minimum.
    fn level_beyond_gain(self, gain: f64, part: f64) -> f64 {
        match self {
            Self::Largest => gain * (1.0 + part),
            Self::Least => gain * (1.0 - part),
        }
    }
}
