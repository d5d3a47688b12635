use linkwork::mechanism;

/// A heavy nut on an upright screw without friction: its weight turns it as it comes down.
///
/// Source: Ball, *A Treatise on the Theory of Screws* (1900); Bernstein, Goel and Ansari, *Geometry,
/// Kinematics, Statics, and Dynamics*, on the screw joint.
///
/// - Coordinate: `thread`, the angle `θ` of the nut, rad; it rises by the pitch `p` each radian, `2π p` each
///   turn. Input: `spanner`, a torque on the nut, N·m.
/// - Equation of motion, with the nut's moment of inertia `J` about the screw: `(J + m p²) θ̈ + m g p = τ`.
///   It falls with the constant acceleration `g / (1 + J / (m p²))`, and is held by the torque `m g p`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NutOnScrew {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the nut, kg.
    pub mass: f64,
    /// Radius of the nut, a uniform disk, m.
    pub radius: f64,
    /// Rise in a radian, m.
    pub pitch: f64,

    #[body(mass = mass, inertia = disk(mass, radius, z))]
    nut: Body,
    #[joint(ground -> nut, about = z, pitch = pitch)]
    thread: Screw,
    #[acts(on = thread)]
    spanner: Torque,
    #[output(dot(r(nut / ground), z))]
    height: Scalar,
}
