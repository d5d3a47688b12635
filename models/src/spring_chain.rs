use linkwork::{Real, mechanism};

/// Three equal carts in a row: the first is coupled to a wall, each other to the one before, by equal springs
/// and dashpots; the last end is free.
///
/// Source: Rayleigh, *The Theory of Sound* (1877), §120; Meirovitch, *Fundamentals of Vibrations* (2001), ch.
/// 7.
///
/// - Coordinates: `rail1`, `rail2`, `rail3`, the displacement of each cart from its equilibrium position, m.
/// - Equations of motion: `m q̈ + c K q̇ + k K q = 0`, `K = [[2, −1, 0], [−1, 2, −1], [0, −1, 1]]`.
/// - Natural frequencies `ωⱼ = 2 √(k/m) sin ½βⱼ` with `βⱼ = (2j − 1)π/7`, mode shapes `sin iβⱼ`, damping
///   ratios `ζⱼ = ½ c ωⱼ / k`.
///
/// Generic over the scalar type.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringChain<T: Real> {
    /// Mass of each cart, kg.
    pub mass: T,
    /// Stiffness of each spring, N/m.
    pub stiffness: T,
    /// Coefficient of each dashpot, N·s/m.
    pub damping: T,

    #[body(mass = mass)]
    cart1: Body,
    #[body(mass = mass)]
    cart2: Body,
    #[body(mass = mass)]
    cart3: Body,
    #[joint(ground -> cart1, along = x)]
    rail1: Sleeve,
    #[joint(ground -> cart2, along = x)]
    rail2: Sleeve,
    #[joint(ground -> cart3, along = x)]
    rail3: Sleeve,

    #[acts(between = (ground, cart1), stiffness = stiffness)]
    spring1: Spring,
    #[acts(between = (cart1, cart2), stiffness = stiffness)]
    spring2: Spring,
    #[acts(between = (cart2, cart3), stiffness = stiffness)]
    spring3: Spring,
    #[acts(between = (ground, cart1), damping = damping)]
    dashpot1: Dashpot,
    #[acts(between = (cart1, cart2), damping = damping)]
    dashpot2: Dashpot,
    #[acts(between = (cart2, cart3), damping = damping)]
    dashpot3: Dashpot,
}
