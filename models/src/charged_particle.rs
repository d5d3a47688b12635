use linkwork::mechanism;

/// Charged particle in uniform crossed electric and magnetic fields.
///
/// Source: Landau and Lifshitz, *The Classical Theory of Fields* (1975), §21 and §22, for small speeds;
/// Jackson, *Classical Electrodynamics* (1999), §12.
///
/// - Coordinates: `flight.x`, `.y`, `.z`, m. The magnetic field is along z, the electric one along y.
/// - Equation of motion: `m r̈ = e (E ŷ + ṙ × B ẑ)`; the magnetic part does no work.
/// - The particle circles with the frequency `ω = e B / m`, clockwise seen from +z for a positive charge,
///   about a centre that drifts across both fields with `E / B` along x; along z it moves uniformly.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChargedParticle {
    /// Mass of the particle, kg.
    pub mass: f64,
    /// Electric charge of the particle, C.
    pub charge: f64,
    /// Electric field along y, V/m.
    pub electric: f64,
    /// Magnetic field along z, T.
    pub magnetic: f64,

    #[particle(mass = mass)]
    ion: Particle,
    #[joint(ground -> ion, along = (x, y, z))]
    flight: Stage,
    #[acts(
        on = ion,
        value = charge * (electric * ground.y + cross(v(ion / ground / ground), magnetic * ground.z))
    )]
    lorentz: Force,
}
