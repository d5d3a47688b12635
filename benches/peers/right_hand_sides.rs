//! The problems of `linkwork_benches::precision` as a shared library, for `integrators.py`.

#![allow(unsafe_code, reason = "arrays come from another language")]

use linkwork_benches::precision;
use std::slice::{from_raw_parts, from_raw_parts_mut};

/// How many numbers the state of a problem has; zero where there is no such problem.
#[unsafe(no_mangle)]
pub extern "C" fn dimension(problem: usize) -> usize {
    if problem < precision::PROBLEMS.len() { precision::start(problem).0.len() } else { 0 }
}

/// Writes the state at the beginning, and gives the time of the end.
///
/// # Safety
///
/// `y` has room for as many numbers as [`dimension`] says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn begin(problem: usize, y: *mut f64) -> f64 {
    let (state, end) = precision::start(problem);
    // SAFETY: the caller's promise.
    unsafe { from_raw_parts_mut(y, state.len()) }.copy_from_slice(&state);
    end
}

/// Writes how a state of `n` numbers changes.
///
/// # Safety
///
/// `y` and `rate` have `n` numbers, as many as [`dimension`] says, and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rate(problem: usize, t: f64, y: *const f64, rate: *mut f64, n: usize) {
    // SAFETY: the caller's promise.
    let (y, rate) = unsafe { (from_raw_parts(y, n), from_raw_parts_mut(rate, n)) };
    precision::rate(problem, t, y, rate);
}
