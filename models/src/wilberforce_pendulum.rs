use linkwork::mechanism;

/// Wilberforce's pendulum: a weight on a coil spring whose motion alternates between translation and
/// rotation.
///
/// Source: Wilberforce, *On the vibrations of a loaded spiral spring*, Phil. Mag. 38 (1894); Berg and
/// Marshall, *Wilberforce pendulum oscillations and normal modes*, Am. J. Phys. 59 (1991).
///
/// - Coordinates: `coil.slide`, the height `z` above the equilibrium position, m; `coil.turn`, the twist `θ`,
///   rad.
/// - Equations of motion: `m z̈ + k z + ½ ε θ = 0`, `J θ̈ + δ θ + ½ ε z = 0`.
/// - Tuned, so that `k/m = δ/J = ω²`, the modes have the frequencies `ω₁,₂² = ω² ± ½ ε / √(m J)`. Released at
///   `z₀`, untwisted: `z = ½ z₀ (cos ω₁t + cos ω₂t)`, `θ = ½ z₀ √(m/J) (cos ω₁t − cos ω₂t)`: all the energy
///   is transferred to the rotation and back.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WilberforcePendulum {
    /// Mass of the weight, kg.
    pub mass: f64,
    /// Moment of inertia of the weight about the vertical, kg·m².
    pub inertia: f64,
    /// Stiffness of the spring along its axis, N/m.
    pub stiffness: f64,
    /// Stiffness of the spring about its axis, N·m/rad.
    pub torsion: f64,
    /// Coupling coefficient `ε` of the spring, N: half of it is the force per twist and the torque per
    /// stretch.
    pub coupling: f64,

    #[body(mass = mass, inertia = diagonal(inertia / 2, inertia / 2, inertia))]
    weight: Body,
    #[joint(ground -> weight, along = z)]
    coil: Collar,
    #[acts(on = coil.slide, stiffness = stiffness)]
    stretching: Spring,
    #[acts(on = coil.turn, stiffness = torsion)]
    twisting: Spring,
    #[energy(coupling / 2 * coil.slide * coil.turn)]
    both: Potential,
}
