//! Step size control from error tolerances, common to all adaptive methods.

use super::control::{ErrorScale, first_step_length};
use super::{Dynamics, Error, State, Step, check_positive, is_finite, project_end_of_step};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::SVector;

/// Settings of an adaptive method: tolerances, limits of the step length, and maximum number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AdaptiveSettings<T> {
    pub relative: T,
    pub absolute: T,
    pub first: Option<T>,
    pub least: Option<T>,
    pub longest: Option<T>,
    pub most_steps: u64,
}

/// Constants of the step size controller: the step is multiplied by `error` to the power `−exponent` and by
/// the error of the previous step to the power `beta`. `factors` are the maximum increase and the maximum
/// decrease of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepControl {
    pub exponent: f64,
    pub beta: f64,
    pub factors: [f64; 2],
}

/// Memory of an adaptive method: data that one step passes to the next.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveMemory<T, const NV: usize> {
    /// Acceleration at the start of the step, if known. It does not depend on the coordinate chart, so that
    /// the last stage of the previous step can be reused.
    pub(super) acceleration: Option<SVector<T, NV>>,
    step: Option<T>,
    error: T,
    trials: u64,
}

impl<T: Real, const NV: usize> AdaptiveMemory<T, NV> {
    pub(super) fn new(first: Option<T>) -> Self {
        Self { acceleration: None, step: first, error: constant(1e-4), trials: 0 }
    }

    /// Counts a trial step, and returns an error if the maximum number of steps is exceeded.
    ///
    /// # Errors
    ///
    /// [`Error::TooManySteps`] above the maximum number of trials.
    pub(super) fn count_trial_step(&mut self, settings: &AdaptiveSettings<T>, t: T) -> Result<(), Error> {
        self.trials += 1;
        if self.trials > settings.most_steps { Err(Error::TooManySteps { t: to_f64(t) }) } else { Ok(()) }
    }
}

/// Trial step of an adaptive method, before the error test accepts or rejects it.
pub(super) struct TrialStepResult<T, const NQ: usize, const NV: usize> {
    pub step: Step<T, NQ, NV>,
    /// Acceleration at the end, if the method computes it.
    pub acceleration: Option<SVector<T, NV>>,
    /// Estimated error of the step relative to the tolerance: the step is accepted if it is at most one; NaN
    /// if the step is NaN.
    pub error: T,
}

/// Start, length and end of a trial step.
pub(super) struct TrialStepArguments<'a, T, const NQ: usize, const NV: usize> {
    pub start: &'a State<T, NQ, NV>,
    pub acceleration: &'a SVector<T, NV>,
    pub scale: &'a ErrorScale<T>,
    pub h: T,
    pub t: T,
}

impl<T: Real> AdaptiveSettings<T> {
    pub fn new() -> Self {
        let tolerance = constant::<T>(1e-9).max(constant::<T>(64.0) * epsilon());
        Self {
            relative: tolerance,
            absolute: tolerance,
            first: None,
            least: None,
            longest: None,
            most_steps: 10_000_000,
        }
    }

    pub fn check(&self) -> Result<(), Error> {
        check_positive("the relative tolerance", self.relative)?;
        check_positive("the absolute tolerance", self.absolute)?;
        self.first.map_or(Ok(()), |h| check_positive("the initial step", h))?;
        self.least.map_or(Ok(()), |h| check_positive("the shortest step", h))?;
        self.longest.map_or(Ok(()), |h| check_positive("the longest step", h))
    }

    /// Returns the length and end of the step to try: at most `h`, and without a tiny remainder before
    /// `until`.
    fn fit_step_length(&self, h: T, t: T, until: Option<T>) -> (T, T) {
        let Some(until) = until else { return (h, t + h) };
        let remaining = until - t;
        let h = if h >= remaining * constant(0.99) {
            return (remaining, until);
        } else if h > remaining * constant(0.5) {
            remaining * constant(0.5)
        } else {
            h
        };
        (h, t + h)
    }

    fn limited_step_length(&self, h: T) -> T {
        self.longest.map_or(h, |longest| h.min(longest))
    }

    /// Returns the next step sizes after an error estimate, for an accepted and for a rejected step: the
    /// controller of DOPRI5 and related programs.
    fn next_step_sizes(control: &StepControl, h: T, error: T, last: T) -> (T, T) {
        let ([longer, shorter], safety) = (control.factors, constant::<T>(0.9));
        let raw = error.powf(constant(control.exponent));
        let smooth = raw / last.powf(constant(control.beta)) / safety;
        let accepted = h / smooth.max(constant(1.0 / longer)).min(constant(shorter));
        (accepted, h / (raw / safety).min(constant(shorter)))
    }

    /// Checks that the step `h` from `t` to `end` can be taken; `wanted` is its length before it was cut at
    /// `until`. If the previous trial was not finite (`finite` is false), that is reported as the cause of a
    /// small step.
    fn check_step_size(&self, [t, end]: [T; 2], h: T, wanted: T, finite: bool, now: T) -> Result<(), Error> {
        // Steps count time from their start, so only double precision's rounding of the whole run limits
        // them.
        let least = self.least.unwrap_or(T::zero()).max(constant::<T>(f64::EPSILON) * now.abs());
        let (t, possible) = (to_f64(t), end > t && h > T::zero() && wanted > least);
        match (possible, finite) {
            (true, _) => Ok(()),
            (false, true) => Err(Error::StepTooSmall { t, h: to_f64(wanted) }),
            (false, false) => Err(Error::NotFinite { t }),
        }
    }

