//! Characteristic values of a step response: rise time, settling time, overshoot and others.

use crate::frequency::stability_boundary_point;
use crate::matrices::solve_linear_system;
use crate::modal_sum::{FIRST_SAMPLES, ModalSum};
use crate::{Error, StateSpace, TransferFunction};
use nalgebra::DMatrix;

/// Characteristic values of the step response of a stable system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepFigures {
    /// Final value of the step response.
    pub final_value: f64,
    /// Rise time: time from the first crossing of the lower level to that of the upper level, s.
    pub rise_time: f64,
    /// Time after which the response stays within the band around the final value, s.
    pub settling_time: f64,
    /// Overshoot: largest excess over the final value, % of the final value.
    pub overshoot: f64,
    /// Undershoot: largest value of the opposite sign, % of the final value.
    pub undershoot: f64,
    /// Largest magnitude of the step response.
    pub peak: f64,
    /// Time of the largest magnitude, s; infinite if the response only approaches it.
    pub peak_time: f64,
    /// Minimum value of the step response after the rise.
    pub least_after_rise: f64,
    /// Largest value of the step response after the rise.
    pub largest_after_rise: f64,
}

/// Levels by which settling and rise times of a step response are defined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    /// Half width of the band around the final value, relative to it; 0.02 by default.
    pub settling: f64,
    /// Levels between which the response rises, relative to the final value; 0.1 and 0.9 by default.
    pub rise: (f64, f64),
}

impl Default for StepLimits {
    fn default() -> Self {
        Self { settling: 0.02, rise: (0.1, 0.9) }
    }
}

/// Deviation of a step response from its final value, relative to the final value, as a function of time or
/// of the sample index.
struct StepResponseDeviation {
    /// First samples of the deviation of a discrete system, which its modes do not describe.
    first: Vec<f64>,
    modes: ModalSum,
}

impl StepResponseDeviation {
    /// Returns the first instant at which the modes alone describe the deviation.
    fn first_instant_described_by_modes(&self) -> f64 {
        self.first.len() as f64
    }

    /// Returns the first instant at which the deviation of the step response reaches a negative level from
    /// below.
    fn first_above(&self, level: f64) -> Result<f64, Error> {
        match self.first.iter().position(|e| *e >= level) {
            Some(k) => Ok(k as f64),
            None => self.modes.first_above(level, self.first_instant_described_by_modes()),
        }
    }

    /// Returns the last instant at which the magnitude of the deviation of the step response exceeds a band.
    fn last_outside(&self, band: f64) -> Result<Option<f64>, Error> {
        let early = self.first.iter().rposition(|e| e.abs() > band).map(|k| k as f64);
        Ok(self.modes.last_outside(band, self.first_instant_described_by_modes())?.or(early))
    }

    /// Returns the instant and the value of the maximum (`sign` one) or minimum (`sign` −1) of the deviation
    /// of the step response after the time `from`. If the deviation only approaches zero, the result is zero
    /// at infinite time.
    fn extreme_deviation(&self, sign: f64, from: f64) -> Result<(f64, f64), Error> {
        let early = self.first.iter().enumerate().skip(from as usize).map(|(k, e)| (k as f64, *e));
        let early = early.reduce(|best, next| if sign * next.1 > sign * best.1 { next } else { best });
        let late = self.modes.extreme(sign, from.max(self.first_instant_described_by_modes()))?;
        let best = early.filter(|early| sign * early.1 >= sign * late.1).unwrap_or(late);
        let initial = self.first.get(from as usize).copied().unwrap_or_else(|| self.modes.value(from));
        Ok(if sign * best.1 > self.modes.noise {
            best
        } else if sign * initial >= -self.modes.noise {
            (from, 0.0)
        } else {
            (f64::INFINITY, 0.0)
        })
    }
}

impl StateSpace {
    /// Computes the characteristic values of the step response of a stable system with one input and one
    /// output. Crossings and peaks are those of the sum of its modes, which is bounded over intervals of time
    /// instead of sampled.
    ///
    /// ```
    /// use linkwork_design::TransferFunction;
    ///
    /// let all_pass = TransferFunction::new([-1.0, 1.0], [1.0, 1.0])?.state_space()?;
    /// let figures = all_pass.step_figures()?;
    /// assert!((figures.rise_time - 9.0_f64.ln()).abs() < 1e-12 && (figures.undershoot - 100.0).abs() < 1e-12);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] with an unstable pole, [`Error::Count`] unless the system has one input and one
    /// output, [`Error::Range`] for a final value of zero.
    pub fn step_figures(&self) -> Result<StepFigures, Error> {
        self.step_figures_within(StepLimits::default())
    }

