use linkwork::mechanism;

/// Bead that slides on a circular hoop, which rotates about its vertical diameter at a constant rate.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), ch. 2; Strogatz, *Nonlinear Dynamics and
/// Chaos* (2015), §3.5.
///
/// - Coordinate: `theta`, the bead's angle `θ` from the bottom of the hoop, rad. The hoop rotates at the
///   prescribed rate `Ω`, so the functions have the time as their first argument.
/// - Equation of motion: `m R² θ̈ + m g R sin θ − m R² Ω² sin θ cos θ = 0`.
/// - Equilibria: the bottom, the top and, if `Ω² > g / R`, `cos θ₀ = g / (R Ω²)`; about the last the bead
///   oscillates with the frequency `Ω sin θ₀`. The bottom is then unstable.
/// - The energy is not conserved, because the drive does work; Jacobi's integral
///   `½ m R² (θ̇² − Ω² sin² θ) − m g R cos θ` is.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeadOnSpinningHoop {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the bead, kg.
    pub mass: f64,
    /// Radius of the hoop, m.
    pub radius: f64,
    /// Angular velocity of the hoop, rad/s.
    pub spin: f64,

    theta: Coordinate,
    #[frame(ground, z(spin * t))]
    hoop: Frame,
    #[particle(mass = mass, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))]
    bead: Particle,
}
