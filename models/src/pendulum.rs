use linkwork::{Real, mechanism};

/// Simple pendulum: a particle at the end of a massless rod that rotates about a horizontal pin.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), ch. 1; the period: Landau and Lifshitz,
/// *Mechanics* (1976), §11.
///
/// - Coordinate: `pin`, the angle from the vertical, rad, counter-clockwise seen from +z; y points up.
/// - Equation of motion: `m l² θ̈ + m g l sin θ = τ`.
/// - Period from rest at `θ₀`: `T = 4 √(l/g) K(sin ½θ₀) = 2π √(l/g) / agm(1, cos ½θ₀)`, with the
///   arithmetic–geometric mean `agm`.
///
/// Generic over the scalar type: `Pendulum<f32>`, `Pendulum<f64>` or any other type that implements [`Real`].
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum<T: Real> {
    /// Gravitational acceleration, m/s².
    pub g: T,
    /// Mass of the particle, kg.
    pub mass: T,
    /// Length of the rod, m.
    pub length: T,

    #[body]
    rod: Body,
    #[particle(mass = mass, at = rod.at(-length * y))]
    bob: Particle,
    #[joint(ground -> rod, about = z)]
    pin: Pin,
}
