use crate::testing::{assert_matrix_close, precise_integrator};
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::GravityGradientSatellite;
use std::f64::consts::TAU;

/// Test satellite of the Earth: up is x, forward y, across z.
const S: GravityGradientSatellite =
    GravityGradientSatellite { mu: 3.986004418e14, mass: 50.0, ixx: 5.0, iyy: 90.0, izz: 92.0 };

fn configuration_from_position_and_attitude(r: Vector3<f64>, turn: UnitQuaternion<f64>) -> SVector<f64, 7> {
    SVector::from([r.x, r.y, r.z, turn.i, turn.j, turn.k, turn.w])
}

#[test]
fn gravity_gradient_force_and_torque_match_theory() {
    let (r, turn) = (Vector3::new(4.1e6, -5.2e6, 1.7e6), UnitQuaternion::from_euler_angles(0.4, -0.8, 1.9));
    let h = S.bias_forces(&configuration_from_position_and_attitude(r, turn), &SVector::zeros());
    let own = turn.inverse() * r;
    let (distance, n) = (own.norm(), own.normalize());
    let weight = S.mu * S.mass / distance.powi(2) * n;
    assert_matrix_close(h.fixed_rows::<3>(0).into_owned() / weight.norm(), weight.normalize(), 1e-12);
    let inertia = Vector3::new(S.ixx, S.iyy, S.izz);
    let scale = 3.0 * S.mu / distance.powi(3);
    let torque = n.cross(&inertia.component_mul(&n));
    // The torque is a small difference of large terms, which costs only the last digits.
    assert_matrix_close(h.fixed_rows::<3>(3).into_owned() / scale, -torque, 1e-9);
}

#[test]
fn satellite_pitch_oscillates_at_textbook_frequency() -> Result<(), Error> {
    let frequency = (3.0 * (S.iyy - S.ixx) / S.izz).sqrt();
    check_pitch(S, TAU / frequency, |t| (frequency * t).cos())
}

/// Checks that a satellite with its long axis in the direction of flight is unstable, and that its pitch
/// grows exponentially.
#[test]
fn satellite_is_stable_with_long_axis_vertical() -> Result<(), Error> {
    let growth = (3.0 * (S.iyy - S.ixx) / S.izz).sqrt();
    check_pitch(GravityGradientSatellite { ixx: S.iyy, iyy: S.ixx, ..S }, 3.0 / growth, |t| {
        (growth * t).cosh()
    })
}

/// Checks the pitch of a satellite with an initial pitch of a thousandth of a radian, at eight samples,
/// against the expected function.
fn check_pitch(
    satellite: GravityGradientSatellite,
    duration: f64,
    expected: impl Fn(f64) -> f64,
) -> Result<(), Error> {
    // Units of the orbit: radius, gravitational parameter and rate are one. The satellite is so small that
    // its shape does not disturb the orbit.
    let tiny = 1e-11;
    let unit = GravityGradientSatellite {
        mu: 1.0,
        mass: 1.0,
        ixx: satellite.ixx * tiny,
        iyy: satellite.iyy * tiny,
        izz: satellite.izz * tiny,
    };
    let start = UnitQuaternion::from_euler_angles(0.0, 0.0, 1e-3);
    let v = start.inverse() * Vector3::new(0.0, 1.0, 0.0);
    // The pitch angle is that between x and the direction up.
    let pitch_angle = |q: &SVector<f64, 7>| {
        let x = UnitQuaternion::new_unchecked([q[3], q[4], q[5], q[6]].into()) * Vector3::x();
        (q[0] * x.y - q[1] * x.x) / q[0].hypot(q[1])
    };
    let run = simulate(&unit)
        .from(configuration_from_position_and_attitude(Vector3::x(), start), [v.x, v.y, v.z, 0.0, 0.0, 1.0])
        .method(precise_integrator())
        .duration(duration);
    for sample in run.sample_every(duration / 8.0) {
        let Sample { t, q, .. } = sample?;
        let off = pitch_angle(&q) / 1e-3 - expected(t);
        // For large pitch the error is of the third power.
        assert!(off.abs() < 1e-5 * (1.0 + expected(t).abs().powi(3)), "{off} at {t}");
    }
    Ok(())
}
