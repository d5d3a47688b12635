use linkwork::mechanism;

/// Ball that rolls without slipping in a paraboloid of revolution, a parametric surface.
///
/// Source: Routh, *Advanced Dynamics of a System of Rigid Bodies* (1905), ch. V; Neimark and Fufaev,
/// *Dynamics of Nonholonomic Systems* (1972), ch. II: a ball on a surface of revolution.
///
/// - Configuration: the point `u`, `w` of the dish `z = (u² + w²) / (2 c)` that the ball touches, m; position
///   and unit quaternion of `pose`. Velocity: rates of `u` and `w`; linear and angular velocity in the ball's
///   axes. z points up.
/// - On a level circle at the distance `ρ` of the ball's centre from the axis, where the tangent has the
///   angle `β` to the vertical, at the rate `Ω`, with the spin `ν` about the normal (towards the ball):
///   `(7/5) Ω² ρ sin β + (2/5) r ν Ω cos β = g cos β`.
/// - The energy is constant.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallInDish {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the ball, kg.
    pub mass: f64,
    /// Radius of the ball, m.
    pub radius: f64,
    /// Radius of curvature of the dish at its lowest point `c`, m.
    pub curvature: f64,

    u: Coordinate,
    w: Coordinate,
    #[body(mass = mass, inertia = sphere(mass, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(rolls(
        ball.sphere(radius),
        ground.surface(u, w, u * x + w * y + (u * u + w * w) / (2 * curvature) * z)
    ))]
    contact: Rolling,
}
