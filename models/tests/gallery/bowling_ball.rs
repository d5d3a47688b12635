use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::BowlingBall;

const B: BowlingBall = BowlingBall { g: 9.81, mass: 6.0, radius: 0.11, friction: 0.2, regular_speed: 1e-3 };

fn start_configuration() -> SVector<f64, 7> {
    [0.0, 0.0, B.radius, 0.0, 0.0, 0.0, 1.0].into()
}

#[test]
fn friction_accelerations_follow_slip() {
    assert_eq!((BowlingBall::NC, BowlingBall::NH, BowlingBall::NS), (1, 1, 5));
    for regular_speed in [1e-3, 0.5] {
        let ball = BowlingBall { regular_speed, ..B };
        // Slip: velocity of the lowest point.
        let v = SVector::from([1.0, -0.4, 0.0, 2.0, 3.0, 5.0]);
        let slip = [1.0 - 3.0 * B.radius, -0.4 + 2.0 * B.radius];
        let size = (slip[0] * slip[0] + slip[1] * slip[1] + regular_speed * regular_speed).sqrt();
        let [x, y] = slip.map(|s| -B.friction * B.g * s / size);
        let (a, normal) = ball.constrained_dynamics(&start_configuration(), &v, &SVector::zeros());
        assert_number_close(normal[0], B.mass * B.g, 1e-14);
        // Acceleration in the ball's axes, which rotate.
        let linear = a.fixed_rows::<3>(0) + Vector3::new(2.0, 3.0, 5.0).cross(&Vector3::new(1.0, -0.4, 0.0));
        assert_matrix_close(linear, [x, y, 0.0].into(), 1e-13);
        let arm = 2.5 / B.radius;
        assert_matrix_close(a.fixed_rows::<3>(3).into_owned(), [arm * y, -arm * x, 0.0].into(), 1e-13);
    }
}

/// Checks that the ball slides, then rolls. Because of the regularised friction, slip velocities of the order
/// of the regularisation speed take slightly longer to decay.
#[test]
fn bowling_ball_slides_then_rolls() -> Result<(), Error> {
    let speed = 5.0;
    let time = 2.0 * speed / (7.0 * B.friction * B.g);
    let roll_for_duration = |t: f64| {
        let v = [speed, 0.0, 0.0, 0.0, 0.0, 0.0];
        simulate(&B).from(start_configuration(), v).method(precise_integrator()).duration(t).finish()
    };
    let half = roll_for_duration(time / 2.0)?;
    assert_number_close(half.q[0], speed * time / 2.0 - B.friction * B.g * time * time / 8.0, 1e-6);
    assert_number_close(half.v[4], 2.5 * B.friction * B.g * time / 2.0 / B.radius, 1e-6);
    let end = roll_for_duration(1.5 * time)?;
    let pose = UnitQuaternion::from_quaternion([end.q[3], end.q[4], end.q[5], end.q[6]].into());
    let velocity = pose * Vector3::new(end.v[0], end.v[1], end.v[2]);
    // The angular momentum about the lane is constant, so that this is exact.
    assert_matrix_close(velocity, Vector3::x() * (5.0 / 7.0 * speed), 1e-6);
    assert_number_close(end.v[4] * B.radius, 5.0 / 7.0 * speed, 1e-6);
    // Sliding distance 12/49 v² / (μ g), then the rolling distance.
    let way = 12.0 / 49.0 * speed * speed / (B.friction * B.g) + 5.0 / 7.0 * speed * time / 2.0;
    assert_number_close(end.q[0], way, 1e-3);
    Ok(())
}

/// Checks that a bowling ball that spins about the direction of its path moves along a parabola while it
/// slides: the spin makes its lowest point slip sideways.
#[test]
fn spinning_bowling_ball_follows_parabola() -> Result<(), Error> {
    let v = SVector::from([4.0, 0.0, 0.0, 30.0, 0.0, 0.0]);
    let slip = [4.0, 30.0 * B.radius];
    let size = slip[0].hypot(slip[1]);
    let t = 0.5;
    let end =
        simulate(&B).from(start_configuration(), v).method(precise_integrator()).duration(t).finish()?;
    let [x, y] = slip.map(|s| -B.friction * B.g * s / size * t * t / 2.0);
    assert_matrix_close(end.q.fixed_rows::<3>(0).into_owned(), [4.0 * t + x, y, B.radius].into(), 1e-6);
    Ok(())
}
