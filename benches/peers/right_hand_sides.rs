//! The problems of `linkwork_benches::precision` as a shared library, for `integrators.py`.

#![allow(unsafe_code, reason = "arrays come from another language")]

use linkwork_benches::precision;
use std::slice::{from_raw_parts, from_raw_parts_mut};

/// Returns the number of entries of a problem's state; zero for a problem that does not exist.
#[unsafe(no_mangle)]
pub extern "C" fn dimension(problem: usize) -> usize {
    if problem < precision::PROBLEMS.len() {
        precision::initial_state_and_final_time(problem).0.len()
    } else {
        0
    }
}

/// Writes the initial state, and returns the final time in seconds.
///
/// # Safety
///
/// `y` must have room for [`dimension`] numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn begin(problem: usize, y: *mut f64) -> f64 {
    let (state, end) = precision::initial_state_and_final_time(problem);
    // SAFETY: the caller guarantees the size of `y`.
    unsafe { from_raw_parts_mut(y, state.len()) }.copy_from_slice(&state);
    end
}

/// Writes the rate of a state of `n` numbers.
///
/// # Safety
///
/// `y` and `rate` must have `n` = [`dimension`] numbers and must not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rate(problem: usize, t: f64, y: *const f64, rate: *mut f64, n: usize) {
    // SAFETY: the caller guarantees the sizes of `y` and `rate`.
    let (y, rate) = unsafe { (from_raw_parts(y, n), from_raw_parts_mut(rate, n)) };
    precision::write_rate_of_state(problem, t, y, rate);
}