    /// Repeats trial steps with adapted lengths, which `attempt` computes, until one is accepted. Returns the
    /// accepted step.
    pub fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        control: &StepControl,
        memory: &mut AdaptiveMemory<T, NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        mut attempt: impl FnMut(
            &mut D,
            &TrialStepArguments<'_, T, NQ, NV>,
        ) -> Result<TrialStepResult<T, NQ, NV>, Error>,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let known = memory.acceleration.take();
        let acceleration = known.unwrap_or_else(|| system.acceleration(start.t, &start.q, &start.v));
        if !is_finite(&acceleration) {
            return Err(Error::NotFinite { t: to_f64(start.t) });
        }
        let dimensions = system.dimensions();
        let scale = ErrorScale { relative: self.relative, absolute: self.absolute, dimensions };
        let chosen = memory.step.unwrap_or_else(|| first_step_length(system, &scale, start, &acceleration));
        let mut wanted = self.limited_step_length(chosen);
        let (mut rejected, mut finite) = (false, true);
        loop {
            let (h, t) = self.fit_step_length(wanted, start.t, until);
            self.check_step_size([start.t, t], h, wanted, finite, system.time(start.t))?;
            memory.count_trial_step(self, start.t)?;
            let trial = attempt(
                system,
                &TrialStepArguments { start, acceleration: &acceleration, scale: &scale, h, t },
            )?;
            let error = trial.error;
            finite = error.is_finite() && is_finite(&trial.step.end.q);
            let (larger, smaller) = Self::next_step_sizes(control, h, error, memory.error);
            if !finite || error > T::one() {
                wanted = if finite { smaller } else { h * constant(0.1) };
                rejected = true;
                continue;
            }
            // A step cut short at `until` gives little information about longer steps.
            let longer = if h < wanted { larger.max(wanted) } else { larger };
            memory.step = Some(self.limited_step_length(if rejected { larger.min(h) } else { longer }));
            memory.error = error.max(constant(1e-4));
            let end = project_end_of_step(system, trial.step.end, start.t)?;
            memory.acceleration = trial.acceleration.filter(|_| !system.is_constrained());
            return Ok(Step { end, ..trial.step });
        }
    }
}

/// Builder functions and defaults of an adaptive method, common to all of them. For an explicit method, also
/// the implementation of `Method`, with its step control and a function that computes a trial step.
macro_rules! adaptive {
    ($name:ident, $control:ident, $trial_step:expr) => {
        $crate::integrate::adaptive::adaptive!($name);

        impl<T: Real> Method<T> for $name<T> {
            type Memory<const NV: usize> = AdaptiveMemory<T, NV>;

            const FIXED: bool = false;

            fn check(&self) -> Result<(), Error> {
                self.settings.check()
            }

            fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
                AdaptiveMemory::new(self.settings.first)
            }

            fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, _jump: Jump) {
                memory.acceleration = None;
            }

            fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
                &self,
                memory: &mut Self::Memory<NV>,
                system: &mut D,
                start: &State<T, NQ, NV>,
                until: Option<T>,
                dense: bool,
            ) -> Result<Step<T, NQ, NV>, Error> {
                self.settings.advance(&$control, memory, system, start, until, |system, attempt| {
                    Ok($trial_step(system, attempt, dense))
                })
            }
        }
    };
    ($name:ident) => {
        impl<T: Real> $name<T> {
            /// Returns the method with relative and absolute tolerance 1e-9 (or 64 machine epsilons of a less
            /// precise `T`) and at most ten million steps.
            pub fn new() -> Self {
                Self { settings: AdaptiveSettings::new() }
            }

            /// Sets the error allowed per step: relative to the magnitude of each coordinate and velocity,
            /// and absolute in SI units.
            pub fn tolerance(self, relative: T, absolute: T) -> Self {
                Self { settings: AdaptiveSettings { relative, absolute, ..self.settings } }
            }

            /// Sets the first trial step, s; without this setting the method estimates it.
            pub fn initial_step(self, step: T) -> Self {
                Self { settings: AdaptiveSettings { first: Some(step), ..self.settings } }
            }

            /// Sets the longest step, s; without this setting there is no limit. Set it below the duration of
            /// the shortest event that must not be stepped over.
            pub fn max_step(self, step: T) -> Self {
                Self { settings: AdaptiveSettings { longest: Some(step), ..self.settings } }
            }

            /// Sets the minimum length of a step, s. If the tolerance requires a shorter step, the run ends
            /// with [`Error::StepTooSmall`].
            pub fn min_step(self, step: T) -> Self {
                Self { settings: AdaptiveSettings { least: Some(step), ..self.settings } }
            }

            /// Sets the maximum number of trial steps in one run, counting both accepted and rejected ones.
            pub fn max_steps(self, steps: u64) -> Self {
                Self { settings: AdaptiveSettings { most_steps: steps, ..self.settings } }
            }
        }

        impl<T: Real> Default for $name<T> {
            fn default() -> Self {
                Self::new()
            }
        }
    };
}

pub(super) use adaptive;
