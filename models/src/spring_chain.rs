use linkwork::{Real, mechanism};

/// Three equal carts in a row: the first is coupled to a wall, each other to the one before, by equal springs and
/// dashpots; the last end is free.
///
/// Source: Rayleigh, *The Theory of Sound* (1877), §120; Meirovitch, *Fundamentals of Vibrations* (2001), ch. 7.
///
/// - Coordinates: `rail1`, `rail2`, `rail3`, the displacement of each cart from its place of rest, m.
/// - Equations of motion: `m q̈ + c K q̇ + k K q = 0`, `K = [[2, −1, 0], [−1, 2, −1], [0, −1, 1]]`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;
    use std::f64::consts::PI;

    const C: SpringChain<f64> = SpringChain { mass: 0.8, stiffness: 50.0, damping: 0.6 };

    /// Natural frequency, damping ratio and shape of mode j.
    fn mode(j: usize) -> (f64, f64, SVector<f64, 3>) {
        let beta = (2 * j - 1) as f64 * PI / 7.0;
        let omega = 2.0 * (C.stiffness / C.mass).sqrt() * (beta / 2.0).sin();
        let shape = SVector::from_fn(|i, _| ((i + 1) as f64 * beta).sin());
        (omega, C.damping * omega / (2.0 * C.stiffness), shape)
    }

    #[test]
    fn equations_of_motion() {
        let k = SMatrix::<f64, 3, 3>::new(2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 1.0);
        let (q, v) = (SVector::from([0.1, -0.3, 0.2]), SVector::from([1.0, 0.4, -2.0]));
        assert_near(C.mass_matrix(&q), SMatrix::identity() * C.mass, 1e-15);
        assert_near(C.bias_forces(&q, &v), k * (C.stiffness * q + C.damping * v), 1e-14);
    }

    #[test]
    fn modes_are_decoupled() {
        for j in 1..=3 {
            let (omega, zeta, shape) = mode(j);
            let (q, v) = (0.05 * shape, 0.2 * shape);
            let a = C.forward_dynamics(&q, &v, &SVector::zeros());
            assert_near(a, -omega * omega * q - 2.0 * zeta * omega * v, 1e-13);
        }
    }

    #[test]
    fn modes_decay_at_their_own_rate() -> Result<(), Error> {
        for j in 1..=3 {
            let (omega, zeta, shape) = mode(j);
            let damped = omega * (1.0 - zeta * zeta).sqrt();
            let start = simulate(&C).from(0.05 * shape, SVector::zeros());
            for sample in start.duration(1.0).sample_every(0.25) {
                let Sample { t, q, .. } = sample?;
                let swing = (damped * t).cos() + zeta * omega / damped * (damped * t).sin();
                assert_near(q, 0.05 * shape * swing * (-zeta * omega * t).exp(), 1e-8);
            }
        }
        Ok(())
    }
}
