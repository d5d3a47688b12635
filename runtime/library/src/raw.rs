//! C interface: implementations of the exported functions with the C calling convention. Only this module
//! handles pointers, and no panic leaves it.
#![allow(unsafe_code, reason = "the border to callers in other languages, who hand over pointers")]

use crate::{Batch, Every, Failure, Library, Motion, Rollout, Way};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

/// Return value of a C call that succeeded.
pub const DONE: c_int = 0;
/// Return value of a call that failed and set a message.
pub const FAILED: c_int = 1;

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Returns the message of the last call of this thread that returned [`FAILED`]. The pointer is valid until
/// the next call of this thread.
pub fn message() -> *const c_char {
    MESSAGE.with_borrow(|message| message.as_ptr())
}

fn return_code_of_result(result: std::thread::Result<Result<(), Failure>>) -> c_int {
    let result = result.unwrap_or_else(|panic| Err(Failure::failure_from_panic(panic.as_ref())));
    let Err(Failure(why)) = result else { return DONE };
    let text = CString::new(why.replace('\0', " ")).unwrap_or_default();
    MESSAGE.with_borrow_mut(|message| *message = text);
    FAILED
}

/// # Safety
///
/// `from` points to `length` numbers that are not written to during the lifetime of the result, or `length`
/// is zero.
unsafe fn numbers_from_pointer<'a, N>(from: *const N, length: usize) -> &'a [N] {
    match length {
        0 => &[],
        // SAFETY: see the requirements of this function.
        _ => unsafe { slice::from_raw_parts(from, length) },
    }
}

/// # Safety
///
/// `to` points to `length` numbers that are not accessed otherwise during the lifetime of the result, or
/// `length` is zero.
unsafe fn mutable_numbers_from_pointer<'a, N>(to: *mut N, length: usize) -> &'a mut [N] {
    match length {
        0 => &mut [],
        // SAFETY: see the requirements of this function.
        _ => unsafe { slice::from_raw_parts_mut(to, length) },
    }
}

/// Calls the function with this index for many states; see [`crate::call`].
///
/// # Safety
///
/// `parameters` points to one number per parameter of the mechanism. `arguments` and `results` point to one
/// pointer per argument and result of the function, each to the numbers of all states. The results are not
/// accessed otherwise during the call, and do not overlap.
pub unsafe fn call<M: Library>(
    function: usize,
    parameters: *const M::Number,
    arguments: *const *const M::Number,
    results: *const *mut M::Number,
    states: usize,
    threads: usize,
) -> c_int {
    return_code_of_result(catch_unwind(AssertUnwindSafe(|| {
        let Some(f) = M::FUNCTIONS.get(function) else {
            return Err(Failure::new("there is no function with this number"));
        };
        let fits_in_memory =
            |one: &usize| one.checked_mul(states).is_some_and(|all| all < isize::MAX as usize / 8);
        if !f.arguments.iter().chain(f.results).all(fits_in_memory) {
            return Err(Failure::new("there are too many states"));
        }
        // SAFETY: guaranteed by the caller.
        let (m, arguments, results) = unsafe {
            let own = numbers_from_pointer(arguments, f.arguments.len());
            let given =
                f.arguments.iter().zip(own).map(|(one, from)| numbers_from_pointer(*from, one * states));
            let own = numbers_from_pointer(results, f.results.len());
            let wanted =
                f.results.iter().zip(own).map(|(one, to)| mutable_numbers_from_pointer(*to, one * states));
            (
                M::from_parameters(numbers_from_pointer(parameters, M::PARAMETERS)),
                given.collect(),
                wanted.collect(),
            )
        };
        crate::call(&m, f, Batch { arguments, results, states, threads })
    })))
}

/// Checks whether a physical mechanism can have the values of the parameters.
///
/// # Safety
///
/// `parameters` points to one number per parameter of the mechanism.
pub unsafe fn check<M: Library>(parameters: *const M::Number) -> c_int {
    return_code_of_result(catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: guaranteed by the caller.
        M::from_parameters(unsafe { numbers_from_pointer(parameters, M::PARAMETERS) }).check()
    })))
}

/// Copies numbers to an array of the calling program.
///
/// # Safety
///
/// `to` points to an array of at least `from.len()` numbers.
pub unsafe fn copy<N: Copy>(from: &[N], to: *mut N) {
    // SAFETY: guaranteed by the caller.
    unsafe { mutable_numbers_from_pointer(to, from.len()) }.copy_from_slice(from);
}

/// Controller in another language. Its arguments are the pointer that it was registered with, time,
/// configuration, velocity, and the array for the inputs. It returns zero, or a nonzero value to end the run.
pub type Controller<N> = unsafe extern "C" fn(*mut c_void, N, *const N, *const N, *mut N) -> c_int;

/// Settings of a simulation that is called from C.
#[repr(C)]
pub struct Settings<N> {
    /// Initial time of the simulation, s.
    pub start: N,
    /// Duration of the simulation, s.
    pub duration: N,
    /// Time between samples of the simulation, s.
    pub interval: N,
    /// Name of the method: `dormand_prince`, `dormand_prince8`, `rodas`, `event_driven`, each with its
    /// tolerance; `rk4`, `implicit_midpoint`, `time_stepping`, `time_stepping_midpoint`,
    /// `time_stepping_leapfrog`, each with its step size, s.
    pub method: *const c_char,
    /// Tolerance or step size of the integration method.
    pub setting: N,
    /// Interval between calls of the controller of the simulation, s; zero to call it at every evaluation of
    /// the dynamics.
    pub period: N,
    /// Controller that computes the inputs of the simulation, if any.
    pub control: Option<Controller<N>>,
    /// Pointer that is passed to the controller as its first argument.
    pub user: *mut c_void,
}

