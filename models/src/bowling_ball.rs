use linkwork::mechanism;

/// Ball that is thrown without spin onto a level lane: it slides, and dry friction brings it to roll.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), § 5.9 (exercises); Sommerfeld,
/// *Mechanics* (1952), § 27 (billiards).
///
/// - Configuration: position and unit quaternion of `pose`; velocity: linear and angular, in the ball's axes;
///   z points up.
/// - While it slides, with the slip velocity `s` of its lowest point, `v̇ = −μ g s / √(|s|² + v₀²)`, which
///   tends to Coulomb's law as the `regular_speed` `v₀` tends to zero. The slip keeps its direction: the path
///   is a parabola, then straight.
/// - Thrown with the speed `v` it rolls from the time `2 v / (7 μ g)` on, at `5 v / 7`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BowlingBall {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the ball, kg.
    pub mass: f64,
    /// Radius of the ball, m.
    pub radius: f64,
    /// Coefficient of friction `μ` between ball and lane.
    pub friction: f64,
    /// Slip velocity below which friction is smooth, `v₀`, m/s.
    pub regular_speed: f64,

    #[body(mass = mass, inertia = sphere(mass, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(slips(ball.sphere(radius), ground.plane(z)), friction = friction, speed = regular_speed)]
    lane: Slipping,
}
