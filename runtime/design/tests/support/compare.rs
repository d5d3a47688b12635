//! Comparison of numbers, for tests.

/// Panics unless a number agrees with its expected value to a relative tolerance. Expected values below 1e-3
/// count as 1e-3.
#[track_caller]
pub fn assert_relatively_close(found: f64, expected: f64, relative: f64) {
    let allowed = relative * expected.abs().max(1e-3);
    assert!((found - expected).abs() <= allowed, "expected {expected}, found {found}");
}
