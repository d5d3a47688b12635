use linkwork::mechanism;

/// Kapitza's pendulum: a fast vertical vibration of its pivot stabilises the upright position.
///
/// Source: Kapitza, *Dynamic stability of a pendulum when its point of suspension vibrates* (1951); Landau
/// and Lifshitz, *Mechanics* (1976), §30, problem 1.
///
/// - Coordinate: `pin`, the angle `θ` from the vertical, hanging, rad, counter-clockwise seen from +z; y
///   points up. The pivot is at `a cos Ωt` above the origin, so the functions have the time as their first
///   argument.
/// - Equation of motion: `m l² θ̈ + m l (g − a Ω² cos Ωt) sin θ = 0`.
/// - Averaged over a fast vibration of small amplitude: `l² θ̈ + g l sin θ + ½ a² Ω² sin θ cos θ = 0`. The
///   upright position is stable if `a² Ω² > 2 g l`; oscillations about it have the frequency
///   `√(a² Ω² / (2 l²) − g / l)`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KapitzaPendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the particle, kg.
    pub mass: f64,
    /// Length of the rod, m.
    pub length: f64,
    /// Amplitude of the pivot's vibration, m.
    pub amplitude: f64,
    /// Angular frequency of the pivot's vibration, rad/s.
    pub frequency: f64,

    #[point(at = amplitude * cos(frequency * t) * y)]
    pivot: Point,
    #[body]
    rod: Body,
    #[particle(mass = mass, at = rod.at(-length * y))]
    bob: Particle,
    #[joint(pivot -> rod, about = z)]
    pin: Pin,
}
