use crate::testing::{assert_acceleration_derivatives, assert_matrix_close, assert_number_close};
use linkwork::nalgebra::{Complex, SMatrix};
use linkwork::prelude::*;
use linkwork::{LinearMotion, at};
use linkwork_models::DelayedServo;

const S: DelayedServo = DelayedServo {
    inertia: 0.02,
    friction: 0.01,
    delay: 0.05,
    kp: 1.5,
    ki: 2.0,
    kd: 0.15,
    bandwidth: 60.0,
    limit: 0.8,
    tracking: 5.0,
    filtered: 0.0,
    drift: 0.0,
    smoothed: 0.0,
    integral: 0.0,
};

/// Speed of the rotor, and the states of the servo in the order of their declaration.
type ServoState = SVector<f64, 5>;

fn linearised_servo_motion(v: &ServoState, target: f64) -> LinearMotion<f64, 5, 1> {
    at(&S.extended(), 0.0).linear_motion(&[0.0].into(), v, &[target].into())
}

/// Returns the system matrix of the linearised motion of angle, speed and states.
fn servo_system_matrix(linear: &LinearMotion<f64, 5, 1>) -> SMatrix<f64, 6, 6> {
    let mut a = SMatrix::<f64, 6, 6>::zeros();
    a[(0, 1)] = 1.0;
    a.fixed_view_mut::<5, 1>(1, 0).copy_from(&linear.by_q.fixed_view::<5, 1>(0, 0));
    a.fixed_view_mut::<5, 5>(1, 1).copy_from(&linear.by_v);
    a
}

#[test]
fn servo_has_the_expected_characteristic_polynomial() {
    let v = [0.3, 0.01, -0.1, 0.02, 0.04].into();
    assert_acceleration_derivatives(&S.extended(), &[0.1].into(), &v, &[0.05].into(), 1e-6);
    let a = servo_system_matrix(&linearised_servo_motion(&v, 0.0)).map(|x| Complex::new(x, 0.0));
    for s in [Complex::new(2.0, 0.0), Complex::new(-3.0, 8.0), Complex::new(0.0, 40.0)] {
        let delay = s * s * (0.05 * 0.05 / 12.0) + s * 0.025 + 1.0;
        let pid = (s * 1.5 + 2.0) * (s + 60.0) + s * s * (0.15 * 60.0);
        let expected = delay * s * (s * s * 0.02 + s * 0.01) * (s + 60.0) + (delay - s * 0.05) * pid;
        let scale = 0.02 * 0.05 * 0.05 / 12.0;
        let found = (SMatrix::<_, 6, 6>::identity() * s - a).determinant() * scale;
        assert!((found - expected).norm() < 1e-12 * expected.norm(), "{found} {expected}");
    }
}

#[test]
fn servo_delay_changes_only_the_phase() {
    let a = servo_system_matrix(&linearised_servo_motion(&ServoState::zeros(), 0.0));
    for omega in [1.0, 10.0, 40.0] {
        let s = Complex::new(0.0, omega);
        // Response of the rate of the filtered angle to the angle.
        let (by_angle, by_filtered, by_drift) = (a[(3, 0)], a[(3, 2)], a[(3, 3)]);
        let drift = Complex::from(by_angle) / (s - by_drift - Complex::from(by_filtered) / s);
        let delayed = Complex::new(1.0, 0.0) - drift * 0.05;
        assert_number_close(delayed.norm(), 1.0, 1e-13);
        let x = omega * 0.05;
        assert_number_close(delayed.arg(), -2.0 * (x / 2.0).atan2(1.0 - x * x / 12.0), 1e-13);
        assert!((delayed.arg() + x).abs() < x.powi(5) / 720.0);
    }
}

#[test]
fn servo_integral_stops_at_the_limit() -> Result<(), Error> {
    // Rotor at rest, far from the target.
    let heavy = DelayedServo { inertia: 1e12, ..S };
    let whole = heavy.extended();
    let run = simulate(&whole).from([0.0], ServoState::zeros()).inputs(|_, _, _| [3.0].into());
    let end = run.duration(6.0).finish()?;
    // The demand is kp e + integral, once the differential part has decayed.
    assert_number_close(1.5 * 3.0 + end.v[4], 0.8 + 2.0 * 3.0 / 5.0, 1e-6);
    let a = linearised_servo_motion(&end.v, 3.0);
    assert_number_close(a.acceleration[0], 0.8 / 0.02, 1e-12);
    // Under saturation the torque depends only on the speed, through friction.
    assert_matrix_close(
        a.by_v.row(0).into_owned(),
        SMatrix::from_row_slice(&[-0.5, 0.0, 0.0, 0.0, 0.0]),
        1e-13,
    );
    Ok(())
}
