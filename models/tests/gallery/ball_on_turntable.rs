use crate::testing::{assert_matrix_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::BallOnTurntable;

const B: BallOnTurntable = BallOnTurntable { g: 9.81, mass: 0.2, radius: 0.03, spin: 7.0 };

/// Checks that the ball moves on a circle at the predicted rate, for any mass and size.
#[test]
fn ball_on_turntable_moves_in_circles() -> Result<(), Error> {
    for ball in [B, BallOnTurntable { mass: 7.3, radius: 0.11, ..B }] {
        check_circular_motion(ball)?;
    }
    Ok(())
}

fn check_circular_motion(ball: BallOnTurntable) -> Result<(), Error> {
    // Velocity of the centre, and the angular velocity for which the contact point moves with the table.
    let (place, velocity, twist) = ([0.3, -0.1], [0.5, 0.2], 3.0);
    let table = [-ball.spin * place[1], ball.spin * place[0]];
    let w = [(table[1] - velocity[1]) / ball.radius, (velocity[0] - table[0]) / ball.radius, twist];
    let q = [place[0], place[1], ball.radius, 0.0, 0.0, 0.0, 1.0];
    let v = [velocity[0], velocity[1], 0.0, w[0], w[1], w[2]];
    assert!(ball.constraint_rates(0.0, &q.into(), &v.into()).amax() < 1e-14);
    let rate = 2.0 / 7.0 * ball.spin;
    let run = simulate(&ball).from(q, v).method(precise_integrator()).duration(4.0).sample_every(0.5);
    for sample in run {
        let Sample { t, q, .. } = sample?;
        let (s, c) = (rate * t).sin_cos();
        let x = place[0] + (velocity[0] * s - velocity[1] * (1.0 - c)) / rate;
        let y = place[1] + (velocity[0] * (1.0 - c) + velocity[1] * s) / rate;
        assert_matrix_close(q.fixed_rows::<3>(0).into_owned(), [x, y, ball.radius].into(), 1e-9);
    }
    Ok(())
}
