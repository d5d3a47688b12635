use linkwork::mechanism;

/// Spherical pendulum: a particle on a massless rod that hangs from a universal joint.
///
/// Source: Landau and Lifshitz, *Mechanics* (1976), §14, problem 1.
///
/// - Coordinates: `suspension.first` about x, then `suspension.second` about the rotated y, `a` and `b`, rad;
///   z points up. The particle is at `l (−sin b, sin a cos b, −cos a cos b)`; the coordinates are singular
///   where the rod is along x.
/// - Equations of motion: `m l² cos²b ä − 2 m l² sin b cos b ȧ ḃ + m g l sin a cos b = 0`,
///   `m l² b̈ + m l² sin b cos b ȧ² + m g l cos a sin b = 0`.
/// - Conical motion: at the inclination `α` the period of revolution is `T = 2π √(l cos α / g)`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalPendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the particle, kg.
    pub mass: f64,
    /// Length of the rod, m.
    pub length: f64,

    #[body]
    rod: Body,
    #[particle(mass = mass, at = rod.at(-length * z))]
    bob: Particle,
    #[joint(ground -> rod, about = (x, y))]
    suspension: Universal,
}
