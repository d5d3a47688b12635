use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::nalgebra::Rotation3;
use linkwork::prelude::*;
use linkwork_models::{FoucaultPendulum, SphericalPendulum};
use std::f64::consts::FRAC_PI_2;

const P: FoucaultPendulum =
    FoucaultPendulum { g: 9.81, mass: 28.0, length: 67.0, earth_rate: 7.292e-5, latitude: 0.8527 };

/// Returns the position of the bob: south, east, up, m.
fn position_of_bob(q: &SVector<f64, 2>) -> SVector<f64, 3> {
    let ((sa, ca), (sb, cb)) = (q[0].sin_cos(), q[1].sin_cos());
    P.length * SVector::from([-sb, sa * cb, -ca * cb])
}

#[test]
fn foucault_pendulum_feels_coriolis_force() {
    // x = −l b and y = l a; a faster earth makes the Coriolis force visible, terms in Ω² are neglected.
    let fast = FoucaultPendulum { earth_rate: 1e-4, ..P };
    let vertical = 1e-4 * P.latitude.sin();
    let v = SVector::from([0.3, -0.5]);
    let a = fast.forward_dynamics(9.0, &SVector::zeros(), &v, &SVector::zeros());
    assert_number_close(a[0] / (2.0 * vertical * v[1]), 1.0, 1e-3);
    assert_number_close(a[1] / (-2.0 * vertical * v[0]), 1.0, 1e-3);
}

#[test]
fn foucault_plane_rotates_with_latitude() -> Result<(), Error> {
    // Released from rest in the laboratory at 1 m south, after a hundred oscillations.
    let swings = 100.0;
    let omega = (P.g / P.length).sqrt();
    let time = swings * std::f64::consts::TAU / omega;
    let end = simulate(&P).from([0.0, -1.0 / P.length], [0.0, 0.0]).method(precise_integrator());
    let place = position_of_bob(&end.duration(time).finish()?.q);
    let turned = place[1].atan2(place[0]);
    assert_number_close(turned / (-P.earth_rate * P.latitude.sin() * time), 1.0, 1e-3);
    Ok(())
}

#[test]
fn foucault_plane_is_fixed_at_the_pole() -> Result<(), Error> {
    let pole = FoucaultPendulum { latitude: FRAC_PI_2, earth_rate: 0.05, ..P };
    let still = SphericalPendulum { g: P.g, mass: P.mass, length: P.length };
    // The same position and velocity in the ground frame and in the laboratory frame, which coincide at t =
    // 0.
    let (q, v) = (SVector::from([0.3, -0.2]), SVector::from([0.02, 0.1]));
    let cross = SVector::from([-position_of_bob(&q)[1], position_of_bob(&q)[0], 0.0]) * pole.earth_rate;
    // Velocity of the bob per rate of each angle.
    let ((sa, ca), (sb, cb)) = (q[0].sin_cos(), q[1].sin_cos());
    let jacobian = P.length * SMatrix::<f64, 3, 2>::new(0.0, -cb, ca * cb, -sa * sb, sa * cb, ca * sb);
    let normal = jacobian.transpose() * jacobian;
    let slip = normal.try_inverse().map_or(v, |inverse| v - inverse * jacobian.transpose() * cross);
    let time = 20.0;
    let seen = simulate(&pole).from(q, slip).method(precise_integrator()).duration(time).finish()?;
    let ground = simulate(&still).from(q, v).method(precise_integrator()).duration(time).finish()?;
    let turn = Rotation3::from_euler_angles(0.0, 0.0, pole.earth_rate * time);
    assert_matrix_close(turn * position_of_bob(&seen.q), position_of_bob(&ground.q), 1e-8);
    Ok(())
}
