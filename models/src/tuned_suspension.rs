use linkwork::mechanism;

/// Two carts with springs, a dashpot and an inerter: the second mass is tuned to absorb the vibration of the
/// first.
///
/// Source: Den Hartog, *Mechanical Vibrations* (1956), ch. 3 (tuned absorber); Smith, *Synthesis of
/// mechanical networks: the inerter*, IEEE Trans. Automatic Control 47 (2002).
///
/// - Coordinates: `rail1` and `rail2`, the displacements of the carts, `x₁` and `x₂`, m; all springs are
///   slack at zero. Input: `shaker`, a force on the first cart, N.
/// - Equations of motion: `M = [[m₁ + b, −b], [−b, m₂ + b]]`, `C = c [[1, −1], [−1, 1]]`,
///   `K = [[k₁ + k₂, −k₂], [−k₂, k₂]]`: the inerter adds to the mass matrix as a spring does to the
///   stiffness.
/// - Without the dashpot and with excitation at `ω = √(k₂ / (m₂ + b))` the first cart is at rest, while the
///   second moves by `F / (ω² b − k₂)`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TunedSuspension {
    /// Mass of the first cart, kg.
    pub m1: f64,
    /// Mass of the second cart, kg.
    pub m2: f64,
    /// Stiffness of the spring between the wall and the first cart, N/m.
    pub k1: f64,
    /// Stiffness of the spring between the carts, N/m.
    pub k2: f64,
    /// Coefficient of the dashpot between the carts, N·s/m.
    pub damping: f64,
    /// Inertance of the inerter between the carts, kg.
    pub inertance: f64,

    #[body(mass = m1)]
    first: Body,
    #[body(mass = m2)]
    second: Body,
    #[joint(ground -> first, along = x)]
    rail1: Sleeve,
    #[joint(ground -> second, along = x)]
    rail2: Sleeve,
    #[acts(between = (ground, first), stiffness = k1)]
    anchor: Spring,
    #[acts(between = (first, second), stiffness = k2)]
    coil: Spring,
    #[acts(between = (first, second), damping = damping)]
    damper: Dashpot,
    #[acts(between = (first, second), inertance = inertance)]
    inerter: Inerter,
    #[acts(on = rail1)]
    shaker: Force,
}
