//! Assertions and other functions that tests of several mechanisms use.

use linkwork::integrate::DormandPrince;
use linkwork::nalgebra::{Isometry3, Rotation3, SMatrix, Translation3, Vector3};

use std::f64::consts::FRAC_PI_2;

/// Checks a generated matrix against its closed form. The tolerance is relative to the largest entry, but
/// absolute if this is below one.
#[track_caller]
pub fn assert_near<const R: usize, const C: usize>(
    found: SMatrix<f64, R, C>,
    expected: SMatrix<f64, R, C>,
    tolerance: f64,
) {
    let error = (found - expected).amax() / expected.amax().max(1.0);
    assert!(error <= tolerance, "error {error:e}: found {found} expected {expected}");
}

/// Checks a generated number against its closed form. The tolerance is relative to the number, but absolute
/// if this is below one.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(error <= tolerance, "error {error:e}: found {found}, expected {expected}");
}

/// Returns a Dormand–Prince integrator with a tolerance of 1e-12.
pub fn precise_integrator() -> DormandPrince<f64> {
    DormandPrince::new().tolerance(1e-12, 1e-12)
}

/// Returns the complete elliptic integral of the first kind by the arithmetic–geometric mean:
/// `K(k) = ½π / agm(1, √(1 − k²))`, for the argument `k²`.
pub fn elliptic_integral(k2: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k2).sqrt());
    while (a - b).abs() > 1e-15 * a {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// Returns the pose of a rotation about z and a displacement along z: one half of a Denavit–Hartenberg step.
pub fn about_z(angle: f64, d: f64) -> Isometry3<f64> {
    pose_about_axis(Vector3::z(), angle, d)
}

/// Returns a rotation about x and a displacement along it: the other half of a Denavit–Hartenberg step.
pub fn about_x(angle: f64, a: f64) -> Isometry3<f64> {
    pose_about_axis(Vector3::x(), angle, a)
}

fn pose_about_axis(axis: Vector3<f64>, angle: f64, distance: f64) -> Isometry3<f64> {
    let turn = Rotation3::new(axis * angle);
    Isometry3::from_parts(Translation3::from(axis * distance), turn.into())
}
