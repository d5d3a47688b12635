//! The border: what the functions of a library with C's calling convention do. This module alone handles
//! pointers, and no panic leaves it.
#![allow(unsafe_code, reason = "the border to callers in other languages, who hand over pointers")]

use crate::{Batch, Every, Failure, Library, Motion, Rollout, Way};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

/// What functions return when all went well.
pub const DONE: c_int = 0;
/// What functions return when there is a message.
pub const FAILED: c_int = 1;

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Why the last call of this thread that returned [`FAILED`] did so. It stays until the next call.
pub fn message() -> *const c_char {
    MESSAGE.with_borrow(|message| message.as_ptr())
}

fn ended(result: std::thread::Result<Result<(), Failure>>) -> c_int {
    let result = result.unwrap_or_else(|panic| Err(Failure::of_panic(panic.as_ref())));
    let Err(Failure(why)) = result else { return DONE };
    let text = CString::new(why.replace('\0', " ")).unwrap_or_default();
    MESSAGE.with_borrow_mut(|message| *message = text);
    FAILED
}

/// # Safety
///
/// `from` points to `length` numbers that nobody writes meanwhile, or `length` is zero.
unsafe fn numbers<'a, N>(from: *const N, length: usize) -> &'a [N] {
    match length {
        0 => &[],
        // SAFETY: as above.
        _ => unsafe { slice::from_raw_parts(from, length) },
    }
}

/// # Safety
///
/// `to` points to `length` numbers that nobody else uses meanwhile, or `length` is zero.
unsafe fn places<'a, N>(to: *mut N, length: usize) -> &'a mut [N] {
    match length {
        0 => &mut [],
        // SAFETY: as above.
        _ => unsafe { slice::from_raw_parts_mut(to, length) },
    }
}

/// A function by its number, for many states; [`crate::call`].
///
/// # Safety
///
/// `parameters` points to as many numbers as the mechanism has parameters; `arguments` and `results` to as
/// many pointers as the function has arguments and results, each to its numbers of all states. Nobody else
/// uses the results meanwhile, and they do not overlap.
pub unsafe fn call<M: Library>(
    function: usize,
    parameters: *const M::Number,
    arguments: *const *const M::Number,
    results: *const *mut M::Number,
    states: usize,
    threads: usize,
) -> c_int {
    ended(catch_unwind(AssertUnwindSafe(|| {
        let Some(f) = M::FUNCTIONS.get(function) else {
            return Err(Failure::of("there is no function with this number"));
        };
        let fits = |one: &usize| one.checked_mul(states).is_some_and(|all| all < isize::MAX as usize / 8);
        if !f.arguments.iter().chain(f.results).all(fits) {
            return Err(Failure::of("there are too many states"));
        }
        // SAFETY: the caller promises all of it.
        let (m, arguments, results) = unsafe {
            let own = numbers(arguments, f.arguments.len());
            let given = f.arguments.iter().zip(own).map(|(one, from)| numbers(*from, one * states));
            let own = numbers(results, f.results.len());
            let wanted = f.results.iter().zip(own).map(|(one, to)| places(*to, one * states));
            (M::with(numbers(parameters, M::PARAMETERS)), given.collect(), wanted.collect())
        };
        crate::call(&m, f, Batch { arguments, results, states, threads })
    })))
}

/// Whether a mechanism can have these parameters.
///
/// # Safety
///
/// `parameters` points to as many numbers as the mechanism has parameters.
pub unsafe fn check<M: Library>(parameters: *const M::Number) -> c_int {
    ended(catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the caller promises it.
        M::with(unsafe { numbers(parameters, M::PARAMETERS) }).check()
    })))
}

/// Copies numbers out.
///
/// # Safety
///
/// `to` points to as many numbers.
pub unsafe fn copy<N: Copy>(from: &[N], to: *mut N) {
    // SAFETY: the caller promises it.
    unsafe { places(to, from.len()) }.copy_from_slice(from);
}

/// A controller in another language: what it was registered with, time, configuration, velocity, and where
/// the inputs go. It returns zero, or anything else to end the run.
pub type Controller<N> = unsafe extern "C" fn(*mut c_void, N, *const N, *const N, *mut N) -> c_int;

/// Settings of a simulation.
#[repr(C)]
pub struct Settings<N> {
    /// Time at the start, s.
    pub start: N,
    /// How long, s.
    pub duration: N,
    /// Time between samples, s.
    pub interval: N,
    /// The method by name: `dormand_prince`, `dormand_prince8`, `rodas`, `event_driven`, each with its
    /// tolerance; `rk4`, `implicit_midpoint`, `time_stepping`, `time_stepping_midpoint`, each with its step,
    /// s.
    pub method: *const c_char,
    /// The tolerance or the step.
    pub setting: N,
    /// Time between calls of the controller, s; zero if it is called whenever the dynamics are evaluated.
    pub period: N,
    /// The controller, or none.
    pub control: Option<Controller<N>>,
    /// What the controller is given first.
    pub user: *mut c_void,
}

