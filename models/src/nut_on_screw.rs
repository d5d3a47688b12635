use linkwork::mechanism;

/// Heavy nut on an upright screw without friction: its weight rotates it as it descends.
///
/// Source: Ball, *A Treatise on the Theory of Screws* (1900); Bernstein, Goel and Ansari, *Geometry,
/// Kinematics, Statics, and Dynamics*, on the screw joint.
///
/// - Coordinate: `thread`, the angle `θ` of the nut, rad; it rises by the pitch `p` per radian, `2π p` per
///   turn. Input: `spanner`, a torque on the nut, N·m.
/// - Equation of motion, with the nut's moment of inertia `J` about the screw: `(J + m p²) θ̈ + m g p = τ`.
///   It falls with the constant acceleration `g / (1 + J / (m p²))`, and the torque `m g p` holds it at rest.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NutOnScrew {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the nut, kg.
    pub mass: f64,
    /// Radius of the nut, a uniform disk, m.
    pub radius: f64,
    /// Pitch of the screw: rise per radian, m.
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
