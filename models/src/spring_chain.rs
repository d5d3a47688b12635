use linkwork::{Real, mechanism};

/// Three equal carts in a row: the first is coupled to a wall, each other to the one before, by equal springs and
/// dashpots; the last end is free.
///
/// Source: Rayleigh, *The Theory of Sound* (1877), §120; Meirovitch, *Fundamentals of Vibrations* (2001), ch. 7.
///
/// - Coordinates: `gap1`, `gap2`, `gap3`, the distance of each cart from the one before, m; all are `spacing` at rest.
/// - In the displacements from rest, `q`: `m q̈ + c K q̇ + k K q = 0`, `K = [[2, −1, 0], [−1, 2, −1], [0, −1, 1]]`.
/// - Natural frequencies `ωⱼ = 2 √(k/m) sin ½βⱼ` with `βⱼ = (2j − 1)π/7`, mode shapes `sin iβⱼ`, damping ratios
///   `ζⱼ = ½ c ωⱼ / k`.
///
/// Generic over its numbers.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringChain<T: Real> {
    /// Mass of each cart, kg.
    pub mass: T,
    /// Stiffness of each spring, N/m.
    pub stiffness: T,
    /// Coefficient of each dashpot, N·s/m.
    pub damping: T,
    /// Free length of each spring, m.
    pub spacing: T,

    #[body(mass = mass)]
    cart1: Body,
    #[body(mass = mass)]
    cart2: Body,
    #[body(mass = mass)]
    cart3: Body,
    #[joint(ground -> cart1, along = x)]
    gap1: Sleeve,
    #[joint(cart1 -> cart2, along = x)]
    gap2: Sleeve,
    #[joint(cart2 -> cart3, along = x)]
    gap3: Sleeve,

    #[acts(on = gap1, stiffness = stiffness, free_length = spacing)]
    spring1: Spring,
    #[acts(on = gap2, stiffness = stiffness, free_length = spacing)]
    spring2: Spring,
    #[acts(on = gap3, stiffness = stiffness, free_length = spacing)]
    spring3: Spring,
    #[acts(on = gap1, damping = damping)]
    dashpot1: Dashpot,
    #[acts(on = gap2, damping = damping)]
    dashpot2: Dashpot,
    #[acts(on = gap3, damping = damping)]
    dashpot3: Dashpot,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;
    use std::f64::consts::PI;

    const C: SpringChain<f64> = SpringChain { mass: 0.8, stiffness: 50.0, damping: 0.6, spacing: 0.3 };

    /// Natural frequency, damping ratio and shape of mode j, the shape as changes of the gaps.
    fn mode(j: usize) -> (f64, f64, SVector<f64, 3>) {
        let beta = (2 * j - 1) as f64 * PI / 7.0;
        let omega = 2.0 * (C.stiffness / C.mass).sqrt() * (beta / 2.0).sin();
        let displacement = |i: usize| (i as f64 * beta).sin();
        let shape = SVector::from_fn(|i, _| displacement(i + 1) - displacement(i));
        (omega, C.damping * omega / (2.0 * C.stiffness), shape)
    }

    #[test]
    fn modes_are_decoupled() {
        let rest = SVector::<f64, 3>::repeat(C.spacing);
        for j in 1..=3 {
            let (omega, zeta, shape) = mode(j);
            let (dq, v) = (0.05 * shape, 0.2 * shape);
            let a = C.forward_dynamics(&(rest + dq), &v, &SVector::zeros());
            assert_near(a, -omega * omega * dq - 2.0 * zeta * omega * v, 1e-13);
        }
    }

    #[test]
    fn modes_decay_at_their_own_rate() -> Result<(), Error> {
        let rest = SVector::<f64, 3>::repeat(C.spacing);
        for j in 1..=3 {
            let (omega, zeta, shape) = mode(j);
            let damped = omega * (1.0 - zeta * zeta).sqrt();
            let start = simulate(&C).from(rest + 0.05 * shape, SVector::zeros());
            for sample in start.duration(1.0).sample_every(0.25) {
                let Sample { t, q, .. } = sample?;
                let swing = (damped * t).cos() + zeta * omega / damped * (damped * t).sin();
                assert_near(q, rest + 0.05 * shape * swing * (-zeta * omega * t).exp(), 1e-8);
            }
        }
        Ok(())
    }
}
