use linkwork::mechanism;

/// Uniform rod that hangs from a pin in a level slot without friction.
///
/// Source: Landau and Lifshitz, *Mechanics* (1976), §14, problem 3, with a rod for the bob and no mass at the
/// pin.
///
/// - Coordinates: `slot.slide`, the position `x` of the pin along the slot, m; `slot.turn`, the angle `θ` of
///   the rod from the vertical, rad, counter-clockwise seen from +z; y points up.
/// - Mass matrix: `M₁₁ = m`, `M₁₂ = ½ m l cos θ`, `M₂₂ = ⅓ m l²`. Bias forces: `h₁ = −½ m l sin θ θ̇²`,
///   `h₂ = ½ m g l sin θ`.
/// - No force acts along the slot: `m (ẋ + ½ l cos θ θ̇)` is constant, and from rest the centre of mass moves
///   on a vertical line. Then `½ (1/12 + ¼ sin² θ) m l² θ̇² − ½ m g l cos θ` is constant, and small
///   oscillations have the frequency `√(6 g / l)`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodInSlot {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the rod, kg.
    pub mass: f64,
    /// Length of the rod, m.
    pub length: f64,

    #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
    rod: Body,
    #[joint(ground -> rod, along = x, about = z)]
    slot: Slot,
}
