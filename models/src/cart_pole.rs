use linkwork::mechanism;

/// The cart-pole: a cart on a level rail, with a uniform pole pinned to it that is to be held upright by
/// pushing the cart. Also called inverted pendulum on a cart.
///
/// Source: Barto, Sutton and Anderson, *Neuronlike adaptive elements…*, IEEE Trans. SMC 13 (1983); Tedrake,
/// *Underactuated Robotics*, ch. 3.
///
/// - Coordinates: `rail`, the cart's displacement along x, m; `hinge`, the pole's angle from upright, `θ`,
///   rad, counter-clockwise seen from +z; y points up. Input: `push`, a force on the cart along x, N.
/// - Mass matrix (cart `M`, pole `m`, length `l`): `M₁₁ = M + m`, `M₁₂ = −½ m l cos θ`, `M₂₂ = m l²/3`.
/// - Bias forces, with g = 9.81 m/s²: `h₁ = ½ m l sin θ θ̇² + c ẋ`, `h₂ = −½ m g l sin θ`.
#[mechanism(gravity = -9.81 * y, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartPole {
    /// Mass of the cart, kg.
    pub cart_mass: f64,
    /// Mass of the pole, kg.
    pub pole_mass: f64,
    /// Length of the pole, m.
    pub pole_length: f64,
    /// Viscous friction of the cart on its rail, N·s/m.
    pub rail_damping: f64,

    #[body(mass = cart_mass)]
    cart: Body,
    #[body(mass = pole_mass, com = pole_length / 2 * y, inertia = rod(pole_mass, pole_length, y))]
    pole: Body,

    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,

    #[acts(on = rail, damping = rail_damping)]
    friction: Dashpot,
    #[acts(on = cart, along = x)]
    push: Force,
}
