use linkwork::mechanism;

/// Elastic pendulum, or swinging spring: a particle on a coil spring, in a vertical plane.
///
/// Source: Vitt and Gorelik, *Oscillations of an elastic pendulum* (1933); Lynch, *Resonant motions of the
/// three-dimensional elastic pendulum*, Int. J. Non-Linear Mech. 37 (2002).
///
/// - Coordinates: `length` of the spring, `r`, m; `theta`, its angle `θ` from the vertical, rad,
///   counter-clockwise seen from +z; y points up.
/// - Equations of motion: `m r̈ − m r θ̇² − m g cos θ + k (r − l) = 0`,
///   `m r² θ̈ + 2 m r ṙ θ̇ + m g r sin θ = 0`.
/// - At rest `r₀ = l + m g / k`. For small motions the radial frequency is `√(k/m)` and the frequency of the
///   swing `√(g/r₀)`. If the first is twice the second, energy is exchanged between both motions.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticPendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the particle, kg.
    pub mass: f64,
    /// Stiffness of the spring, N/m.
    pub stiffness: f64,
    /// Free length of the spring, m.
    pub free_length: f64,

    length: Coordinate,
    theta: Coordinate,
    #[particle(mass = mass, at = length * (sin(theta) * x - cos(theta) * y))]
    bob: Particle,
    #[energy(stiffness / 2 * pow(length - free_length, 2))]
    coil: Potential,
}
