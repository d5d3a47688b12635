//! Flight mechanisms of the gallery: trim, modes and derivatives against published values and closed-form
//! solutions.

#[path = "flight/craft.rs"]
mod craft;
#[path = "flight/cruise.rs"]
mod cruise;
#[path = "flight/fighter.rs"]
mod fighter;

use linkwork_design::Mode;

/// Checks that a number equals another within a relative tolerance.
#[track_caller]
pub fn assert_relatively_close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "expected {expected}, found {found}");
}

/// Checks that a mode has the eigenvalue `re + i im`, within a tolerance relative to its magnitude.
#[track_caller]
pub fn assert_mode_eigenvalue(mode: Option<&Mode>, re: f64, im: f64, relative: f64) {
    let pole = mode.expect("the mode is there").exponent;
    let error = (pole.re - re).hypot(pole.im - im);
    assert!(
        error <= relative * re.hypot(im),
        "expected {re} {im:+}i, found {pole}: {:.1e}",
        error / re.hypot(im)
    );
}
