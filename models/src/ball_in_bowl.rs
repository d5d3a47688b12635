use linkwork::mechanism;

/// Ball that rolls without slipping inside a spherical bowl.
///
/// Source: Routh, *Advanced Dynamics of a System of Rigid Bodies* (1905), ch. V; Neimark and Fufaev,
/// *Dynamics of Nonholonomic Systems* (1972), ch. II.
///
/// - Configuration: position and unit quaternion of `pose`; velocity: linear and angular, in the ball's axes;
///   z points up, and the bowl's centre is the origin.
/// - In a vertical plane: `(7/5) (R − r) θ̈ + g sin θ = 0`, a pendulum with the length `(7/5) (R − r)`.
/// - On a level circle at the angle `θ` from the lowest point, with the spin `n` about the line of centres
///   (outwards): `(7/5) (R − r) Ω² cos θ − (2/5) r n Ω = g`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallInBowl {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the ball, kg.
    pub mass: f64,
    /// Radius of the ball, m.
    pub radius: f64,
    /// Radius of the bowl, m.
    pub bowl: f64,

    #[body(mass = mass, inertia = sphere(mass, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(rolls(ball.sphere(radius), ground.bowl(bowl)))]
    contact: Rolling,
}
