use crate::testing::{assert_matrix_close, assert_number_close, elliptic_integral, precise_integrator};
use linkwork::nalgebra::Vector3;
use linkwork::prelude::*;
use linkwork_models::BallInBowl;

const B: BallInBowl = BallInBowl { g: 9.81, mass: 0.3, radius: 0.05, bowl: 0.45 };

/// Returns the configuration at the angle `theta` from the lowest point towards x, without rotation.
fn ball_configuration(theta: f64) -> SVector<f64, 7> {
    let reach = B.bowl - B.radius;
    [reach * theta.sin(), 0.0, -reach * theta.cos(), 0.0, 0.0, 0.0, 1.0].into()
}

/// Checks that large oscillations of the ball have the period given by an elliptic integral, and small ones
/// the frequency `√(5 g / (7 (R − r)))`.
#[test]
fn ball_in_bowl_has_pendulum_period() -> Result<(), Error> {
    assert_eq!((BallInBowl::NC, BallInBowl::NS), (3, 3));
    for theta in [1.1_f64, 1e-3] {
        let swing_rate_about_y = |v: &SVector<f64, 6>| v[4];
        let end = simulate(&B)
            .from(ball_configuration(theta), [0.0; 6])
            .method(precise_integrator())
            .until_crossing(Crossing::Rising, |_, _, v| -swing_rate_about_y(v))
            .duration(10.0)
            .finish()?;
        let length = 1.4 * (B.bowl - B.radius);
        let period = 4.0 * (length / B.g).sqrt() * elliptic_integral((theta / 2.0).sin().powi(2));
        let crossing = if end.t < 0.75 * period { period / 2.0 } else { period };
        assert_number_close(end.t, crossing, 1e-7);
    }
    Ok(())
}

#[test]
fn spinning_ball_circles_in_bowl() -> Result<(), Error> {
    let (theta, reach) = (0.8_f64, B.bowl - B.radius);
    for spin in [0.0, 40.0, -15.0] {
        let (square, linear) = (1.4 * reach * theta.cos(), 0.4 * B.radius * spin);
        let rate = (linear + (linear * linear + 4.0 * square * B.g).sqrt()) / (2.0 * square);
        let q = ball_configuration(theta);
        let outward = Vector3::new(q[0], q[1], q[2]) / reach;
        let velocity = Vector3::new(0.0, rate * q[0], 0.0);
        let w = outward * spin - outward.cross(&velocity) / B.radius;
        let v = [velocity.x, velocity.y, velocity.z, w.x, w.y, w.z];
        let time = 2.0;
        let end = simulate(&B).from(q, v).method(precise_integrator()).duration(time).finish()?;
        let (s, c) = (rate * time).sin_cos();
        let found = end.q.fixed_rows::<3>(0).into_owned();
        assert_matrix_close(found, [q[0] * c, q[0] * s, q[2]].into(), 1e-8);
    }
    Ok(())
}