    /// Computes the characteristic values of the step response, as [`step_figures`](Self::step_figures) does,
    /// with other limits.
    ///
    /// # Errors
    ///
    /// As for [`step_figures`](Self::step_figures), and [`Error::Range`] for limits outside their meaningful
    /// range.
    pub fn step_figures_within(&self, limits: StepLimits) -> Result<StepFigures, Error> {
        self.check_single_input_and_output()?;
        self.check_stable()?;
        let (low, high) = limits.rise;
        for (what, value) in
            [("a band", limits.settling), ("a lower part", low), ("an upper part", 1.0 - high)]
        {
            if !(value > 0.0 && value < 1.0) {
                return Err(Error::Range { what, value });
            }
        }
        let at_rest = self.frequency_map()?.sample_channel(stability_boundary_point(self.period, 0.0))?;
        let final_value = at_rest.value.re;
        if final_value.abs() <= at_rest.error {
            return Err(Error::Range { what: "a final value", value: 0.0 });
        }
        let distance = self.step_response_deviation(final_value)?;
        let period = self.period.unwrap_or(1.0);
        let (from, to) = (distance.first_above(low - 1.0)?, distance.first_above(high - 1.0)?);
        let settling_time = match (distance.last_outside(limits.settling)?, self.period) {
            (None, _) => 0.0,
            (Some(last), None) => last,
            (Some(last), Some(_)) => last + 1.0,
        };
        let (top, bottom) = (distance.extreme_deviation(1.0, 0.0)?, distance.extreme_deviation(-1.0, 0.0)?);
        let extreme_relative_to_final_value = |extreme: (f64, f64)| 1.0 + extreme.1;
        let peak =
            if extreme_relative_to_final_value(top).abs() >= extreme_relative_to_final_value(bottom).abs() {
                top
            } else {
                bottom
            };
        let after_rise = [distance.extreme_deviation(1.0, to)?, distance.extreme_deviation(-1.0, to)?];
        let after_rise = after_rise.map(|extreme| final_value * extreme_relative_to_final_value(extreme));
        Ok(StepFigures {
            final_value,
            rise_time: (to - from) * period,
            settling_time: settling_time * period,
            overshoot: 100.0 * top.1.max(0.0),
            undershoot: if -extreme_relative_to_final_value(bottom) > distance.modes.noise {
                -100.0 * extreme_relative_to_final_value(bottom)
            } else {
                0.0
            },
            peak: (final_value * extreme_relative_to_final_value(peak)).abs(),
            peak_time: peak.0 * period,
            least_after_rise: after_rise[0].min(after_rise[1]),
            largest_after_rise: after_rise[0].max(after_rise[1]),
        })
    }

    /// Computes the deviation of the step response from its final value, as a function of time.
    fn step_response_deviation(&self, final_value: f64) -> Result<StepResponseDeviation, Error> {
        let n = self.order();
        // The initial value of x − x∞ is −x∞.
        let (left, what) = match self.period {
            Some(_) => (DMatrix::identity(n, n) - &self.a, "I − A"),
            None => (-&self.a, "A"),
        };
        let mut x = -solve_linear_system(what, &left, &self.b)?;
        let c = &self.c / final_value;
        let modes = ModalSum::new(&c, &self.a, &x, self.period.is_some())?;
        let mut first = Vec::new();
        if self.period.is_some() {
            for _ in 0..FIRST_SAMPLES {
                first.push((&c * &x)[(0, 0)]);
                x = &self.a * x;
            }
        }
        Ok(StepResponseDeviation { first, modes })
    }
}

impl TransferFunction {
    /// Computes the characteristic values of the step response of the transfer function.
    ///
    /// # Errors
    ///
    /// As for [`StateSpace::step_figures`], and [`Error::Improper`].
    pub fn step_figures(&self) -> Result<StepFigures, Error> {
        self.state_space()?.step_figures()
    }
}
