use linkwork::mechanism;

/// Kepler's problem: two bodies that attract each other by gravity.
///
/// Source: Newton, *Principia* (1687); Goldstein, Poole and Safko, *Classical Mechanics* (2002), ch. 3.
///
/// - Coordinates: `orbit1.x`, `.y`, `.z`, `orbit2.x`, `.y`, `.z`, the positions of both in an inertial frame,
///   m.
/// - Equations of motion: `m₁ r̈₁ = G m₁ m₂ (r₂ − r₁) / r³ = −m₂ r̈₂`, with the distance `r`.
/// - The centre of mass moves on a straight line. About it both describe ellipses with the period
///   `2π √(a³ / (G (m₁ + m₂)))`, where `a` is half the sum of the smallest and largest distance; the relative
///   speed is `v² = G (m₁ + m₂) (2/r − 1/a)`.
/// - Energy, momentum, angular momentum and Laplace's vector, `v × (r × v) / (G (m₁ + m₂)) − r / |r|` (of the
///   relative motion), are constant.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBodies {
    /// Gravitational constant, m³/(kg·s²).
    pub constant: f64,
    /// Mass of the first body, kg.
    pub m1: f64,
    /// Mass of the second body, kg.
    pub m2: f64,

    #[particle(mass = m1)]
    first: Particle,
    #[particle(mass = m2)]
    second: Particle,
    #[joint(ground -> first, along = (x, y, z))]
    orbit1: Stage,
    #[joint(ground -> second, along = (x, y, z))]
    orbit2: Stage,
    #[acts(between = (first, second), constant = constant)]
    attraction: Gravity,
}
