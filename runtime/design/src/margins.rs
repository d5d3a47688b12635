//! Stability margins of a feedback loop: gain margins, phase margins and the distance from −1.

use crate::frequency::{FrequencyMap, ResponseSample, stability_boundary_point};
use crate::loop_polynomials::LoopPolynomials;
use crate::matrices::C;
use crate::norms::GainExtremum;
use crate::{Error, PeakGain, StateSpace, TransferFunction};

/// Frequency at which a loop's response is real and negative, with the gain factor that brings the loop to
/// the stability boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainMargin {
    /// Gain factor that brings the loop to the stability boundary; values below one are reductions.
    pub factor: f64,
    /// Frequency of the gain margin, rad/s.
    pub frequency: f64,
}

impl GainMargin {
    /// Returns the gain factor in decibels.
    pub fn decibels(&self) -> f64 {
        20.0 * self.factor.log10()
    }
}

/// Phase margin: frequency at which the loop's magnitude is one, and phase lag that brings the loop to the
/// stability boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseMargin {
    /// Phase lag in degrees, within ±180; negative values are phase leads.
    pub degrees: f64,
    /// Frequency of the phase margin, rad/s.
    pub frequency: f64,
}

impl PhaseMargin {
    /// Returns the delay that brings the loop to the stability boundary, s. For a negative margin, 360° are
    /// added first.
    pub fn delay(&self) -> f64 {
        self.degrees.rem_euclid(360.0).to_radians() / self.frequency
    }
}

/// Minimum distance of a loop's response from −1, called the modulus or stability margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityMargin {
    /// Distance of the response from −1: the reciprocal of the peak of the sensitivity.
    pub distance: f64,
    /// Frequency of the minimum distance, rad/s; infinite if the distance is the limit for high frequencies.
    pub frequency: f64,
}

/// All stability margins of a loop under negative feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct Margins {
    /// Gain margins at all frequencies where the phase crosses 180°, in ascending order of frequency. The
    /// frequency zero and the Nyquist frequency are included if the response is real and negative there. A
    /// response that is real at all frequencies, such as that of `1 / s²`, has no crossings.
    pub gain: Vec<GainMargin>,
    /// Phase margins at all frequencies where the magnitude crosses one, in ascending order of frequency. A
    /// magnitude that is one at all frequencies, as for an all-pass, or that is tangent to one has no
    /// crossings.
    pub phase: Vec<PhaseMargin>,
    /// Minimum distance of the open-loop response from −1.
    pub stability: StabilityMargin,
}

impl Margins {
    /// Returns the gain margin whose factor is nearest to one.
    pub fn nearest_gain(&self) -> Option<GainMargin> {
        self.gain.iter().copied().min_by(|a, b| a.factor.ln().abs().total_cmp(&b.factor.ln().abs()))
    }

    /// Returns the gain margin with the smallest factor above one.
    pub fn gain_increase(&self) -> Option<GainMargin> {
        self.gain.iter().copied().filter(|m| m.factor > 1.0).min_by(|a, b| a.factor.total_cmp(&b.factor))
    }

    /// Returns the gain margin with the largest factor below one.
    pub fn gain_reduction(&self) -> Option<GainMargin> {
        self.gain.iter().copied().filter(|m| m.factor < 1.0).max_by(|a, b| a.factor.total_cmp(&b.factor))
    }

    /// Returns the phase margin whose lag is nearest to zero.
    pub fn nearest_phase(&self) -> Option<PhaseMargin> {
        self.phase.iter().copied().min_by(|a, b| a.degrees.abs().total_cmp(&b.degrees.abs()))
    }

    /// Returns the smallest delay that leads to the stability boundary, s.
    pub fn delay(&self) -> Option<f64> {
        self.phase.iter().map(PhaseMargin::delay).min_by(f64::total_cmp)
    }
}

