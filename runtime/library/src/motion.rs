//! Simulations with settings and controllers from callers in other languages.

use crate::{Failure, Number};
use linkwork::Mechanism;
use linkwork::integrate::{
    DormandPrince, DormandPrince8, Error, EventDriven, ImplicitMidpoint, Method, Rk4, Rodas, TimeStepping,
};
use linkwork::nalgebra::SVector;
use linkwork::simulate::{self, Overlaps, Sample};

/// Integration method, with its step size or tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way<N> {
    /// Dormand–Prince integration method of order 5, with its tolerance.
    DormandPrince(N),
    /// Dormand–Prince integration method of order 8, with its tolerance.
    DormandPrince8(N),
    /// Rosenbrock integration method of order 4 for stiff equations, with its tolerance.
    Rodas(N),
    /// Classical Runge–Kutta method of order 4, with its step size.
    Rk4(N),
    /// Implicit midpoint rule, symplectic and of order 2, with its step size.
    ImplicitMidpoint(N),
    /// Event-driven integration of contacts, with its tolerance.
    EventDriven(N),
    /// Time stepping of contacts, with its step size. Initial penetrations are accepted, so that a caller can
    /// continue from a state in which time stepping left penetrations.
    TimeStepping(N),
    /// Time stepping of contacts with the midpoint rule, with its step size: two evaluations of the dynamics
    /// per step instead of four.
    TimeSteppingMidpoint(N),
    /// Time stepping of contacts with the leapfrog method, with its step size: one evaluation of the dynamics
    /// per step.
    TimeSteppingLeapfrog(N),
}

/// Interval between calls of the controller of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Every<N> {
    /// The controller is called at every evaluation of the dynamics.
    Evaluation,
    /// The controller is called once per period, s, and its inputs are held constant in between.
    Period(N),
}

/// Controller: function from time, configuration and velocity to the inputs.
pub type Control<'a, N> = &'a mut dyn FnMut(N, &[N], &[N], &mut [N]) -> Result<(), Failure>;

/// Settings of a simulation, with the array that receives its samples.
pub struct Motion<'a, N> {
    /// Initial time of the simulation, s.
    pub start: N,
    /// Initial configuration of the simulation.
    pub q: &'a [N],
    /// Initial velocity of the simulation.
    pub v: &'a [N],
    /// Duration of the simulation, s.
    pub duration: N,
    /// Time between samples of the simulation, s.
    pub interval: N,
    /// Integration method of the simulation.
    pub way: Way<N>,
    /// Interval between calls of the controller of the simulation.
    pub every: Every<N>,
    /// Controller that computes the inputs of the simulation.
    pub control: Control<'a, N>,
    /// Samples of the simulation: rows of time, configuration, velocity and inputs.
    pub samples: &'a mut [N],
    /// Number of sample rows that were written.
    pub count: usize,
}

/// Simulates a mechanism without unilateral contacts, with settings from another language.
///
/// # Errors
///
/// The errors of the method and of the controller, and an error for methods that require contacts.
pub fn simulate<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    motion: &mut Motion<'_, N>,
) -> Result<(), Failure>
where
    M: Mechanism<NQ, NV, NU, Scalar = N>,
    N: Number,
{
    match motion.way {
        Way::DormandPrince(e) => simulate_with_method(m, motion, DormandPrince::new().tolerance(e, e)),
        Way::DormandPrince8(e) => simulate_with_method(m, motion, DormandPrince8::new().tolerance(e, e)),
        Way::Rodas(e) => simulate_with_method(m, motion, Rodas::new().tolerance(e, e)),
        Way::Rk4(h) => simulate_with_method(m, motion, Rk4::step(h)),
        Way::ImplicitMidpoint(h) => simulate_with_method(m, motion, ImplicitMidpoint::step(h)),
        Way::EventDriven(_)
        | Way::TimeStepping(_)
        | Way::TimeSteppingMidpoint(_)
        | Way::TimeSteppingLeapfrog(_) => {
            Err(Failure::new("the mechanism has no contacts: choose a method for smooth motions"))
        }
    }
}

