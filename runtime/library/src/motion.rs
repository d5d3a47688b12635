//! Simulations whose settings and controllers come from outside.

use crate::{Failure, Number};
use linkwork::Rheonomic;
use linkwork::integrate::{
    DormandPrince, DormandPrince8, Error, EventDriven, ImplicitMidpoint, Method, Rk4, Rodas, TimeStepping,
};
use linkwork::nalgebra::SVector;
use linkwork::simulate::{self, Overlaps, Sample};

/// A method of integration, with the length of its steps or its tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way<N> {
    /// Dormand and Prince's of order 5, by a tolerance.
    DormandPrince(N),
    /// Dormand and Prince's of order 8, by a tolerance.
    DormandPrince8(N),
    /// For stiff equations, of order 4, by a tolerance.
    Rodas(N),
    /// The classical one of order 4, by steps.
    Rk4(N),
    /// Symplectic and implicit, of order 2, by steps.
    ImplicitMidpoint(N),
    /// Contacts by their events, by a tolerance.
    EventDriven(N),
    /// Contacts by impulses in steps. Surfaces that overlap at the start stay so: callers go on from where
    /// steps have left them in each other.
    TimeStepping(N),
    /// Contacts by impulses in steps through the middle of each: two evaluations of the dynamics in place of
    /// four.
    TimeSteppingMidpoint(N),
}

/// When inputs are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Every<N> {
    /// Whenever the method evaluates the dynamics.
    Evaluation,
    /// Once in so many seconds, and held in between.
    Period(N),
}

/// A controller: time, configuration and velocity → the inputs.
pub type Control<'a, N> = &'a mut dyn FnMut(N, &[N], &[N], &mut [N]) -> Result<(), Failure>;

/// What is simulated, and where the samples go.
pub struct Motion<'a, N> {
    /// Time at the start, s.
    pub start: N,
    /// Configuration at the start.
    pub q: &'a [N],
    /// Velocity at the start.
    pub v: &'a [N],
    /// How long, s.
    pub duration: N,
    /// Time between samples, s.
    pub interval: N,
    /// The method.
    pub way: Way<N>,
    /// When the controller is asked.
    pub every: Every<N>,
    /// The controller.
    pub control: Control<'a, N>,
    /// Rows of time, configuration, velocity and inputs.
    pub samples: &'a mut [N],
    /// How many rows were written.
    pub count: usize,
}

/// Simulates a mechanism without contacts that open and close, by the method that is wanted.
///
/// # Errors
///
/// Those of the method, and of the controller; methods for contacts.
pub fn simulate<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    motion: &mut Motion<'_, N>,
) -> Result<(), Failure>
where
    M: Rheonomic<NQ, NV, NU, Scalar = N>,
    N: Number,
{
    match motion.way {
        Way::DormandPrince(e) => go(m, motion, DormandPrince::new().tolerance(e, e)),
        Way::DormandPrince8(e) => go(m, motion, DormandPrince8::new().tolerance(e, e)),
        Way::Rodas(e) => go(m, motion, Rodas::new().tolerance(e, e)),
        Way::Rk4(h) => go(m, motion, Rk4::step(h)),
        Way::ImplicitMidpoint(h) => go(m, motion, ImplicitMidpoint::step(h)),
        Way::EventDriven(_) | Way::TimeStepping(_) | Way::TimeSteppingMidpoint(_) => {
            Err(Failure::of("the mechanism has no contacts: choose a method for smooth motions"))
        }
    }
}

/// Simulates a mechanism with contacts that open and close.
///
/// # Errors
///
/// Those of the method, and of the controller; methods for smooth motions.
pub fn simulate_with_contacts<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    motion: &mut Motion<'_, N>,
) -> Result<(), Failure>
where
    M: Rheonomic<NQ, NV, NU, Scalar = N>,
    N: Number,
{
    match motion.way {
        Way::EventDriven(e) => go(m, motion, EventDriven::new().tolerance(e, e)),
        Way::TimeStepping(h) => go(m, motion, TimeStepping::step(h)),
        Way::TimeSteppingMidpoint(h) => go(m, motion, TimeStepping::step(h).midpoint()),
        _ => Err(Failure::of(
            "the mechanism has contacts: choose `event_driven`, `time_stepping` or `time_stepping_midpoint`",
        )),
    }
}

fn go<M, N, S, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    motion: &mut Motion<'_, N>,
    method: S,
) -> Result<(), Failure>
where
    M: Rheonomic<NQ, NV, NU, Scalar = N>,
    N: Number,
    S: Method<N>,
{
    let q = SVector::<N, NQ>::from_fn(|k, _| motion.q.get(k).copied().unwrap_or(N::NAN));
    let v = SVector::<N, NV>::from_fn(|k, _| motion.v.get(k).copied().unwrap_or(N::NAN));
    let overlaps = match motion.way {
        Way::TimeStepping(_) | Way::TimeSteppingMidpoint(_) => Overlaps::Keep,
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
    let asked = |t: N, q: &SVector<N, NQ>, v: &SVector<N, NV>| {
        let mut u = SVector::<N, NU>::zeros();
        let mut failed = failure.borrow_mut();
        if failed.is_none()
            && NU > 0
            && let Err(why) = control(t, q.as_slice(), v.as_slice(), u.as_mut_slice())
        {
            *failed = Some(why);
        }
        // Ends the run: no motion goes on with such inputs.
        if failed.is_some() { u.map(|_| N::NAN) } else { u }
    };
    let ended = match every {
        Every::Evaluation => collect(begun.inputs(asked), samples, count),
        Every::Period(period) => collect(begun.control_every(period, asked), samples, count),
    };
    match failure.into_inner() {
        Some(failure) => Err(failure),
        None => ended,
    }
}

fn collect<N, const NQ: usize, const NV: usize, const NU: usize>(
    run: impl Iterator<Item = Result<Sample<N, NQ, NV, NU>, Error>>,
    samples: &mut [N],
    count: &mut usize,
) -> Result<(), Failure>
where
    N: Number,
{
    let rows = samples.chunks_exact_mut(1 + NQ + NV + NU);
    for (row, sample) in rows.zip(run) {
        let sample = sample.map_err(Failure::of)?;
        let numbers = sample.q.iter().chain(&sample.v).chain(&sample.u);
        let numbers = std::iter::once(&sample.t).chain(numbers);
        row.iter_mut().zip(numbers).for_each(|(place, number)| *place = *number);
        *count += 1;
    }
    Ok(())
}
