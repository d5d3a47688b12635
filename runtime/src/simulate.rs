//! Simulation of a mechanism: from an initial state to samples of its motion
//! ([guide](crate::guide::simulating)).
//!
//! [`simulate`] creates a simulation, the methods of [`Simulation`] set its options, and iterating over it
//! yields [`Sample`]s. The other types of this module belong to events. They appear in the type of a
//! simulation, but programs need not name them.

mod clock;
mod event;
mod run;
mod start;

pub use event::{
    Action, Crossing, Event, EventHit, EventOutcome, EventSearchError, Events, Impact, NoEvents, Report, Stop,
};
pub use start::Start;

use crate::integrate::{
    ContinuousInputs, DormandPrince, Error, Inputs, Method, NoInputs, SampledInputs, State, System,
    check_not_negative, check_positive,
};
use crate::private::to_f64;
use crate::{Mechanism, Real};
use core::fmt;
use nalgebra::SVector;
use run::RunProgress;

/// Creates a simulation of a mechanism. By default, it starts from the neutral configuration at rest at t = 0
/// and uses no inputs and the method [`DormandPrince`]. The methods of [`Simulation`] change these settings.
///
/// ```
/// use linkwork::prelude::*;
///
/// fn swing<Pendulum: Mechanism<1, 1, 1, Scalar = f64>>(pendulum: &Pendulum) -> Result<f64, Error> {
///     let run = simulate(pendulum)
///         .from([0.1], [0.0])                           // rad, rad/s
///         .inputs(|t, _q, v| SVector::from([t.sin() - 0.1 * v[0]]))
///         .duration(10.0)
///         .sample_every(0.01);
///     let mut highest = 0.0_f64;
///     for sample in run {
///         let sample = sample?;
///         highest = highest.max(sample.q[0]);
///     }
///     Ok(highest)
/// }
/// ```
pub fn simulate<M, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
) -> Simulation<'_, M, M::Scalar, NoInputs, DormandPrince<M::Scalar>, NoEvents, NQ, NV, NU>
where
    M: Mechanism<NQ, NV, NU>,
{
    let start = State { t: nalgebra::zero(), q: mechanism.neutral(), v: SVector::zeros() };
    let system = System::new(mechanism, NoInputs);
    let method = DormandPrince::new();
    Simulation {
        system,
        method,
        events: NoEvents,
        start,
        overlaps: Overlaps::Refuse,
        duration: None,
        samples: SampleTimes::Steps,
        progress: None,
        over: false,
    }
}

/// List of the events `E`, extended by one event.
type EventsWithOneMore<E, T, G, A> = (E, Event<T, G, A>);
/// List of the events `E` extended by one more event whose effect is an impact.
type EventsWithImpact<E, T, G, F> = EventsWithOneMore<E, T, G, Impact<F>>;

/// Sample of a simulation: state and inputs at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T, const NQ: usize, const NV: usize, const NU: usize> {
    /// Time of the sample, s.
    pub t: T,
    /// Configuration at the time of the sample.
    pub q: SVector<T, NQ>,
    /// Velocity at the time of the sample.
    pub v: SVector<T, NV>,
    /// Inputs at the time of the sample. At an instant at which a digital controller acts, these are its new
    /// values.
    pub u: SVector<T, NU>,
    /// Index of the event that this sample reports, in the order of declaration; `None` for other samples.
    pub event: Option<usize>,
    /// Largest violation of the contact conditions in the steps since the previous sample, as a contact
    /// velocity, m/s or rad/s: at rounding level if the contact impulses satisfy the conditions, and zero
    /// without contacts ([guide](crate::guide::contact)).
    pub violation: T,
}

