use linkwork::mechanism;

/// Ball that rolls without slipping on a driven turntable: it neither leaves the table nor comes to rest, but
/// moves in a circle, anywhere on the table.
///
/// Source: Routh, *Advanced Dynamics of a System of Rigid Bodies* (1905), ch. V; Weltner, *Stable circular
/// orbits of freely moving balls on rotating discs*, Am. J. Phys. 47 (1979).
///
/// - Configuration: position and unit quaternion of `pose`; velocity: linear and angular, in the ball's axes.
///   z points up; the table rotates about z at the constant rate `spin` `Ω`.
/// - In the ground frame the ball's centre moves with `v̇ = (2/7) Ω z × v`: in a circle at the rate
///   `(2/7) Ω`, for any mass and size.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallOnTurntable {
    /// Gravitational acceleration, m/s².
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
