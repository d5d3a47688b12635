use linkwork::mechanism;

/// Double pendulum of two particles, in the angles of both rods from the vertical.
///
/// Source: Landau and Lifshitz, *Mechanics* (1976), §5, problem 1 (coplanar double pendulum), and §23,
/// problem 2.
///
/// - Coordinates: `phi1` and `phi2`, rad, counter-clockwise seen from +z; y points up. The positions of the
///   particles are functions of these angles; there is no joint.
/// - Lagrangian:
///   `½ (m₁ + m₂) l₁² φ̇₁² + ½ m₂ l₂² φ̇₂² + m₂ l₁ l₂ φ̇₁ φ̇₂ cos(φ₁ − φ₂) + (m₁ + m₂) g l₁ cos φ₁ + m₂ g l₂ cos φ₂`.
/// - Small oscillations with equal lengths: `ω² = (g/l) (m₁ + m₂ ± √((m₁ + m₂) m₂)) / m₁`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoplanarDoublePendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the upper particle, kg.
    pub m1: f64,
    /// Mass of the lower particle, kg.
    pub m2: f64,
    /// Length of the upper rod, m.
    pub l1: f64,
    /// Length of the lower rod, m.
    pub l2: f64,

    phi1: Coordinate,
    phi2: Coordinate,
    #[particle(mass = m1, at = l1 * (sin(phi1) * x - cos(phi1) * y))]
    upper: Particle,
    #[particle(mass = m2, at = upper.at(l2 * (sin(phi2) * x - cos(phi2) * y)))]
    lower: Particle,
}