impl<T: Real, const NQ: usize, const NV: usize, const NU: usize> Sample<T, NQ, NV, NU> {
    /// Creates a sample of a motion that was measured, computed by another program, or is a single state to
    /// draw or log. The sample reports no event.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// #[mechanism(gravity = -9.81 * z)]
    /// struct Top {
    ///     #[body(mass = 1, com = 0.1 * z, inertia = cylinder(1, 0.05, 0.02, z))]
    ///     top: Body,
    ///     #[joint(ground -> top)]
    ///     tip: Ball,
    /// }
    ///
    /// let upright = Sample::new(&Top {}, 0.5, [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 30.0], [])?;
    /// assert_eq!((upright.t, upright.v[2]), (0.5, 30.0));
    /// // Neither of these is valid: a zero quaternion, and a time that is NaN.
    /// assert!(Sample::new(&Top {}, 0.5, [0.0; 4], [0.0; 3], []).is_err());
    /// assert!(Sample::new(&Top {}, f64::NAN, [0.0, 0.0, 0.0, 1.0], [0.0; 3], []).is_err());
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] if a number is infinite or NaN, and [`Error::Quaternion`] if a quaternion does
    /// not have unit norm.
    pub fn new<M>(
        mechanism: &M,
        t: T,
        q: impl Start<T, NQ>,
        v: impl Start<T, NV>,
        u: impl Start<T, NU>,
    ) -> Result<Self, Error>
    where
        M: Mechanism<NQ, NV, NU, Scalar = T>,
    {
        let (q, v, u) = (q.vector(), v.vector(), u.vector());
        if !q.iter().chain(&v).chain(&u).chain([&t]).all(|x| x.is_finite()) {
            return Err(Error::NotFinite { t: to_f64(t) });
        }
        run::check_unit_quaternions::<M, T, NQ, NV, NU>(&q, &mechanism.integrate(&q, &SVector::zeros()))?;
        Ok(Self { t, q, v, u, event: None, violation: T::zero() })
    }
}

/// Times at which a simulation emits samples.
#[derive(Clone, Copy, Debug)]
enum SampleTimes<'m, T> {
    /// Samples at the end of every step.
    Steps,
    /// Samples at equal intervals of this length, s.
    Every(T),
    /// Samples at listed times, s.
    At(&'m [T]),
}

/// Treatment of contact surfaces that overlap at the start of a simulation by more than `1e-8` m or rad
/// (`2.3e-4` with `f32`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlaps {
    /// The simulation fails with [`ConstraintError::Overlap`](crate::ConstraintError::Overlap), which names
    /// the contact with the largest overlap.
    #[default]
    Refuse,
    /// The surfaces are separated by displacements that satisfy the constraints
    /// ([`contact::project`](crate::contact::project)). If this is impossible, the error is that of `Refuse`.
    Part,
    /// The simulation starts with the overlap unchanged. Use this option to continue a run:
    /// [`TimeStepping`](crate::integrate::TimeStepping) leaves overlaps of up to the approach of surfaces in
    /// one step. Deep overlaps at the start remain, too.
    Keep,
}

/// Simulation: its settings, and the iterator over its samples.
///
/// [`simulate`] creates it. The first sample is the initial state. Then follow samples every
/// [`sample_every`](Self::sample_every) seconds, at the times of [`sample_at`](Self::sample_at), or at every
/// step of the integrator; one sample per event (two per [`impact`](Self::impact)); and the last sample
/// exactly at the end of the [`duration`](Self::duration). The iterator ends after an error. Changing a
/// setting restarts the simulation. Simulations allocate no memory.
#[must_use = "a simulation does nothing until its samples are asked for"]
pub struct Simulation<'m, M, T, I, S, E, const NQ: usize, const NV: usize, const NU: usize>
where
    T: Real,
    S: Method<T>,
{
    system: System<'m, M, I, NU>,
    method: S,
    events: E,
    start: State<T, NQ, NV>,
    overlaps: Overlaps,
    duration: Option<T>,
    samples: SampleTimes<'m, T>,
    progress: Option<RunProgress<T, S::Memory<NV>, NQ, NV>>,
    over: bool,
}

impl<'m, M, T, I, S, E, const NQ: usize, const NV: usize, const NU: usize>
    Simulation<'m, M, T, I, S, E, NQ, NV, NU>
