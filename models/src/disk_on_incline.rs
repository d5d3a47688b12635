use linkwork::mechanism;

/// Disk, hoop, cylinder or ball that rolls down an incline without slipping.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), §2.4; Galilei, *Discorsi* (1638).
///
/// - Coordinate: `s`, the distance down the incline, m; position and orientation of the disk are functions of
///   it, so that rolling without slip needs no constraint. x points horizontally towards the downhill side, y
///   up.
/// - Equation of motion: `(m + J/R²) s̈ = m g sin α`. With `J = κ m R²` the acceleration is
///   `g sin α / (1 + κ)`: `κ` is 1 for a hoop, ½ for a disk or a solid cylinder, ⅔ for a shell and ⅖ for a
///   solid ball, for any mass and size.
/// - Output: `rim`, the velocity of that point of the rim which touches the incline at `s = 0`, m/s.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiskOnIncline {
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

    s: Coordinate,
    #[frame(ground, z(-slope))]
    incline: Frame,
    #[frame(incline, z(-s / radius))]
    turned: Frame,
    #[body(
        mass = mass,
        inertia = diagonal(
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2)
        ),
        at = s * incline.x + radius * incline.y,
        frame = turned
    )]
    disk: Body,
    #[output(v(disk.at(-radius * y) / ground / ground))]
    rim: Vector,
}
