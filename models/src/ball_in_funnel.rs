use linkwork::mechanism;

/// Ball that rolls without slipping inside a funnel, a cone with a vertical axis.
///
/// Source: Routh, *Advanced Dynamics of a System of Rigid Bodies* (1905), ch. V; Neimark and Fufaev,
/// *Dynamics of Nonholonomic Systems* (1972), ch. II: a ball in a surface of revolution.
///
/// - Configuration: position and unit quaternion of `pose`; velocity: linear and angular, in the ball's axes;
///   z points up, the funnel's apex is the origin.
/// - With the distance `ρ` of the ball's centre from the axis, the rate `Ω` of its motion around the axis,
///   the spin `ν` about the normal (towards the ball) and the half angle `β`, `ρ² Ω` and
///   `ν − Ω ρ cos β / (r sin β)` are constant.
/// - On a level circle: `(7/5) Ω² ρ sin β + (2/5) r ν Ω cos β = g cos β`; the normal force is
///   `m (Ω² ρ cos β + g sin β)`.
/// - On the axis the ball touches the cone along a circle, where the contact has no direction.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallInFunnel {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the ball, kg.
    pub mass: f64,
    /// Radius of the ball, m.
    pub radius: f64,
    /// Angle between the funnel's axis and its surface `β`, rad.
    pub half_angle: f64,

    #[body(mass = mass, inertia = sphere(mass, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(rolls(ball.sphere(radius), ground.funnel(half_angle, z)))]
    contact: Rolling,
}
