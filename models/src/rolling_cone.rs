use linkwork::mechanism;

/// Solid cone that rolls without slipping on an inclined plane. It touches the plane along a line; its apex
/// is fixed, and the cone swings about it like a pendulum.
///
/// Source: Landau and Lifshitz, *Mechanics* (1976), § 32, problem 7; the incline adds a potential energy.
///
/// - Configuration: position of the apex and unit quaternion of `pose`; velocity: linear and angular, in the
///   cone's axes, whose z points from the apex to the base. z of the ground points up, the plane descends
///   towards x.
/// - With the precession `θ`, the angle of the line of contact from the fall line, the kinetic energy is
///   `3 m h² θ̇² (1 + 5 cos² α) / 40`, the potential energy `−¾ m g h cos α sin β cos θ`: small oscillations
///   have the frequency `√(5 g cos α sin β / (h (1 + 5 cos² α)))`.
/// - The multiplier `contact.normal` is the normal force `N`, and `contact.tilt` its moment about the apex:
///   the resultant acts at the distance `contact.tilt / N`, which is on the cone as long as the cone does not
///   tip over its rim.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingCone {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the cone, kg.
    pub mass: f64,
    /// Height of the cone, m.
    pub height: f64,
    /// Half angle `α` of the cone, between its axis and its surface, rad.
    pub half_angle: f64,
    /// Angle `β` of the plane from the level, rad.
    pub slope: f64,

    #[body(
        mass = mass,
        com = 3 * height / 4 * z,
        inertia = cone(mass, height * tan(half_angle), height, z)
    )]
    body: Body,
    #[joint(ground -> body)]
    pose: Free,
    #[constraint(rolls(body.cone(half_angle, z), ground.plane(sin(slope) * x + cos(slope) * z)))]
    contact: Rolling,
}