/// Simulates a mechanism, and writes samples as rows of time, configuration, velocity and inputs.
///
/// # Safety
///
/// `parameters`, `q` and `v` point to one number per parameter and per entry, `settings` to settings whose
/// method is a null-terminated string, `samples` to `rows` rows, `count` to a number. The controller can be
/// called with the arrays of a state, and does not unwind.
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
    // SAFETY: guaranteed by the caller.
    let (m, settings, q, v, samples, count, method) = unsafe {
        let settings = &*settings;
        *count = 0;
        let width = 1 + nq + nv + nu;
        (
            M::from_parameters(numbers_from_pointer(parameters, M::PARAMETERS)),
            settings,
            numbers_from_pointer(q, nq),
            numbers_from_pointer(v, nv),
            mutable_numbers_from_pointer(samples, rows * width),
            &mut *count,
            CStr::from_ptr(settings.method),
        )
    };
    return_code_of_result(catch_unwind(AssertUnwindSafe(|| {
        let way = method_from_name(method, settings.setting)?;
        let zero = linkwork::nalgebra::zero::<M::Number>();
        let every = if settings.period > zero { Every::Period(settings.period) } else { Every::Evaluation };
        let mut call_foreign_controller =
            |t: M::Number, q: &[M::Number], v: &[M::Number], u: &mut [M::Number]| {
                let Some(control) = settings.control else { return Ok(()) };
                // SAFETY: guaranteed by the caller.
                match unsafe { control(settings.user, t, q.as_ptr(), v.as_ptr(), u.as_mut_ptr()) } {
                    0 => Ok(()),
                    _ => Err(Failure::new("the controller ended the run")),
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
            control: &mut call_foreign_controller,
            samples,
            count: 0,
        };
        let ended = m.simulate(&mut motion);
        *count = motion.count;
        ended
    })))
}

/// Settings of a rollout that is called from C: many states advanced by many steps.
#[repr(C)]
pub struct RolloutSettings<N> {
    /// Initial time of the rollout, s.
    pub start: N,
    /// Duration of one step of the rollout, s.
    pub step: N,
    /// Number of steps of the rollout.
    pub steps: usize,
    /// Number of states that are advanced.
    pub states: usize,
    /// Number of threads of the rollout; zero for the number of processors.
    pub threads: usize,
    /// Layout of the inputs: 0 none, 1 common to all states for each step, 2 separate for each state and
    /// step.
    pub inputs_of: c_int,
}

/// Advances many states of a mechanism by many steps.
///
/// # Safety
///
/// `parameters` points to one number per parameter of the mechanism; `q` and `v` to `steps + 1`
/// configurations and velocities of each state, which are not accessed otherwise during the call; `inputs` to
/// the inputs in the layout of the settings.
pub unsafe fn roll_out<M: Library>(
    [nq, nv, nu]: [usize; 3],
    parameters: *const M::Number,
    settings: *const RolloutSettings<M::Number>,
    inputs: *const M::Number,
    q: *mut M::Number,
    v: *mut M::Number,
) -> c_int {
    // SAFETY: guaranteed by the caller.
    let settings = unsafe { &*settings };
    return_code_of_result(catch_unwind(AssertUnwindSafe(|| {
        let RolloutSettings { start, step, steps, states, threads, inputs_of } = *settings;
        let rows = steps.checked_add(1).and_then(|rows| rows.checked_mul(states));
        let most = isize::MAX as usize / 8;
        let Some(rows) = rows.filter(|rows| rows.checked_mul(nq.max(nv).max(nu)).is_some_and(|n| n < most))
        else {
            return Err(Failure::new("there are too many states and steps"));
        };
        let length = match inputs_of {
            1 => steps * nu,
            2 => steps * nu * states,
            _ => 0,
        };
        // SAFETY: guaranteed by the caller.
        let (m, q, v, inputs) = unsafe {
            (
                M::from_parameters(numbers_from_pointer(parameters, M::PARAMETERS)),
                mutable_numbers_from_pointer(q, rows * nq),
                mutable_numbers_from_pointer(v, rows * nv),
                numbers_from_pointer(inputs, length),
            )
        };
        m.roll_out(Rollout { start, step, steps, threads, q, v, inputs, own_inputs: inputs_of == 2 })
    })))
}

fn method_from_name<N>(method: &CStr, setting: N) -> Result<Way<N>, Failure> {
    Ok(match method.to_str().unwrap_or_default() {
        "dormand_prince" => Way::DormandPrince(setting),
        "dormand_prince8" => Way::DormandPrince8(setting),
        "rodas" => Way::Rodas(setting),
        "rk4" => Way::Rk4(setting),
        "implicit_midpoint" => Way::ImplicitMidpoint(setting),
        "event_driven" => Way::EventDriven(setting),
        "time_stepping" => Way::TimeStepping(setting),
        "time_stepping_midpoint" => Way::TimeSteppingMidpoint(setting),
        "time_stepping_leapfrog" => Way::TimeSteppingLeapfrog(setting),
        other => {
            return Err(Failure(format!(
                "there is no method `{other}`; the methods are dormand_prince, dormand_prince8, rodas, rk4, implicit_midpoint, event_driven, time_stepping, time_stepping_midpoint, time_stepping_leapfrog"
            )));
        }
    })
}