where
    M: Mechanism<NQ, NV, NU, Scalar = T>,
    T: Real,
    S: Method<T>,
{
    /// Sets the initial configuration `q` and velocity `v`: vectors, references to vectors or arrays
    /// ([`Start`]). Quaternions (x, y, z, w) must have unit norm, otherwise the error is
    /// [`Error::Quaternion`].
    pub fn from(self, q: impl Start<T, NQ>, v: impl Start<T, NV>) -> Self {
        let start = State { t: self.start.t, q: q.vector(), v: v.vector() };
        Self { start, ..self.reset_simulation() }
    }

    /// Sets the initial time, s; the default is zero.
    pub fn start_at(self, t: T) -> Self {
        let start = State { t, ..self.start };
        Self { start, ..self.reset_simulation() }
    }

    /// Sets the treatment of [contact](crate::contact) surfaces that overlap at the start. By default,
    /// overlaps are an error.
    ///
    /// ```
    /// use linkwork::prelude::*;
    /// use linkwork::simulate::Overlaps;
    ///
    /// #[mechanism(gravity = -9.81 * z)]
    /// struct Ball {
    ///     #[body(mass = 0.5, inertia = sphere(0.5, 0.1))]
    ///     ball: Body,
    ///     #[joint(ground -> ball)]
    ///     pose: Free,
    ///     #[contact(ball.sphere(0.1), ground.plane(z))]
    ///     floor: Contact,
    /// }
    ///
    /// # fn main() -> Result<(), Error> {
    /// // The centre of the ball is in the floor plane.
    /// let run = simulate(&Ball {}).method(TimeStepping::step(1e-3)).duration(0.1);
    /// let refused = run.clone().finish().unwrap_err();
    /// assert_eq!(refused.to_string(), "at t = 0 s the surfaces of the contact `floor` overlap by 0.1");
    /// let end = run.overlaps(Overlaps::Part).finish()?;
    /// assert!((end.q[2] - 0.1).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    pub fn overlaps(self, overlaps: Overlaps) -> Self {
        Self { overlaps, ..self.reset_simulation() }
    }

    /// Sets the duration, s. A duration of zero yields only the initial state. Without a duration, the run
    /// ends at an event of [`until`](Self::until), or continues as long as samples are requested.
    pub fn duration(self, duration: T) -> Self {
        Self { duration: Some(duration), ..self.reset_simulation() }
    }

    /// Selects samples every `interval` seconds; the `k`-th sample is exactly at start + k · interval.
    /// Fixed-step methods divide the interval into equal steps, adaptive methods interpolate. By default,
    /// every step of the integrator is a sample.
    pub fn sample_every(self, interval: T) -> Self {
        Self { samples: SampleTimes::Every(interval), ..self.reset_simulation() }
    }

    /// Selects samples at these times of the run, s. The times must increase, and none may be before the
    /// start; the initial state is a sample only if its time is listed. The run ends at the last time, or at
    /// the end of the [`duration`](Self::duration), which is then a sample, too. Fixed-step methods end steps
    /// at these times, adaptive methods interpolate.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// #[mechanism]
    /// struct Cart {
    ///     #[body(mass = 1)]
    ///     cart: Body,
    ///     #[joint(ground -> cart, along = x)]
    ///     rail: Sleeve,
    /// }
    ///
    /// // Samples at the times of measurements.
    /// let looked = [0.013, 0.4, 0.41, 7.25];
    /// let run = simulate(&Cart).from([0.0], [2.0]).sample_at(&looked);
    /// for (sample, t) in run.zip(looked) {
    ///     let sample = sample?;
    ///     assert!(sample.t == t && (sample.q[0] - 2.0 * t).abs() < 1e-12);
    /// }
    /// # Ok::<(), Error>(())
    /// ```
    pub fn sample_at(self, times: &'m [T]) -> Self {
        Self { samples: SampleTimes::At(times), ..self.reset_simulation() }
    }

    /// Sets the inputs `u` of the mechanism to a function `|t, q, v|` that is continuous in time, and
    /// replaces earlier inputs. For functions with jumps, such as digital controllers, use
    /// [`control_every`](Self::control_every).
    pub fn inputs<F>(self, inputs: F) -> Simulation<'m, M, T, ContinuousInputs<F>, S, E, NQ, NV, NU>
    where
        F: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NU>,
    {
        self.with_inputs(ContinuousInputs(inputs))
    }

    /// Sets the inputs of a digital controller. `|t, q, v| u` is called once every `period` seconds, first at
    /// the start, and `u` is constant within a period (zero-order hold). Integrator steps end at the control
    /// instants.
    pub fn control_every<F>(
        self,
        period: T,
        control: F,
    ) -> Simulation<'m, M, T, SampledInputs<T, F, NU>, S, E, NQ, NV, NU>
    where
        F: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NU>,
    {
        self.with_inputs(SampledInputs::new(period, control))
    }

    /// Sets the integration method: [`DormandPrince`] with other settings, [`Rk4`](crate::integrate::Rk4),
    /// [`ImplicitMidpoint`](crate::integrate::ImplicitMidpoint),
    /// [`Rosenbrock`](crate::integrate::Rosenbrock),
    /// [`SemiImplicitEuler`](crate::integrate::SemiImplicitEuler) or another [method](crate::integrate).
    pub fn method<R: Method<T>>(self, method: R) -> Simulation<'m, M, T, I, R, E, NQ, NV, NU> {
        let Self { system, events, start, overlaps, duration, samples, .. } = self;
        Simulation { system, method, events, start, overlaps, duration, samples, progress: None, over: false }
    }

    /// Ends the run when `function(t, q, v)` crosses zero in either direction; the last sample is at the
    /// crossing.
    pub fn until<G>(
        self,
        function: G,
    ) -> Simulation<'m, M, T, I, S, EventsWithOneMore<E, T, G, Stop>, NQ, NV, NU>
    where
        G: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> T,
    {
        self.until_crossing(Crossing::Either, function)
    }

    /// Ends the run when `function(t, q, v)` crosses zero in this direction; the last sample is at the
    /// crossing.
    pub fn until_crossing<G>(
        self,
        crossing: Crossing,
        function: G,
    ) -> Simulation<'m, M, T, I, S, EventsWithOneMore<E, T, G, Stop>, NQ, NV, NU>
    where
        G: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> T,
    {
        self.with_event(Event::new(function, crossing, Stop))
    }

    /// Reports zero crossings of `function(t, q, v)` by additional samples, whose [`Sample::event`] is the
    /// index of the event.
    ///
    /// Each step is searched at its quarters, so two crossings within a quarter of a step may be missed. A
    /// function that is zero at the start counts once it has become nonzero and zero again, after any time.
    /// Crossings are located to rounding error on the interpolated motion. If the function is NaN, the error
    /// is [`Error::Event`].
    pub fn event<G>(
        self,
        crossing: Crossing,
        function: G,
    ) -> Simulation<'m, M, T, I, S, EventsWithOneMore<E, T, G, Report>, NQ, NV, NU>
    where
        G: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> T,
    {
        self.with_event(Event::new(function, crossing, Report))
    }

    /// Adds an [`event`](Self::event) at which the velocity becomes `after(t, q, v)`, as in an impact. It
    /// yields two samples at the same time: the first has the velocity before the impact and no
    /// [`Sample::event`], the second reports the event with the velocity after it. With constraints, this
    /// velocity is projected on them, because they exert impulses, too.
    ///
    /// Bodies cannot rest on the surface of an event. If the impact stops the motion towards the surface (a
    /// plastic impact) and the motion then continues through it, or if impacts accumulate, the run ends with
    /// [`Error::Impacts`]. Coincident events, such as an [`until`](Self::until), all take effect in the order
    /// of declaration.
    pub fn impact<G, F>(
        self,
        crossing: Crossing,
        function: G,
        after: F,
    ) -> Simulation<'m, M, T, I, S, EventsWithImpact<E, T, G, F>, NQ, NV, NU>
    where
        G: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> T,
        F: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NV>,
    {
        self.with_event(Event::new(function, crossing, Impact(after)))
    }

    /// Runs the simulation to its end and returns the last sample.
    ///
    /// # Errors
    ///
    /// The errors of the method, and [`Error::Endless`] if neither a duration nor an [`until`](Self::until)
    /// ends the run.
    pub fn finish(mut self) -> Result<Sample<T, NQ, NV, NU>, Error>
    where
        I: Inputs<T, NQ, NV, NU>,
        E: Events<T, NQ, NV>,
    {
        if self.duration.is_none() && !E::STOPS && !matches!(self.samples, SampleTimes::At(_)) {
            return Err(Error::Endless);
        }
        let mut run = self.initial_or_resumed_progress()?;
        run.quiet = true;
        let mut last = Err(Error::Endless);
        while let Some(sample) = self.next_sample(&mut run)? {
            last = Ok(sample);
        }
        last
    }

    /// Returns the simulation with its progress discarded, so that it starts again with its first sample.
    fn reset_simulation(self) -> Self {
        Self { progress: None, over: false, ..self }
    }

    /// Sets the inputs of the simulation to a source of any type.
    #[doc(hidden)]
    pub fn with_inputs<J>(self, inputs: J) -> Simulation<'m, M, T, J, S, E, NQ, NV, NU> {
        let Self { system, method, events, start, overlaps, duration, samples, .. } = self;
        let system = System::new(system.mechanism, inputs);
        Simulation { system, method, events, start, overlaps, duration, samples, progress: None, over: false }
    }

    fn with_event<G, A>(
        self,
        event: Event<T, G, A>,
    ) -> Simulation<'m, M, T, I, S, EventsWithOneMore<E, T, G, A>, NQ, NV, NU> {
        let Self { system, method, events, start, overlaps, duration, samples, .. } = self;
        let events = (events, event);
        Simulation { system, method, events, start, overlaps, duration, samples, progress: None, over: false }
    }
}