/// Finds a sign change of the function `f` between `low` and `high` by bisection, accelerated by secant steps
/// (Dekker, 1969).
pub(crate) fn root_between(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut at_low, mut at_high) = (f(low), f(high));
    if at_low == 0.0 || at_high == 0.0 {
        return if at_low == 0.0 { low } else { high };
    }
    for k in 0..200 {
        let secant = high - at_high * (high - low) / (at_high - at_low);
        let middle = 0.5 * (low + high);
        let inside = secant > low.min(high) && secant < low.max(high);
        let next = if inside && k % 3 != 2 { secant } else { middle };
        if !(next > low.min(high) && next < low.max(high)) {
            break;
        }
        let at_next = f(next);
        if at_next == 0.0 {
            return next;
        }
        if (at_next > 0.0) == (at_low > 0.0) {
            (low, at_low) = (next, at_next);
        } else {
            (high, at_high) = (next, at_next);
        }
    }
    if at_low.abs() < at_high.abs() { low } else { high }
}

/// Maximum relative rounding error of a response value that counts as reliable.
pub(crate) const CERTAIN: f64 = 0.05;

/// Open loop whose stability margins are computed, with its sampling period.
struct OpenLoop {
    map: FrequencyMap,
    period: Option<f64>,
}

impl OpenLoop {
    /// Returns the response of the loop and its derivative with respect to frequency; `None` at a pole.
    fn sample_response(&self, frequency: f64) -> Option<ResponseSample> {
        let s = stability_boundary_point(self.period, frequency);
        let turn = self.period.map_or(C::new(0.0, 1.0), |h| C::new(0.0, h) * s);
        self.map.sample_channel(s).ok().map(|sample| ResponseSample { slope: sample.slope * turn, ..sample })
    }

    /// Returns the frequencies where the function `f` of the response changes its sign between neighbours of
    /// the grid. Points at which rounding decides the sign are skipped.
    fn sign_change_frequencies(
        &self,
        grid: &[f64],
        samples: &[ResponseSample],
        f: impl Fn(C) -> f64,
    ) -> Vec<f64> {
        let margin_function_at_frequency =
            |w: f64| self.sample_response(w).map_or(f64::NAN, |sample| f(sample.value));
        let mut found = Vec::new();
        let mut before: Option<(f64, f64)> = None;
        for (w, sample) in grid.iter().zip(samples) {
            let here = f(sample.value);
            if here.is_nan() || here.abs() <= sample.error {
                continue;
            }
            if let Some((last, _)) = before.filter(|(_, there)| there * here < 0.0) {
                found.push(root_between(margin_function_at_frequency, last, *w));
            }
            before = Some((*w, here));
        }
        found
    }
}

