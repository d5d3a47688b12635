use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::BallInFunnel;

const B: BallInFunnel = BallInFunnel { g: 9.81, mass: 0.1, radius: 0.02, half_angle: 0.6 };

/// Returns a state at the distance `rho` from the axis, towards x, without rotation. The ball moves along the
/// funnel at `sinking` and around it at `rate`, with a spin about the normal.
fn state_of_ball_on_funnel(
    rho: f64,
    rate: f64,
    sinking: f64,
    spin: f64,
) -> (SVector<f64, 7>, SVector<f64, 6>) {
    let (s, c) = B.half_angle.sin_cos();
    let (normal, along) = (Vector3::new(-c, 0.0, s), Vector3::new(s, 0.0, c));
    let velocity = along * sinking + Vector3::y() * (rate * rho);
    let w = normal * spin + normal.cross(&velocity) / B.radius;
    let height = (rho * c + B.radius) / s;
    let v = [velocity.x, velocity.y, velocity.z, w.x, w.y, w.z];
    ([rho, 0.0, height, 0.0, 0.0, 0.0, 1.0].into(), v.into())
}

#[test]
fn ball_circles_at_constant_height_in_funnel() -> Result<(), Error> {
    assert_eq!((BallInFunnel::NC, BallInFunnel::NH, BallInFunnel::NS), (3, 1, 3));
    let (s, c) = B.half_angle.sin_cos();
    let rho = 0.15;
    for spin in [0.0, 60.0, -25.0] {
        let (square, linear) = (1.4 * rho * s, 0.4 * B.radius * spin * c);
        let rate = (-linear + (linear * linear + 4.0 * square * B.g * c).sqrt()) / (2.0 * square);
        let (q, v) = state_of_ball_on_funnel(rho, rate, 0.0, spin);
        assert!(B.constraint_residuals(&q).amax() < 1e-16);
        assert!(B.constraint_rates(&q, &v).amax() < 1e-14);
        let (_, lambda) = B.constrained_dynamics(&q, &v, &SVector::zeros());
        assert_number_close(lambda[0], B.mass * (rate * rate * rho * c + B.g * s), 1e-13);
        let end = simulate(&B).from(q, v).method(precise_integrator()).duration(1.0).finish()?;
        let (sine, cosine) = rate.sin_cos();
        let found = end.q.fixed_rows::<3>(0).into_owned();
        assert_matrix_close(found, [rho * cosine, rho * sine, q[2]].into(), 1e-8);
    }
    Ok(())
}

/// Checks that the two integrals of motion of a surface of revolution, in closed form for a cone, are
/// constant while the ball descends and rises.
#[test]
fn ball_in_funnel_conserves_integrals() -> Result<(), Error> {
    let (s, c) = B.half_angle.sin_cos();
    let integrals_of_motion = |q: &SVector<f64, 7>, v: &SVector<f64, 6>| {
        let turn = UnitQuaternion::from_quaternion([q[3], q[4], q[5], q[6]].into());
        let velocity = turn * Vector3::new(v[0], v[1], v[2]);
        let w = turn * Vector3::new(v[3], v[4], v[5]);
        let rho = q[0].hypot(q[1]);
        let outward = Vector3::new(q[0], q[1], 0.0) / rho;
        let normal = Vector3::z() * s - outward * c;
        let momentum = q[0] * velocity.y - q[1] * velocity.x;
        let spin = w.dot(&normal) - momentum / rho * c / (B.radius * s);
        SVector::from([momentum, spin, B.kinetic_energy(q, v) + B.potential_energy(q)])
    };
    let (q, v) = state_of_ball_on_funnel(0.2, 5.0, -0.6, 30.0);
    let run = simulate(&B).from(q, v).method(precise_integrator()).duration(1.5).sample_every(0.1);
    let mut lowest = q[2];
    for sample in run {
        let Sample { q: now, v: then, .. } = sample?;
        lowest = lowest.min(now[2]);
        assert_matrix_close(integrals_of_motion(&now, &then), integrals_of_motion(&q, &v), 1e-9);
    }
    assert!(lowest < 0.8 * q[2], "it sank to {lowest} only");
    Ok(())
}
