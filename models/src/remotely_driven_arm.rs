use linkwork::mechanism;

/// Planar arm with two links whose geared motors are both on the ground. The second motor drives the forearm
/// by a belt, so that the coordinates are the links' absolute angles.
///
/// Source: Spong and Vidyasagar, *Robot Dynamics and Control* (1989), §6.4 (planar elbow manipulator with
/// remotely driven link).
///
/// - Coordinates: `p1` and `p2`, the angles of both links from x, rad; y points up. Inputs: `motor1` and
///   `motor2`, torques on the links from the ground (a motor's own times the gear ratio), N·m. Output:
///   `hand`, the position of the forearm's end, m.
/// - With uniform links and rotors `J` behind gears of ratio `n`: `M₁₁ = (⅓ m₁ + m₂) l₁² + n² J`,
///   `M₁₂ = ½ m₂ l₁ l₂ cos(p₂ − p₁)`, `M₂₂ = ⅓ m₂ l₂² + n² J`.
/// - `h₁ = −½ m₂ l₁ l₂ sin(p₂ − p₁) ṗ₂² + (½ m₁ + m₂) g l₁ cos p₁`,
///   `h₂ = ½ m₂ l₁ l₂ sin(p₂ − p₁) ṗ₁² + ½ m₂ g l₂ cos p₂`: in absolute angles there are no Coriolis terms,
///   only centrifugal ones.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemotelyDrivenArm {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the upper arm, kg.
    pub m1: f64,
    /// Mass of the forearm, kg.
    pub m2: f64,
    /// Length of the upper arm, m.
    pub l1: f64,
    /// Length of the forearm, m.
    pub l2: f64,
    /// Moment of inertia of each motor's rotor about its axis, kg·m².
    pub rotor: f64,
    /// Gear ratio: rotation of a rotor per rotation of its link.
    pub ratio: f64,

    p1: Coordinate,
    p2: Coordinate,
    #[frame(ground, z(p1))]
    upper_axes: Frame,
    #[frame(ground, z(p2))]
    lower_axes: Frame,
    #[frame(ground, z(ratio * p1))]
    rotor1_axes: Frame,
    #[frame(ground, z(ratio * p2))]
    rotor2_axes: Frame,

    #[body(mass = m1, com = l1 / 2 * x, inertia = rod(m1, l1, x), frame = upper_axes)]
    upper: Body,
    #[body(mass = m2, com = l2 / 2 * x, inertia = rod(m2, l2, x), at = upper.at(l1 * x), frame = lower_axes)]
    lower: Body,
    #[body(inertia = diagonal(rotor / 2, rotor / 2, rotor), frame = rotor1_axes)]
    rotor1: Body,
    #[body(inertia = diagonal(rotor / 2, rotor / 2, rotor), frame = rotor2_axes)]
    rotor2: Body,
    #[acts(on = upper, about = z)]
    motor1: Torque,
    #[acts(on = lower, about = z)]
    motor2: Torque,
    #[output(r(lower.at(l2 * x) / ground))]
    hand: Vector,
}
