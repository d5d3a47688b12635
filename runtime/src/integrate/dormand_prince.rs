//! The Dormand–Prince pair of orders 5 and 4 with adaptive steps.

use super::{Dynamics, Error, Jump, Method, State, Step, is_finite, positive, settled};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::SVector;

mod control;
mod stages;

use control::{Scale, first_step};
use stages::stages;

/// The Dormand–Prince method of order 5 with an error estimate of order 4: steps of the size that the tolerance asks
/// for, and interpolation of order 4 in between.
///
/// A step is accepted when the root mean square over `φ` and `v` of `error / (absolute + relative · size)` is at
/// most one. The size of a coordinate is its magnitude; where quaternions occur it is 1 rad or 1 m for all
/// coordinates. Six evaluations of the dynamics per step; proportional–integral step control.
///
/// ```
/// # use linkwork::prelude::*;
/// let method = DormandPrince::new().tolerance(1e-10, 1e-12).max_step(0.1);
/// # let _: DormandPrince<f64> = method;
/// ```
///
/// Sources: Dormand and Prince, *A family of embedded Runge–Kutta formulae*, J. Comp. Appl. Math. 6 (1980); Hairer,
/// Nørsett and Wanner, *Solving Ordinary Differential Equations I* (1993), II.4–6 and the program DOPRI5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DormandPrince<T> {
    relative: T,
    absolute: T,
    first: Option<T>,
    least: Option<T>,
    longest: Option<T>,
    most_steps: u64,
}

/// What one adaptive step hands to the next.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveMemory<T, const NV: usize> {
    /// Acceleration at the start of the step: it does not depend on the chart, so the last stage can be reused.
    acceleration: Option<SVector<T, NV>>,
    step: Option<T>,
    error: T,
    trials: u64,
}

impl<T: Real> DormandPrince<T> {
    /// Relative and absolute tolerance 1e-9 (or 64 roundings of a less precise `T`), at most ten million steps.
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

    /// Error allowed per step: relative to the size of each coordinate and velocity, and absolute in SI units.
    pub fn tolerance(self, relative: T, absolute: T) -> Self {
        Self { relative, absolute, ..self }
    }

    /// First step tried, s; chosen by itself if not given.
    pub fn initial_step(self, step: T) -> Self {
        Self { first: Some(step), ..self }
    }

    /// Longest step, s; no limit if not given. Set it below the shortest thing that must not be stepped over.
    pub fn max_step(self, step: T) -> Self {
        Self { longest: Some(step), ..self }
    }

    /// Shortest step, s: if the tolerance asks for less, the run ends with [`Error::StepTooSmall`].
    pub fn min_step(self, step: T) -> Self {
        Self { least: Some(step), ..self }
    }

    /// Most steps tried in one run, accepted and rejected.
    pub fn max_steps(self, steps: u64) -> Self {
        Self { most_steps: steps, ..self }
    }

    /// The step to try: at most `h`, ending on `until` without leaving a sliver.
    fn fit(&self, h: T, t: T, until: Option<T>) -> (T, T) {
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

    fn limited(&self, h: T) -> T {
        self.longest.map_or(h, |longest| h.min(longest))
    }

    /// Step sizes after an error estimate: DOPRI5's controller. The first for an accepted step, the second for a
    /// rejected one.
    fn next_steps(&self, h: T, error: T, last: T) -> (T, T) {
        let (beta, safety) = (0.04, constant::<T>(0.9));
        let raw = error.powf(constant(0.2 - 0.75 * beta));
        let smooth = raw / last.powf(constant(beta)) / safety;
        let accepted = h / smooth.max(constant(0.1)).min(constant(5.0));
        (accepted, h / (raw / safety).min(constant(5.0)))
    }

    /// Whether the step `h` from `t` to `end` can be taken; `wanted` is what it was cut from. If the trial before was
    /// not finite, that is the reason for a small step.
    fn check_size(&self, [t, end]: [T; 2], h: T, wanted: T, finite: bool, now: T) -> Result<(), Error> {
        // Steps count time from their start: only double precision's rounding of the whole run sets a limit.
        let least = self.least.unwrap_or(T::zero()).max(constant::<T>(f64::EPSILON) * now.abs());
        let (t, possible) = (to_f64(t), end > t && h > T::zero() && wanted > least);
        match (possible, finite) {
            (true, _) => Ok(()),
            (false, true) => Err(Error::StepTooSmall { t, h: to_f64(wanted) }),
            (false, false) => Err(Error::NotFinite { t }),
        }
    }
}

impl<T: Real> Default for DormandPrince<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Method<T> for DormandPrince<T> {
    type Memory<const NV: usize> = AdaptiveMemory<T, NV>;

    const FIXED: bool = false;

    fn check(&self) -> Result<(), Error> {
        positive("the relative tolerance", self.relative)?;
        positive("the absolute tolerance", self.absolute)?;
        self.first.map_or(Ok(()), |h| positive("the initial step", h))?;
        self.least.map_or(Ok(()), |h| positive("the shortest step", h))?;
        self.longest.map_or(Ok(()), |h| positive("the longest step", h))
    }

    fn memory<const NV: usize>(&self) -> Self::Memory<NV> {
        AdaptiveMemory { acceleration: None, step: self.first, error: constant(1e-4), trials: 0 }
    }

    fn disturb<const NV: usize>(&self, memory: &mut Self::Memory<NV>, _jump: Jump) {
        memory.acceleration = None;
    }

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        _dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let known = memory.acceleration.take();
        let acceleration = known.unwrap_or_else(|| system.acceleration(start.t, &start.q, &start.v));
        if !is_finite(&acceleration) {
            return Err(Error::NotFinite { t: to_f64(start.t) });
        }
        let scale = Scale { relative: self.relative, absolute: self.absolute };
        let chosen = memory.step.unwrap_or_else(|| first_step(system, &scale, start, &acceleration));
        let mut wanted = self.limited(chosen);
        let (mut rejected, mut finite) = (false, true);
        loop {
            let (h, t) = self.fit(wanted, start.t, until);
            self.check_size([start.t, t], h, wanted, finite, system.time(start.t))?;
            memory.trials += 1;
            if memory.trials > self.most_steps {
                return Err(Error::TooManySteps { t: to_f64(start.t) });
            }
            let trial = stages(system, start, &acceleration, h, t);
            let error = scale.error(&trial);
            finite = error.is_finite() && is_finite(&trial.step.end.q);
            let (larger, smaller) = self.next_steps(h, error, memory.error);
            if !finite || error > T::one() {
                wanted = if finite { smaller } else { h * constant(0.1) };
                rejected = true;
                continue;
            }
            // A step that was cut short to end on time says little about longer ones.
            let longer = if h < wanted { larger.max(wanted) } else { larger };
            memory.step = Some(self.limited(if rejected { larger.min(h) } else { longer }));
            memory.error = error.max(constant(1e-4));
            let end = settled(system, trial.step.end, start.t)?;
            memory.acceleration = (!system.is_constrained()).then_some(trial.acceleration);
            return Ok(Step { end, ..trial.step });
        }
    }
}
