//! Figures of a step response.

use crate::margins::root_between;
use crate::matrices::exponential;
use crate::{Error, StateSpace, TransferFunction};
use nalgebra::{DMatrix, DVector};

/// Samples of the response that are looked at.
const SAMPLES: usize = 4000;

/// Figures of the step response of a stable system, relative to its final value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepFigures {
    /// Where it ends.
    pub final_value: f64,
    /// From when it first has the lower part of the final value to when it first has the upper one, s.
    pub rise_time: f64,
    /// When it stays within the band around the final value for good, s.
    pub settling_time: f64,
    /// By how much it goes beyond the final value, %.
    pub overshoot: f64,
    /// By how much it goes the wrong way, %.
    pub undershoot: f64,
    /// The largest magnitude.
    pub peak: f64,
    /// When, s; infinite where it is only approached.
    pub peak_time: f64,
    /// The least value after the rise.
    pub least_after_rise: f64,
    /// The largest value after the rise.
    pub largest_after_rise: f64,
}

/// What the figures are measured against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    /// Band around the final value; 0.02 of it.
    pub settling: f64,
    /// Parts of the final value between which it rises; from 0.1 to 0.9.
    pub rise: (f64, f64),
}

impl Default for StepLimits {
    fn default() -> Self {
        Self { settling: 0.02, rise: (0.1, 0.9) }
    }
}

/// The response at any instant: from the sample before by the exponential.
struct Exact<'a> {
    system: &'a StateSpace,
    step: f64,
    /// States at the samples, a column each, with the input appended.
    states: DMatrix<f64>,
    generator: DMatrix<f64>,
}

impl Exact<'_> {
    /// State and input at an instant.
    fn state(&self, t: f64) -> DVector<f64> {
        let last = self.states.ncols().saturating_sub(1);
        let k = ((t / self.step).floor().max(0.0) as usize).min(last);
        let before = self.states.column(k).into_owned();
        match exponential(&(&self.generator * (t - self.step * k as f64))) {
            Ok(e) => e * before,
            Err(_) => before,
        }
    }

    fn at(&self, t: f64) -> f64 {
        self.read(&self.state(t)) + self.system.d[(0, 0)]
    }

    fn slope(&self, t: f64) -> f64 {
        self.read(&(&self.generator * self.state(t)))
    }

    fn read(&self, x: &DVector<f64>) -> f64 {
        (&self.system.c * x.rows(0, self.system.order()))[(0, 0)]
    }

    fn samples(&self) -> Vec<f64> {
        let n = self.system.order();
        let y = &self.system.c * self.states.rows(0, n);
        y.iter().map(|y| y + self.system.d[(0, 0)]).collect()
    }
}

impl StateSpace {
    /// Figures of the step response of a stable system with one input and one output, not from samples: crossings and peaks are
    /// found by the exact response between them.
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
    /// [`Error::Unstable`] names a pole, [`Error::Count`] unless there is one input and one output, [`Error::Range`] for a final
    /// value of zero.
    pub fn step_figures(&self) -> Result<StepFigures, Error> {
        self.step_figures_within(StepLimits::default())
    }

    /// [`step_figures`](Self::step_figures) with other limits.
    ///
    /// # Errors
    ///
    /// Those of [`step_figures`](Self::step_figures), and [`Error::Range`] for limits without a meaning.
    pub fn step_figures_within(&self, limits: StepLimits) -> Result<StepFigures, Error> {
        self.check_single()?;
        self.check_stable()?;
        let (low, high) = limits.rise;
        for (what, value) in
            [("a band", limits.settling), ("a lower part", low), ("an upper part", 1.0 - high)]
        {
            if !(value > 0.0 && value < 1.0) {
                return Err(Error::Range { what, value });
            }
        }
        let final_value = self.gain_at_rest()?[(0, 0)];
        if final_value.abs() < 1e-300 {
            return Err(Error::Range { what: "a final value", value: final_value });
        }
        match self.period {
            Some(h) => self.discrete_figures(limits, final_value, h),
            None => self.continuous_figures(limits, final_value),
        }
    }

