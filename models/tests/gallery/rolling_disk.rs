use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::RollingDisk;

const D: RollingDisk = RollingDisk { g: 9.81, m: 2.0, radius: 0.4 };

/// Returns a state at the origin with a lean and an angular velocity `u` in the leaning axes, with the
/// contact point at rest.
fn leaning_state(lean: f64, u: [f64; 3]) -> (SVector<f64, 6>, SVector<f64, 6>) {
    let ((s, c), r) = (lean.sin_cos(), D.radius);
    let rates = [u[2] / c, u[0], u[1] - u[2] * s / c];
    let v = [r * u[1], -r * u[0] * c, -r * u[0] * s, rates[0], rates[1], rates[2]];
    ([0.0, 0.0, r * c, 0.0, lean, 0.7].into(), v.into())
}

#[test]
fn rolling_disk_accelerations_match_closed_form() {
    assert_eq!((RollingDisk::NC, RollingDisk::NH, RollingDisk::NP, RollingDisk::NS), (3, 1, 5, 3));
    let (lean, u): (f64, _) = (0.35, [0.7, -3.0, 1.3]);
    let (q, v) = leaning_state(lean, u);
    assert!(D.constraint_residuals(&q).amax() < 1e-15);
    assert!(D.constraint_rates(&q, &v).amax() < 1e-14);
    let (r, (s, c)) = (D.radius, lean.sin_cos());
    let rates = [
        (4.0 * D.g * s + 6.0 * r * u[1] * u[2] - r * u[2] * u[2] * s / c) / (5.0 * r),
        -2.0 * u[0] * u[2] / 3.0,
        (-2.0 * u[1] + u[2] * s / c) * u[0],
    ];
    let heading = (rates[2] + v[3] * s * v[4]) / c;
    let roll = rates[1] - heading * s - v[3] * c * v[4];
    let found = D.forward_dynamics(&q, &v, &SVector::zeros());
    assert_matrix_close(found.fixed_rows::<3>(3).into_owned(), [heading, rates[0], roll].into(), 1e-13);
}

/// Checks the stability of a rolling disk. Below the critical speed one exponent is positive; above it small
/// leans oscillate. The other exponents are zero.
#[test]
fn rolling_disk_is_stable_above_critical_speed() {
    let critical = (D.g * D.radius / 3.0).sqrt();
    for speed in [0.3 * critical, 0.99 * critical, 1.01 * critical, 3.0 * critical] {
        let (q, v) = leaning_state(0.0, [0.0, speed / D.radius, 0.0]);
        let linear = D.linearize(&q, &v, &SVector::zeros(), &[3, 4, 5]).expect("regular");
        assert_eq!(linear.speeds, [3, 4, 5]);
        let square = 4.0 * D.g / (5.0 * D.radius) - 2.4 * (speed / D.radius).powi(2);
        // Traces of the characteristic polynomial λ⁶ (λ² − s²).
        let squared = linear.a * linear.a;
        assert_number_close(linear.a.trace(), 0.0, 1e-12);
        assert_number_close(squared.trace(), 2.0 * square, 1e-12);
        assert_number_close((squared * linear.a).trace(), 0.0, 1e-12);
        assert_number_close((squared * squared).trace(), 2.0 * square * square, 1e-12);
        let growth = linear.a.complex_eigenvalues().iter().map(|e| e.re).fold(0.0, f64::max);
        assert_eq!(growth > 1e-2, speed < critical, "{growth} at {speed} m/s");
    }
}

/// Checks that the disk rolls in circles with a steady lean: `u₁` is constant.
#[test]
fn disk_rolls_in_circles() -> Result<(), Error> {
    let (lean, turning) = (0.3_f64, 2.5);
    let across = turning * lean.cos();
    let spin = (across * across * lean.tan() - 4.0 * D.g / D.radius * lean.sin()) / (6.0 * across);
    let (q, v) = leaning_state(lean, [0.0, spin, across]);
    let period = 2.0 * std::f64::consts::PI / turning;
    let end = simulate(&D).from(q, v).method(precise_integrator()).duration(period).finish()?;
    assert_matrix_close(end.v, v, 1e-9);
    assert_matrix_close(end.q.fixed_rows::<3>(0).into_owned(), q.fixed_rows::<3>(0).into_owned(), 1e-8);
    Ok(())
}