impl StateSpace {
    /// Computes the stability margins of this system as the open loop of a negative feedback: all crossings,
    /// and the minimum distance from −1.
    ///
    /// ```
    /// use linkwork_design::TransferFunction;
    ///
    /// let open = TransferFunction::new([1.0], [1.0, 2.0, 3.0, 4.0])?.state_space()?;
    /// let margins = open.margins()?;
    /// let gain = margins.nearest_gain().unwrap();
    /// assert!((gain.factor - 2.0).abs() < 1e-12 && (gain.frequency - 3.0_f64.sqrt()).abs() < 1e-12);
    /// assert!(margins.phase.is_empty());
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Count`] unless the system has one input and one output, [`Error::NotConverged`].
    pub fn margins(&self) -> Result<Margins, Error> {
        self.check_single_input_and_output()?;
        let open = OpenLoop { map: self.frequency_map()?, period: self.period };
        let (grid, samples): (Vec<f64>, Vec<ResponseSample>) = self
            .margin_separating_frequencies()?
            .into_iter()
            .filter_map(|w| Some((w, open.sample_response(w)?)))
            .unzip();
        let gain_margin_at_crossing = |frequency: f64| {
            let ResponseSample { value, error, .. } = open.sample_response(frequency)?;
            // The sign also changes at a pole or zero on the stability boundary, where the value is
            // rounding error.
            let is_certain = error <= CERTAIN * value.norm();
            let is_negative = value.re < 0.0 && value.im.abs() <= 1e-6 * value.norm();
            (is_certain && is_negative).then_some(GainMargin { factor: -1.0 / value.re, frequency })
        };
        let ends = [0.0, self.upper_frequency_limit()];
        let crossings = open.sign_change_frequencies(&grid, &samples, |x| x.im);
        let all = ends[..1].iter().chain(&crossings).chain(&ends[1..]);
        let gain = all.filter(|w| w.is_finite()).filter_map(|w| gain_margin_at_crossing(*w)).collect();
        let phase = open.sign_change_frequencies(&grid, &samples, |x| x.norm() - 1.0).into_iter();
        let phase = phase.filter_map(|frequency| {
            let degrees = (-open.sample_response(frequency)?.value).arg().to_degrees();
            Some(PhaseMargin { degrees, frequency })
        });
        Ok(Margins { gain, phase: phase.collect(), stability: self.stability_margin(&open)? })
    }

    /// Returns frequencies, in ascending order, that separate all frequencies at which the open-loop response
    /// is real or has magnitude one.
    fn margin_separating_frequencies(&self) -> Result<Vec<f64>, Error> {
        let mut points = self.pole_and_zero_frequencies()?;
        points.extend(self.frequencies_at_gain_level(1.0)?);
        points.extend(self.candidate_real_response_frequencies()?);
        points.extend(self.crossing_frequencies_of_factors());
        points.sort_by(f64::total_cmp);
        points.dedup_by(|a, b| *a - *b <= 1e-12 * *b);
        let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
            return Ok(Vec::new());
        };
        let top = self.upper_frequency_limit();
        points.insert(0, 0.01 * first);
        points.push(if top.is_finite() { top } else { 100.0 * last });
        let between = points.windows(2).flat_map(|pair| {
            let (low, high) = (pair[0], pair[1]);
            let middle = (low * high).sqrt();
            if high > 8.0 * low { vec![2.0 * low, middle, 0.5 * high] } else { vec![middle] }
        });
        Ok(between.collect())
    }

    /// Returns the frequencies of the crossings that follow from zeros, poles and gain. The eigenvalues of a
    /// pencil miss some if crossings are decades apart.
    fn crossing_frequencies_of_factors(&self) -> Vec<f64> {
        let factors = self.zeros_poles_gain();
        let found =
            factors.and_then(|factors| Ok(LoopPolynomials::from_factors(&factors)?.crossing_frequencies()));
        let mut found = found.unwrap_or_default();
        found.retain(|w| *w > 0.0 && *w < self.upper_frequency_limit());
        found
    }

    /// Computes the minimum distance of the response from −1, which is the minimum gain of `1 + G`.
    fn stability_margin(&self, open: &OpenLoop) -> Result<StabilityMargin, Error> {
        let mut shifted = self.clone();
        shifted.d[(0, 0)] += 1.0;
        let PeakGain { gain, frequency } = shifted.extreme_gain(GainExtremum::Least)?;
        // Near its minimum, the distance determines the frequency to half of the digits only. The sign
        // change of its derivative is more accurate.
        let distance_to_critical_point =
            |w: f64| open.sample_response(w).map_or(f64::INFINITY, |x| (x.value + 1.0).norm());
        let slope_of_squared_distance =
            |w: f64| open.sample_response(w).map_or(f64::NAN, |x| (x.slope * (x.value + 1.0).conj()).re);
        let reach = [1e-8, 1e-7, 1e-6, 1e-5].map(|part| part * frequency);
        let sharper = reach.into_iter().find_map(|reach| {
            let (low, high) = (frequency - reach, frequency + reach);
            (slope_of_squared_distance(low) < 0.0 && slope_of_squared_distance(high) > 0.0)
                .then(|| root_between(slope_of_squared_distance, low, high))
        });
        let better = sharper.filter(|w| distance_to_critical_point(*w) <= gain * (1.0 + 1e-12));
        Ok(better.map_or(StabilityMargin { distance: gain, frequency }, |frequency| StabilityMargin {
            distance: distance_to_critical_point(frequency),
            frequency,
        }))
    }
}

impl TransferFunction {
    /// Computes the stability margins of this transfer function as the open loop of a negative feedback, with
    /// 32 digits from its coefficients.
    ///
    /// # Errors
    ///
    /// [`Error::Improper`], [`Error::NotFinite`] if the squares of the coefficients overflow.
    pub fn margins(&self) -> Result<Margins, Error> {
        self.check_proper()?;
        Ok(LoopPolynomials::new(self)?.margins())
    }
}