impl<M, T, I, S, E, const NQ: usize, const NV: usize, const NU: usize> Clone
    for Simulation<'_, M, T, I, S, E, NQ, NV, NU>
where
    T: Real,
    I: Clone,
    S: Method<T> + Clone,
    E: Clone,
{
    fn clone(&self) -> Self {
        Self {
            system: self.system.clone(),
            method: self.method.clone(),
            events: self.events.clone(),
            start: self.start,
            overlaps: self.overlaps,
            duration: self.duration,
            samples: self.samples,
            progress: self.progress.clone(),
            over: self.over,
        }
    }
}

impl<M, T, I, S, E, const NQ: usize, const NV: usize, const NU: usize> fmt::Debug
    for Simulation<'_, M, T, I, S, E, NQ, NV, NU>
where
    T: Real,
    S: Method<T> + fmt::Debug,
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Simulation")
            .field("start", &self.start)
            .field("method", &self.method)
            .field("duration", &self.duration)
            .field("samples", &self.samples)
            .finish_non_exhaustive()
    }
}

impl<M, T, I, S, E, const NQ: usize, const NV: usize, const NU: usize> Iterator
    for Simulation<'_, M, T, I, S, E, NQ, NV, NU>
where
    M: Mechanism<NQ, NV, NU, Scalar = T>,
    T: Real,
    I: Inputs<T, NQ, NV, NU>,
    S: Method<T>,
    E: Events<T, NQ, NV>,
{
    type Item = Result<Sample<T, NQ, NV, NU>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        let mut run = match self.initial_or_resumed_progress() {
            Ok(run) => run,
            Err(error) => {
                self.over = true;
                return Some(Err(error));
            }
        };
        let sample = self.next_sample(&mut run);
        self.over = !matches!(sample, Ok(Some(_)));
        self.progress = Some(run);
        sample.transpose()
    }
}

#[cfg(test)]
mod tests;
