//! Calls of one generated function through plain arrays, for one state or many.

use crate::{Given, Library, Number, Sink};
use std::any::Any;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Number of SIMD lanes, which is the number of states that are evaluated together.
pub const LANES: usize = 8;

/// Maximum number of arguments of a function, and maximum number of its results.
const MAX_ARGUMENTS: usize = 12;

/// Error message of a failed call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure(pub String);

impl Failure {
    /// Creates a failure with the message of an error.
    pub fn new(error: impl Display) -> Failure {
        Failure(error.to_string())
    }

    /// Creates a failure with the message of a panic, which is an internal error.
    pub(crate) fn failure_from_panic(panic: &(dyn Any + Send)) -> Failure {
        let text = panic.downcast_ref::<&str>().copied();
        let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        Failure(format!("internal error: {}", text.unwrap_or("a panic")))
    }
}

/// Function that evaluates a generated function: reads its arguments from arrays and writes its results to
/// arrays.
pub type Body<M> = fn(
    &M,
    Given<'_, <M as Library>::Number>,
    &mut Sink<'_, '_, <M as Library>::Number>,
) -> Result<(), Failure>;

/// Generated function with an interface of plain arrays.
#[derive(Clone, Copy)]
pub struct Function<M: Library> {
    /// Number of entries of each argument for one state.
    pub arguments: &'static [usize],
    /// Number of entries of each result for one state.
    pub results: &'static [usize],
    /// Body of the function that evaluates one state.
    pub one: Body<M>,
    /// Body of the function that evaluates eight states in SIMD lanes, if it exists.
    pub eight: Option<Body<M>>,
}

/// Argument and result arrays of a function for many states, one state after the other.
pub struct Batch<'a, N> {
    /// Argument arrays, one per argument, each with the values for all states of the batch.
    pub arguments: Vec<&'a [N]>,
    /// Result arrays, one per result, each with the values for all states of the batch.
    pub results: Vec<&'a mut [N]>,
    /// Number of states in the batch.
    pub states: usize,
    /// Number of threads that evaluate the batch; zero for the number of processors.
    pub threads: usize,
}

/// Calls a generated function for every state of a batch. Results of a state whose evaluation fails are NaN.
///
/// # Errors
///
/// An error for arrays of wrong lengths, before anything is written. Otherwise the first failure, after all
/// states are evaluated; its message contains the index of the state if there are several.
pub fn call<M: Library>(m: &M, f: &Function<M>, batch: Batch<'_, M::Number>) -> Result<(), Failure> {
    let Batch { arguments, results, states, threads } = batch;
    let lengths = f.arguments.iter().zip(arguments.iter().map(|array| array.len()));
    let lengths = lengths.chain(f.results.iter().zip(results.iter().map(|array| array.len())));
    let fit = arguments.len() == f.arguments.len() && results.len() == f.results.len();
    let fit = fit && f.arguments.len() <= MAX_ARGUMENTS && f.results.len() <= MAX_ARGUMENTS;
    if !fit || lengths.into_iter().any(|(one, all)| one.checked_mul(states) != Some(all)) {
        return Err(Failure::new("the arrays do not have the lengths that the function needs"));
    }
    if states == 1 {
        let (arguments, mut results) = (arguments, results);
        return call_guarded(m, f.one, &arguments, &mut results);
    }
    let share = states_per_thread(states, threads, LANES);
    let parts = distribute_states(f, &arguments, results, states, share);
    let first = match parts.len() {
        0 => None,
        1 => parts.into_iter().find_map(|part| evaluate_states(m, f, part)),
        _ => std::thread::scope(|scope| {
            let all: Vec<_> =
                parts.into_iter().map(|part| scope.spawn(move || evaluate_states(m, f, part))).collect();
            let ends = all.into_iter().map(|thread| {
                thread.join().unwrap_or_else(|panic| Some((0, Failure::failure_from_panic(panic.as_ref()))))
            });
            ends.flatten().min_by_key(|(state, _)| *state)
        }),
    };
    match first {
        None => Ok(()),
        Some((state, Failure(why))) => Err(Failure(format!("state {state}: {why}"))),
    }
}

/// Returns the number of states per thread, a multiple of the number of lanes.
pub(crate) fn states_per_thread(states: usize, threads: usize, lanes: usize) -> usize {
    let count_processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { count_processors() } else { threads };
    let groups = states.div_ceil(lanes);
    groups.div_ceil(threads.clamp(1, groups.max(1))).max(1) * lanes
}

/// Range of states in a batch that one thread evaluates.
struct StateRange<'a, N> {
    first: usize,
    states: usize,
    arguments: Vec<&'a [N]>,
    results: Vec<&'a mut [N]>,
}

fn distribute_states<'a, M: Library>(
    f: &Function<M>,
    arguments: &[&'a [M::Number]],
    mut rest: Vec<&'a mut [M::Number]>,
    states: usize,
    share: usize,
) -> Vec<StateRange<'a, M::Number>> {
    let mut parts = Vec::new();
    let mut first = 0;
    while first < states {
        let count = share.min(states - first);
        let taken = f.arguments.iter().zip(arguments);
        let arguments = taken.map(|(one, all)| &all[first * one..(first + count) * one]).collect();
        let (mut results, mut behind) = (Vec::new(), Vec::new());
        for (one, all) in f.results.iter().zip(rest) {
            let (front, back) = all.split_at_mut(count * one);
            results.push(front);
            behind.push(back);
        }
        rest = behind;
        parts.push(StateRange { first, states: count, arguments, results });
        first += count;
    }
    parts
}

/// Evaluates a function for the states of one thread. Returns the index of the first state that fails, with
/// the error.
fn evaluate_states<M: Library>(
    m: &M,
    f: &Function<M>,
    part: StateRange<'_, M::Number>,
) -> Option<(usize, Failure)> {
    let StateRange { first, states, arguments, results } = part;
    let mut failed = None;
    let mut at = 0;
    let mut results = results;
    // For few states, a call takes nanoseconds, which an allocation would double.
    let mut given: Vec<&[M::Number]> = Vec::with_capacity(arguments.len());
    let mut places: Vec<&mut [M::Number]> = Vec::with_capacity(results.len());
    while at < states {
        let (body, count) = match f.eight {
            Some(eight) if states - at >= LANES => (eight, LANES),
            _ => (f.one, 1),
        };
        given.clear();
        given.extend(f.arguments.iter().zip(&arguments).map(|(one, all)| &all[at * one..(at + count) * one]));
        places.clear();
        for (one, rest) in f.results.iter().zip(&mut results) {
            let (front, back) = std::mem::take(rest).split_at_mut(count * one);
            places.push(front);
            *rest = back;
        }
        if let Err(failure) = call_guarded(m, body, &given, &mut places) {
            failed.get_or_insert((first + at, failure));
        }
        at += count;
    }
    failed
}

/// Calls a generated function; if it fails or panics, the results are set to NaN.
fn call_guarded<M: Library>(
    m: &M,
    body: Body<M>,
    arguments: &[&[M::Number]],
    results: &mut [&mut [M::Number]],
) -> Result<(), Failure> {
    let done = catch_unwind(AssertUnwindSafe(|| body(m, Given(arguments), &mut Sink::new(results))));
    let done = done.unwrap_or_else(|panic| Err(Failure::failure_from_panic(panic.as_ref())));
    if done.is_err() {
        results.iter_mut().for_each(|array| array.fill(M::Number::NAN));
    }
    done
}
