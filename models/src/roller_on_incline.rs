use linkwork::mechanism;

/// Round body on an incline, as [`DiskOnIncline`](crate::DiskOnIncline), but free in the plane: rolling is a
/// constraint, whose multipliers are the contact forces.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), §2.4.
///
/// - Coordinates: `pose.x`, `pose.y` of the centre, m, and the angle `pose.angle` about z, rad; x points
///   horizontally towards the downhill side, y up.
/// - The acceleration down the incline is `g sin α / (1 + κ)` with `J = κ m R²`: `5/7`, `2/3`, `1/2` of
///   `g sin α` for a ball, a disk and a hoop. The normal force is `m g cos α`, the friction force
///   `κ / (1 + κ) m g sin α`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollerOnIncline {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the rolling body, kg.
    pub mass: f64,
    /// Radius of the rolling body, m.
    pub radius: f64,
    /// Moment of inertia of the rolling body about its axis, in units of mass times squared radius.
    pub shape: f64,
    /// Angle of the incline from the level, rad.
    pub slope: f64,

    #[body(
        mass = mass,
        inertia = diagonal(
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2)
        )
    )]
    roller: Body,
    #[joint(ground -> roller, about = z)]
    pose: Planar,
    #[constraint(rolls(roller.circle(radius, z), ground.plane(sin(slope) * x + cos(slope) * y)))]
    contact: Rolling,
}