/// Simulates, with samples of time, configuration, velocity and inputs in rows.
///
/// # Safety
///
/// `parameters`, `q` and `v` point to as many numbers as the mechanism has of them, `settings` to settings
/// whose method is a text that ends with zero, `samples` to so many rows, `count` to a number. The controller
/// can be called with the arrays of a state, and does not unwind.
#[allow(clippy::too_many_arguments, reason = "the signature of the library")]
pub unsafe fn simulate<M: Library>(
    [nq, nv, nu]: [usize; 3],
    parameters: *const M::Number,
    q: *const M::Number,
    v: *const M::Number,
    settings: *const Settings<M::Number>,
    samples: *mut M::Number,
    rows: usize,
    count: *mut usize,
) -> c_int {
    // SAFETY: the caller promises all of it.
    let (m, settings, q, v, samples, count, method) = unsafe {
        let settings = &*settings;
        *count = 0;
        let width = 1 + nq + nv + nu;
        (
            M::with(numbers(parameters, M::PARAMETERS)),
            settings,
            numbers(q, nq),
            numbers(v, nv),
            places(samples, rows * width),
            &mut *count,
            CStr::from_ptr(settings.method),
        )
    };
    ended(catch_unwind(AssertUnwindSafe(|| {
        let way = way(method, settings.setting)?;
        let zero = linkwork::nalgebra::zero::<M::Number>();
        let every = if settings.period > zero { Every::Period(settings.period) } else { Every::Evaluation };
        let mut control = |t: M::Number, q: &[M::Number], v: &[M::Number], u: &mut [M::Number]| {
            let Some(control) = settings.control else { return Ok(()) };
            // SAFETY: the caller promises it.
            match unsafe { control(settings.user, t, q.as_ptr(), v.as_ptr(), u.as_mut_ptr()) } {
                0 => Ok(()),
                _ => Err(Failure::of("the controller ended the run")),
            }
        };
        let mut motion = Motion {
            start: settings.start,
            q,
            v,
            duration: settings.duration,
            interval: settings.interval,
            way,
            every,
            control: &mut control,
            samples,
            count: 0,
        };
        let ended = m.simulate(&mut motion);
        *count = motion.count;
        ended
    })))
}

/// Settings of a rollout.
#[repr(C)]
pub struct RolloutSettings<N> {
    /// Time at the start, s.
    pub start: N,
    /// Length of a step, s.
    pub step: N,
    /// How many steps.
    pub steps: usize,
    /// How many states.
    pub states: usize,
    /// How many threads; as many as there are processors for zero.
    pub threads: usize,
    /// Whose inputs are given: 0 none, 1 those of each step for all states, 2 those of each state and step.
    pub inputs_of: c_int,
}

/// Takes many states through many steps.
///
/// # Safety
///
/// `parameters` points to as many numbers as the mechanism has parameters; `q` and `v` to `steps + 1`
/// configurations and velocities of each state, which nobody else uses meanwhile; `inputs` to those that the
/// settings name.
pub unsafe fn roll_out<M: Library>(
    [nq, nv, nu]: [usize; 3],
    parameters: *const M::Number,
    settings: *const RolloutSettings<M::Number>,
    inputs: *const M::Number,
    q: *mut M::Number,
    v: *mut M::Number,
) -> c_int {
    // SAFETY: the caller promises all of it.
    let settings = unsafe { &*settings };
    ended(catch_unwind(AssertUnwindSafe(|| {
        let RolloutSettings { start, step, steps, states, threads, inputs_of } = *settings;
        let rows = steps.checked_add(1).and_then(|rows| rows.checked_mul(states));
        let most = isize::MAX as usize / 8;
        let Some(rows) = rows.filter(|rows| rows.checked_mul(nq.max(nv).max(nu)).is_some_and(|n| n < most))
        else {
            return Err(Failure::of("there are too many states and steps"));
        };
        let length = match inputs_of {
            1 => steps * nu,
            2 => steps * nu * states,
            _ => 0,
        };
        // SAFETY: the caller promises all of it.
        let (m, q, v, inputs) = unsafe {
            (
                M::with(numbers(parameters, M::PARAMETERS)),
                places(q, rows * nq),
                places(v, rows * nv),
                numbers(inputs, length),
            )
        };
        m.roll_out(Rollout { start, step, steps, threads, q, v, inputs, own_inputs: inputs_of == 2 })
    })))
}

fn way<N>(method: &CStr, setting: N) -> Result<Way<N>, Failure> {
    Ok(match method.to_str().unwrap_or_default() {
        "dormand_prince" => Way::DormandPrince(setting),
        "dormand_prince8" => Way::DormandPrince8(setting),
        "rodas" => Way::Rodas(setting),
        "rk4" => Way::Rk4(setting),
        "implicit_midpoint" => Way::ImplicitMidpoint(setting),
        "event_driven" => Way::EventDriven(setting),
        "time_stepping" => Way::TimeStepping(setting),
        "time_stepping_midpoint" => Way::TimeSteppingMidpoint(setting),
        other => {
            return Err(Failure(format!(
                "there is no method `{other}`, but dormand_prince, dormand_prince8, rodas, rk4, implicit_midpoint, event_driven, time_stepping, time_stepping_midpoint"
            )));
        }
    })
}