    /// Samples until all has settled far within the band.
    fn exact(&self, end: f64) -> Result<Exact<'_>, Error> {
        let n = self.order();
        let mut generator = DMatrix::zeros(n + 1, n + 1);
        generator.view_mut((0, 0), (n, n)).copy_from(&self.a);
        generator.view_mut((0, n), (n, 1)).copy_from(&self.b);
        let step = end / SAMPLES as f64;
        let e = exponential(&(&generator * step))?;
        let mut states = DMatrix::zeros(n + 1, SAMPLES + 1);
        states[(n, 0)] = 1.0;
        for k in 0..SAMPLES {
            let next = &e * states.column(k);
            states.set_column(k + 1, &next);
        }
        Ok(Exact { system: self, step, states, generator })
    }

    fn continuous_figures(&self, limits: StepLimits, final_value: f64) -> Result<StepFigures, Error> {
        let slowest = self.poles()?.iter().map(|p| -p.re).fold(f64::INFINITY, f64::min);
        let mut end = if slowest.is_finite() { 8.0 / slowest } else { 1.0 };
        let (exact, y) = loop {
            let exact = self.exact(end)?;
            let y: Vec<f64> = exact.samples().iter().map(|y| y / final_value).collect();
            let settled = y[SAMPLES / 2..].iter().all(|y| (y - 1.0).abs() < 0.5 * limits.settling);
            if settled || end * slowest > 200.0 {
                break (exact, y);
            }
            end *= 2.0;
        };
        let t = |k: usize| exact.step * k as f64;
        let of = |t: f64| exact.at(t) / final_value;
        let reach = |part: f64| match y.iter().position(|y| *y >= part) {
            Some(k) if k > 0 => root_between(|t| of(t) - part, t(k - 1), t(k)),
            Some(_) => 0.0,
            None => f64::INFINITY,
        };
        let (from, to) = (reach(limits.rise.0), reach(limits.rise.1));
        let outside = y.iter().rposition(|y| (y - 1.0).abs() > limits.settling);
        let settling_time = match outside {
            Some(k) if k + 1 < y.len() => {
                root_between(|t| (of(t) - 1.0).abs() - limits.settling, t(k), t(k + 1))
            }
            Some(_) => f64::INFINITY,
            None => 0.0,
        };
        let extreme = |sign: f64, after: usize| {
            let found = (after..y.len()).max_by(|a, b| (sign * y[*a]).total_cmp(&(sign * y[*b])));
            let k = found.unwrap_or(0);
            if k == 0 || k + 1 >= y.len() {
                return (t(k), y[k]);
            }
            let middle = y[k];
            let near = root_between(|t| exact.slope(t), t(k - 1), t(k + 1));
            let at = of(near);
            if sign * at >= sign * middle { (near, at) } else { (t(k), middle) }
        };
        let risen = y.iter().position(|y| *y >= limits.rise.1).unwrap_or(0);
        let (top, bottom) = (extreme(1.0, 0), extreme(-1.0, 0));
        let (mut peak_time, peak) = if top.1.abs() >= bottom.1.abs() { top } else { bottom };
        // A response that only approaches its end has its peak there.
        let approached = peak < 1.0 + 1e-9 && peak_time > 0.5 * end;
        let peak = if approached { 1.0 } else { peak.abs() };
        if approached {
            peak_time = f64::INFINITY;
        }
        Ok(StepFigures {
            final_value,
            rise_time: to - from,
            settling_time,
            overshoot: 100.0 * (top.1 - 1.0).max(0.0),
            undershoot: 100.0 * (-bottom.1).max(0.0),
            peak: peak * final_value.abs(),
            peak_time,
            least_after_rise: final_value * extreme(-1.0, risen).1,
            largest_after_rise: final_value * extreme(1.0, risen).1,
        })
    }

    fn discrete_figures(&self, limits: StepLimits, final_value: f64, h: f64) -> Result<StepFigures, Error> {
        let slowest = self.poles()?.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let count = if slowest > 0.0 { (-40.0 / slowest.ln()).ceil() } else { 0.0 };
        let count = (count as usize).clamp(20, 200_000) + self.order();
        let times: Vec<f64> = (0..count).map(|k| h * k as f64).collect();
        let y = self.step_response(0, &times)?.outputs / final_value;
        let y: Vec<f64> = y.iter().copied().collect();
        let reach = |part: f64| y.iter().position(|y| *y >= part).unwrap_or(y.len()) as f64 * h;
        let outside = y.iter().rposition(|y| (y - 1.0).abs() > limits.settling);
        let risen = y.iter().position(|y| *y >= limits.rise.1).unwrap_or(0);
        let fold = |from: usize, f: fn(f64, f64) -> f64| y[from..].iter().copied().fold(y[from], f);
        let (peak, at) = y
            .iter()
            .enumerate()
            .fold((0.0_f64, 0), |best, (k, y)| if y.abs() > best.0 { (y.abs(), k) } else { best });
        Ok(StepFigures {
            final_value,
            rise_time: reach(limits.rise.1) - reach(limits.rise.0),
            settling_time: outside.map_or(0.0, |k| (k + 1) as f64 * h),
            overshoot: 100.0 * (fold(0, f64::max) - 1.0).max(0.0),
            undershoot: 100.0 * (-fold(0, f64::min)).max(0.0),
            peak: peak * final_value.abs(),
            peak_time: at as f64 * h,
            least_after_rise: final_value * fold(risen, if final_value > 0.0 { f64::min } else { f64::max }),
            largest_after_rise: final_value
                * fold(risen, if final_value > 0.0 { f64::max } else { f64::min }),
        })
    }
}

impl TransferFunction {
    /// Figures of the step response.
    ///
    /// # Errors
    ///
    /// Those of [`StateSpace::step_figures`], and [`Error::Improper`].
    pub fn step_figures(&self) -> Result<StepFigures, Error> {
        self.state_space()?.step_figures()
    }
}
