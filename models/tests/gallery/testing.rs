//! Assertions and other functions that tests of several mechanisms use.

use linkwork::integrate::DormandPrince;
use linkwork::nalgebra::{Isometry3, Rotation3, SMatrix, SVector, Translation3, Vector3};
use linkwork::{Derivatives, at};

use std::f64::consts::FRAC_PI_2;

/// Checks a generated matrix against its closed form. The tolerance is relative to the largest entry, but
/// absolute if this is below one.
#[track_caller]
pub fn assert_matrix_close<const R: usize, const C: usize>(
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
pub fn assert_number_close(found: f64, expected: f64, tolerance: f64) {
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
pub fn pose_along_and_about_z(angle: f64, d: f64) -> Isometry3<f64> {
    pose_along_and_about_axis(Vector3::z(), angle, d)
}

/// Returns a rotation about x and a displacement along it: the other half of a Denavit–Hartenberg step.
pub fn pose_along_and_about_x(angle: f64, a: f64) -> Isometry3<f64> {
    pose_along_and_about_axis(Vector3::x(), angle, a)
}

fn pose_along_and_about_axis(axis: Vector3<f64>, angle: f64, distance: f64) -> Isometry3<f64> {
    let turn = Rotation3::new(axis * angle);
    Isometry3::from_parts(Translation3::from(axis * distance), turn.into())
}

/// Checks the derivatives of the accelerations with respect to configuration, velocities and inputs against
/// central differences, relative to the largest entry of each block.
#[track_caller]
pub fn assert_acceleration_derivatives<M, const NV: usize, const NU: usize, const NQ: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    u: &SVector<f64, NU>,
    tolerance: f64,
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    const STEP: f64 = 1e-6;
    let linear = at(m, 0.0).linear_motion(q, v, u);
    let acceleration_at_state = |q: &SVector<f64, NQ>, v: &SVector<f64, NV>, u: &SVector<f64, NU>| {
        m.forward_dynamics(0.0, q, v, &m.generalized_forces(0.0, q, v, u))
    };
    let difference_quotient = |a: SVector<f64, NV>, b: SVector<f64, NV>| (a - b) / (2.0 * STEP);
    let (mut by_q, mut by_v, mut by_u) = (linear.by_q, linear.by_v, linear.by_u);
    for k in 0..NV {
        let step = SVector::from_fn(|i, _| if i == k { STEP } else { 0.0 });
        let displaced_configuration = |step| m.integrate(q, &step);
        let [above, below] =
            [step, -step].map(|step| acceleration_at_state(&displaced_configuration(step), v, u));
        by_q.set_column(k, &difference_quotient(above, below));
        by_v.set_column(
            k,
            &difference_quotient(
                acceleration_at_state(q, &(v + step), u),
                acceleration_at_state(q, &(v - step), u),
            ),
        );
    }
    for k in 0..NU {
        let step = SVector::from_fn(|i, _| if i == k { STEP } else { 0.0 });
        by_u.set_column(
            k,
            &difference_quotient(
                acceleration_at_state(q, v, &(u + step)),
                acceleration_at_state(q, v, &(u - step)),
            ),
        );
    }
    assert_matrix_close(linear.by_q, by_q, tolerance);
    assert_matrix_close(linear.by_v, by_v, tolerance);
    assert_matrix_close(linear.by_u, by_u, tolerance);
}
