use linkwork::mechanism;

/// A ball that rolls without slipping on a turntable that is driven: it neither flies off nor comes to rest, but goes
/// round in a circle, anywhere on the table.
///
/// Source: Routh, *Advanced Dynamics of a System of Rigid Bodies* (1905), ch. V; Weltner, *Stable circular orbits of
/// freely moving balls on rotating discs*, Am. J. Phys. 47 (1979).
///
/// - Configuration: place and unit quaternion of `pose`; velocity: linear and angular, in the ball's axes. z points up;
///   the table turns about z at the constant rate `spin` `Ω`.
/// - Seen from the ground the ball's centre moves with `v̇ = (2/7) Ω z × v`: in a circle at the rate `(2/7) Ω`, whatever
///   its mass and size.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallOnTurntable {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the ball, kg.
    pub mass: f64,
    /// Radius of the ball, m.
    pub radius: f64,
    /// Angular rate of the table, rad/s.
    pub spin: f64,

    #[frame(ground, z(spin * t))]
    turned: Frame,
    #[body(massive, frame = turned)]
    table: Body,
    #[body(mass = mass, inertia = sphere(mass, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(rolls(ball.sphere(radius), table.plane(z)))]
    contact: Rolling,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_near, precisely};
    use linkwork::prelude::*;

    const B: BallOnTurntable = BallOnTurntable { g: 9.81, mass: 0.2, radius: 0.03, spin: 7.0 };

    /// A circle at the rate foretold, whatever the ball's mass and size.
    #[test]
    fn goes_round_in_circles() -> Result<(), Error> {
        for ball in [B, BallOnTurntable { mass: 7.3, radius: 0.11, ..B }] {
            goes_round(ball)?;
        }
        Ok(())
    }

    fn goes_round(ball: BallOnTurntable) -> Result<(), Error> {
        // Velocity of the centre, and the angular velocity that makes the contact move as the table does.
        let (place, velocity, twist) = ([0.3, -0.1], [0.5, 0.2], 3.0);
        let table = [-ball.spin * place[1], ball.spin * place[0]];
        let w = [(table[1] - velocity[1]) / ball.radius, (velocity[0] - table[0]) / ball.radius, twist];
        let q = [place[0], place[1], ball.radius, 0.0, 0.0, 0.0, 1.0];
        let v = [velocity[0], velocity[1], 0.0, w[0], w[1], w[2]];
        assert!(ball.constraint_rates(0.0, &q.into(), &v.into()).amax() < 1e-14);
        let rate = 2.0 / 7.0 * ball.spin;
        let run = simulate(&ball).from(q, v).method(precisely()).duration(4.0).sample_every(0.5);
        for sample in run {
            let Sample { t, q, .. } = sample?;
            let (s, c) = (rate * t).sin_cos();
            let x = place[0] + (velocity[0] * s - velocity[1] * (1.0 - c)) / rate;
            let y = place[1] + (velocity[0] * (1.0 - c) + velocity[1] * s) / rate;
            assert_near(q.fixed_rows::<3>(0).into_owned(), [x, y, ball.radius].into(), 1e-9);
        }
        Ok(())
    }
}
