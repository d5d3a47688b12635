use linkwork::mechanism;

/// Furuta's pendulum, or rotary pendulum: a motor rotates an arm about the vertical, and a pendulum pinned to
/// the arm's end swings across the arm.
///
/// Source: Furuta, Yamakita and Kobayashi, *Swing up control of inverted pendulum* (1991); Cazzolato and
/// Prime, *On the dynamics of the Furuta pendulum*, J. Control Sci. Eng. (2011).
///
/// - Coordinates: `motor`, the arm's angle `φ` about the vertical z; `elbow`, the pendulum's angle `θ` from
///   hanging about the arm; both rad. Input: `drive`, a torque on the arm, N·m.
/// - Mass matrix of uniform rods (mass and length of the arm `M`, `r`, of the pendulum `m`, `l`):
///   `M₁₁ = ⅓ M r² + m r² + ⅓ m l² sin² θ`, `M₁₂ = ½ m r l cos θ`, `M₂₂ = ⅓ m l²`.
/// - Bias forces: `h₁ = ⅔ m l² sin θ cos θ θ̇ φ̇ − ½ m r l sin θ θ̇²`,
///   `h₂ = −⅓ m l² sin θ cos θ φ̇² + ½ m g l sin θ`.
/// - With the arm free, small oscillations have the frequency `√(½ m g l M₁₁ / (M₁₁ M₂₂ − M₁₂²))`, evaluated
///   at `θ = 0`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FurutaPendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the arm, kg.
    pub arm_mass: f64,
    /// Length of the arm, m.
    pub arm_length: f64,
    /// Mass of the pendulum, kg.
    pub mass: f64,
    /// Length of the pendulum, m.
    pub length: f64,

    #[body(mass = arm_mass, com = arm_length / 2 * x, inertia = rod(arm_mass, arm_length, x))]
    arm: Body,
    #[body(mass = mass, com = -length / 2 * z, inertia = rod(mass, length, z))]
    pendulum: Body,
    #[joint(ground -> arm, about = z)]
    motor: Pin,
    #[joint(arm.at(arm_length * x) -> pendulum, about = x)]
    elbow: Pin,
    #[acts(on = motor)]
    drive: Torque,
}
