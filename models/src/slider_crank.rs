use linkwork::mechanism;

/// Slider-crank of engines and pumps: a crank, a connecting rod and a piston in its cylinder, whose axis
/// passes through that of the crank.
///
/// Source: Norton, *Design of Machinery* (2004), ch. 13; Biezeno and Grammel, *Technische Dynamik* (1953),
/// ch. XII.
///
/// - Coordinates: `main` `θ`, the crank's angle from the cylinder's axis x; `big_end`, the rod's angle from
///   the crank; rad; `cylinder` `x`, the piston's position, m. y points up. The pin `small_end` closes the
///   loop. Input: `motor` `M`, a torque on the crank, N·m.
/// - `x = r cos θ + √(l² − r² sin² θ)`, and the rod's absolute angle `φ` satisfies `sin φ = −(r/l) sin θ`.
/// - In `θ` alone, with derivatives with respect to `θ` (′) and the potential energy `U`:
///   `J(θ) θ̈ + ½ J′(θ) θ̇² + U′(θ) = M` (Eksergian's equation). The reduced inertia is
///   `J = ⅓ m₁ r² + m₂ (x_c′² + y_c′²) + m₂ l²/12 φ′² + m₃ x′²` with the masses `m₁`, `m₂`, `m₃` of crank,
///   rod and piston, and the rod's centre at `(x_c, y_c) = (r cos θ + l/2 cos φ, r/2 sin θ)`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderCrank {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Length of the crank, m.
    pub r: f64,
    /// Length of the rod, m.
    pub l: f64,
    /// Mass of the crank, kg.
    pub m_crank: f64,
    /// Mass of the rod, kg.
    pub m_rod: f64,
    /// Mass of the piston, kg.
    pub m_piston: f64,

    #[body(mass = m_crank, com = r / 2 * x, inertia = rod(m_crank, r, x))]
    crank: Body,
    #[body(mass = m_rod, com = l / 2 * x, inertia = rod(m_rod, l, x))]
    rod: Body,
    #[body(mass = m_piston)]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(r * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(l * x) -> piston, about = z)]
    small_end: Pin,
    #[acts(on = main)]
    motor: Torque,
}
