use linkwork::mechanism;

/// Three pendulums, each hung from the particle of the one above.
///
/// Source: Lagrange's hanging chain of particles, *Mécanique analytique* (1788); in modern notation
/// Greenwood, *Advanced Dynamics* (2003), ch. 2.
///
/// - Coordinates: the angle of each rod relative to the one above, `θ`, rad, the first from the vertical;
///   counter-clockwise seen from +z; y points up.
/// - In the absolute angles `φ = L θ` (`L` the lower triangle of ones), with `μᵢⱼ` the mass below both:
///   `Mᵢⱼ = μᵢⱼ lᵢ lⱼ cos(φᵢ − φⱼ)`, `hᵢ = Σⱼ μᵢⱼ lᵢ lⱼ sin(φᵢ − φⱼ) φ̇ⱼ² + μᵢᵢ g lᵢ sin φᵢ`; in the relative
///   ones `Lᵀ M L` and `Lᵀ h`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriplePendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the first particle from the top, kg.
    pub m1: f64,
    /// Length of the rod above the first particle, m.
    pub l1: f64,
    /// Mass of the second particle from the top, kg.
    pub m2: f64,
    /// Length of the rod above the second particle, m.
    pub l2: f64,
    /// Mass of the third particle from the top, kg.
    pub m3: f64,
    /// Length of the rod above the third particle, m.
    pub l3: f64,

    #[body]
    rod1: Body,
    #[particle(mass = m1, at = rod1.at(-l1 * y))]
    bob1: Particle,
    #[joint(ground -> rod1, about = z)]
    pin1: Pin,

    #[body]
    rod2: Body,
    #[particle(mass = m2, at = rod2.at(-l2 * y))]
    bob2: Particle,
    #[joint(rod1.at(-l1 * y) -> rod2, about = z)]
    pin2: Pin,

    #[body]
    rod3: Body,
    #[particle(mass = m3, at = rod3.at(-l3 * y))]
    bob3: Particle,
    #[joint(rod2.at(-l2 * y) -> rod3, about = z)]
    pin3: Pin,
}

/// Five pendulums, each hung from the particle of the one above.
///
/// Source: Lagrange's hanging chain of particles, *Mécanique analytique* (1788); in modern notation
/// Greenwood, *Advanced Dynamics* (2003), ch. 2.
///
/// - Coordinates: the angle of each rod relative to the one above, `θ`, rad, the first from the vertical;
///   counter-clockwise seen from +z; y points up.
/// - In the absolute angles `φ = L θ` (`L` the lower triangle of ones), with `μᵢⱼ` the mass below both:
///   `Mᵢⱼ = μᵢⱼ lᵢ lⱼ cos(φᵢ − φⱼ)`, `hᵢ = Σⱼ μᵢⱼ lᵢ lⱼ sin(φᵢ − φⱼ) φ̇ⱼ² + μᵢᵢ g lᵢ sin φᵢ`; in the relative
///   ones `Lᵀ M L` and `Lᵀ h`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuintuplePendulum {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the first particle from the top, kg.
    pub m1: f64,
    /// Length of the rod above the first particle, m.
    pub l1: f64,
    /// Mass of the second particle from the top, kg.
    pub m2: f64,
    /// Length of the rod above the second particle, m.
    pub l2: f64,
    /// Mass of the third particle from the top, kg.
    pub m3: f64,
    /// Length of the rod above the third particle, m.
    pub l3: f64,
    /// Mass of the fourth particle from the top, kg.
    pub m4: f64,
    /// Length of the rod above the fourth particle, m.
    pub l4: f64,
    /// Mass of the fifth particle from the top, kg.
    pub m5: f64,
    /// Length of the rod above the fifth particle, m.
    pub l5: f64,

    #[body]
    rod1: Body,
    #[particle(mass = m1, at = rod1.at(-l1 * y))]
    bob1: Particle,
    #[joint(ground -> rod1, about = z)]
    pin1: Pin,

    #[body]
    rod2: Body,
    #[particle(mass = m2, at = rod2.at(-l2 * y))]
    bob2: Particle,
    #[joint(rod1.at(-l1 * y) -> rod2, about = z)]
    pin2: Pin,

    #[body]
    rod3: Body,
    #[particle(mass = m3, at = rod3.at(-l3 * y))]
    bob3: Particle,
    #[joint(rod2.at(-l2 * y) -> rod3, about = z)]
    pin3: Pin,

    #[body]
    rod4: Body,
    #[particle(mass = m4, at = rod4.at(-l4 * y))]
    bob4: Particle,
    #[joint(rod3.at(-l3 * y) -> rod4, about = z)]
    pin4: Pin,

    #[body]
    rod5: Body,
    #[particle(mass = m5, at = rod5.at(-l5 * y))]
    bob5: Particle,
    #[joint(rod4.at(-l4 * y) -> rod5, about = z)]
    pin5: Pin,
}
