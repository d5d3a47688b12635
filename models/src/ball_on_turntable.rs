use linkwork::mechanism;

/// A ball that rolls without slipping on a turntable that is driven: it neither flies off nor comes to rest,
/// but goes round in a circle, anywhere on the table.
///
/// Source: Routh, *Advanced Dynamics of a System of Rigid Bodies* (1905), ch. V; Weltner, *Stable circular
/// orbits of freely moving balls on rotating discs*, Am. J. Phys. 47 (1979).
///
/// - Configuration: place and unit quaternion of `pose`; velocity: linear and angular, in the ball's axes. z
///   points up; the table turns about z at the constant rate `spin` `Ω`.
/// - Seen from the ground the ball's centre moves with `v̇ = (2/7) Ω z × v`: in a circle at the rate
///   `(2/7) Ω`, whatever its mass and size.
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
