use crate::testing::{assert_matrix_close, assert_number_close, elliptic_integral, precise_integrator};
use linkwork::nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::RollingCone;

const C: RollingCone = RollingCone { g: 9.81, mass: 0.4, height: 0.2, half_angle: 0.35, slope: 0.3 };

/// Returns the moment of inertia of the rolling cone for precession, `d²T/dθ̇²`.
fn precession_inertia(c: &RollingCone) -> f64 {
    3.0 / 20.0 * c.mass * c.height * c.height * (1.0 + 5.0 * c.half_angle.cos().powi(2))
}

/// Returns a state with the line of contact at the angle `theta` from the fall line, precessing at `rate`.
fn rolling_state(c: &RollingCone, theta: f64, rate: f64) -> (SVector<f64, 7>, SVector<f64, 6>) {
    let (s, k) = c.slope.sin_cos();
    let (normal, fall) = (Vector3::new(s, 0.0, k), Vector3::new(k, 0.0, -s));
    let line = fall * theta.cos() + normal.cross(&fall) * theta.sin();
    let (sine, cosine) = c.half_angle.sin_cos();
    let axis = line * cosine + normal * sine;
    let across = normal.cross(&line);
    let turn = Rotation3::from_matrix(&Matrix3::from_columns(&[across.cross(&axis), across, axis]));
    let turn = UnitQuaternion::from_rotation_matrix(&turn);
    let w = turn.inverse() * (line * (-rate * cosine / sine));
    ([0.0, 0.0, 0.0, turn.i, turn.j, turn.k, turn.w].into(), [0.0, 0.0, 0.0, w.x, w.y, w.z].into())
}

#[test]
fn rolling_cone_has_one_degree_of_freedom() {
    assert_eq!((RollingCone::NC, RollingCone::NH, RollingCone::NS), (5, 2, 1));
    let (q, v) = rolling_state(&C, 0.7, 3.0);
    assert!(C.constraint_residuals(&q).amax() < 1e-15);
    assert!(C.constraint_rates(&q, &v).amax() < 1e-14);
    assert_number_close(C.kinetic_energy(&q, &v), 0.5 * precession_inertia(&C) * 9.0, 1e-14);
    let (sine, cosine) = C.half_angle.sin_cos();
    let height = 0.75 * C.height * (sine * C.slope.cos() - cosine * C.slope.sin() * 0.7_f64.cos());
    assert_number_close(C.potential_energy(&q), C.mass * C.g * height, 1e-14);
}

/// Checks that large oscillations of the cone have the period of an elliptic integral.
#[test]
fn rolling_cone_swings_about_its_apex() -> Result<(), Error> {
    let cosine = C.half_angle.cos();
    let slow = 5.0 * C.g * cosine * C.slope.sin() / (C.height * (1.0 + 5.0 * cosine * cosine));
    for theta in [1e-3_f64, 1.2, 2.5] {
        let (q, v) = rolling_state(&C, theta, 0.0);
        let quarter = elliptic_integral((theta / 2.0).sin().powi(2)) / slow.sqrt();
        let end = simulate(&C).from(q, v).method(precise_integrator()).duration(4.0 * quarter).finish()?;
        assert_matrix_close(end.q.fixed_rows::<3>(0).into_owned(), SVector::zeros(), 1e-12);
        // By then the cone has rotated about its axis, and back.
        assert!((end.q - q).amax() < 1e-7, "{} {}", end.q, q);
        let half = simulate(&C).from(q, v).method(precise_integrator()).duration(2.0 * quarter).finish()?;
        let mirrored = rolling_state(&C, -theta, 0.0).0;
        let cone_axis = |q: &SVector<f64, 7>| {
            UnitQuaternion::from_quaternion([q[3], q[4], q[5], q[6]].into()) * Vector3::z()
        };
        assert!((cone_axis(&half.q) - cone_axis(&mirrored)).amax() < 1e-7);
    }
    Ok(())
}

/// Checks Euler's equation about the apex of a cone that rolls on a level plane: the moments of normal force
/// and weight together change the angular momentum.
#[test]
fn cone_normal_force_satisfies_eulers_equation() {
    let c = RollingCone { slope: 0.0, ..C };
    let (sine, cosine) = c.half_angle.sin_cos();
    let radius = c.height * c.half_angle.tan();
    let axial = 0.3 * c.mass * radius * radius;
    let across = c.mass * (0.15 * radius * radius + 0.6 * c.height * c.height);
    for rate in [0.0, 1.0, 8.0] {
        let (q, v) = rolling_state(&c, 0.4, rate);
        let (a, lambda) = c.constrained_dynamics(&q, &v, &SVector::zeros());
        assert_number_close(lambda[0], c.mass * c.g, 1e-13);
        let gyroscopic = rate * rate * cosine / sine * (axial * cosine * cosine + across * sine * sine);
        assert_number_close(lambda[1], 0.75 * c.height * cosine * c.mass * c.g + gyroscopic, 1e-13);
        // The line of contact is at rest, so that no force does work on the cone.
        let rates = c.constraint_jacobian(&q) * a + c.constraint_bias(&q, &v);
        assert!(rates.amax() < 1e-11);
        assert!(v.dot(&(c.mass_matrix(&q) * a)).abs() < 1e-11);
    }
}
