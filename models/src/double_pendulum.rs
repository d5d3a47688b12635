use linkwork::mechanism;

/// Double pendulum of two uniform rods, the second pinned to the end of the first.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), ch. 1; chaotic for large swings.
///
/// - Coordinates: `shoulder` from the vertical and `elbow` relative to the upper rod, `θ₁` and `θ₂`, rad,
///   counter-clockwise seen from +z; y points up.
/// - Mass matrix: `M₁₁ = (m₁/3 + m₂) l₁² + m₂ l₂²/3 + m₂ l₁ l₂ cos θ₂`, `M₁₂ = m₂ l₂²/3 + ½ m₂ l₁ l₂ cos θ₂`,
///   `M₂₂ = m₂ l₂²/3`.
/// - Bias forces:
///   `h₁ = −m₂ l₁ l₂ sin θ₂ (θ̇₁ + ½ θ̇₂) θ̇₂ + (½ m₁ + m₂) g l₁ sin θ₁ + ½ m₂ g l₂ sin(θ₁ + θ₂)`,
///   `h₂ = ½ m₂ l₁ l₂ sin θ₂ θ̇₁² + ½ m₂ g l₂ sin(θ₁ + θ₂)`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoublePendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the upper rod, kg.
    pub m1: f64,
    /// Mass of the lower rod, kg.
    pub m2: f64,
    /// Length of the upper rod, m.
    pub l1: f64,
    /// Length of the lower rod, m.
    pub l2: f64,

    #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))]
    upper: Body,
    #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-l1 * y) -> lower, about = z)]
    elbow: Pin,
}