/// Simulates a mechanism with unilateral contacts, with settings from another language.
///
/// # Errors
///
/// The errors of the method and of the controller, and an error for methods that do not support contacts.
pub fn simulate_with_contacts<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    motion: &mut Motion<'_, N>,
) -> Result<(), Failure>
where
    M: Mechanism<NQ, NV, NU, Scalar = N>,
    N: Number,
{
    match motion.way {
        Way::EventDriven(e) => simulate_with_method(m, motion, EventDriven::new().tolerance(e, e)),
        Way::TimeStepping(h) => simulate_with_method(m, motion, TimeStepping::step(h)),
        Way::TimeSteppingMidpoint(h) => simulate_with_method(m, motion, TimeStepping::step(h).midpoint()),
        Way::TimeSteppingLeapfrog(h) => simulate_with_method(m, motion, TimeStepping::step(h).leapfrog()),
        _ => Err(Failure::new(
            "the mechanism has contacts: choose `event_driven` or a method whose name begins with `time_stepping`",
        )),
    }
}

fn simulate_with_method<M, N, S, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    motion: &mut Motion<'_, N>,
    method: S,
) -> Result<(), Failure>
where
    M: Mechanism<NQ, NV, NU, Scalar = N>,
    N: Number,
    S: Method<N>,
{
    let q = SVector::<N, NQ>::from_fn(|k, _| motion.q.get(k).copied().unwrap_or(N::NAN));
    let v = SVector::<N, NV>::from_fn(|k, _| motion.v.get(k).copied().unwrap_or(N::NAN));
    let overlaps = match motion.way {
        Way::TimeStepping(_) | Way::TimeSteppingMidpoint(_) | Way::TimeSteppingLeapfrog(_) => Overlaps::Keep,
        _ => Overlaps::Refuse,
    };
    let begun = simulate::simulate(m)
        .start_at(motion.start)
        .from(q, v)
        .duration(motion.duration)
        .sample_every(motion.interval)
        .overlaps(overlaps)
        .method(method);
    let (every, samples) = (motion.every, &mut *motion.samples);
    let (control, count) = (&mut *motion.control, &mut motion.count);
    let failure = std::cell::RefCell::new(None);
    let call_controller = |t: N, q: &SVector<N, NQ>, v: &SVector<N, NV>| {
        let mut u = SVector::<N, NU>::zeros();
        let mut failed = failure.borrow_mut();
        if failed.is_none()
            && NU > 0
            && let Err(why) = control(t, q.as_slice(), v.as_slice(), u.as_mut_slice())
        {
            *failed = Some(why);
        }
        // NaN inputs end the run.
        if failed.is_some() { u.map(|_| N::NAN) } else { u }
    };
    let ended = match every {
        Every::Evaluation => collect_samples(begun.inputs(call_controller), samples, count),
        Every::Period(period) => {
            collect_samples(begun.control_every(period, call_controller), samples, count)
        }
    };
    match failure.into_inner() {
        Some(failure) => Err(failure),
        None => ended,
    }
}

fn collect_samples<N, const NQ: usize, const NV: usize, const NU: usize>(
    run: impl Iterator<Item = Result<Sample<N, NQ, NV, NU>, Error>>,
    samples: &mut [N],
    count: &mut usize,
) -> Result<(), Failure>
where
    N: Number,
{
    let rows = samples.chunks_exact_mut(1 + NQ + NV + NU);
    for (row, sample) in rows.zip(run) {
        let sample = sample.map_err(Failure::new)?;
        let numbers = sample.q.iter().chain(&sample.v).chain(&sample.u);
        let numbers = std::iter::once(&sample.t).chain(numbers);
        row.iter_mut().zip(numbers).for_each(|(place, number)| *place = *number);
        *count += 1;
    }
    Ok(())
}
