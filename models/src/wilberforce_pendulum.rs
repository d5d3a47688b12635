use linkwork::mechanism;

/// Wilberforce's pendulum: a weight on a coil spring that bounces and twists by turns.
///
/// Source: Wilberforce, *On the vibrations of a loaded spiral spring*, Phil. Mag. 38 (1894); Berg and Marshall,
/// *Wilberforce pendulum oscillations and normal modes*, Am. J. Phys. 59 (1991).
///
/// - Coordinates: `coil.slide`, the height `z` above the place of rest, m; `coil.turn`, the twist `θ`, rad.
/// - Equations of motion: `m z̈ + k z + ½ ε θ = 0`, `J θ̈ + δ θ + ½ ε z = 0`.
/// - Tuned, so that `k/m = δ/J = ω²`, the modes have the frequencies `ω₁,₂² = ω² ± ½ ε / √(m J)`. Released at `z₀`,
///   untwisted: `z = ½ z₀ (cos ω₁t + cos ω₂t)`, `θ = ½ z₀ √(m/J) (cos ω₁t − cos ω₂t)`: all the energy goes over and
///   back.
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
    /// Coupling `ε`, N: half of it is the force per twist and the torque per stretch.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_near, precisely};
    use linkwork::prelude::*;

    /// Of the size of Berg and Marshall's.
    const P: WilberforcePendulum = WilberforcePendulum {
        mass: 0.4905,
        inertia: 1.39e-4,
        stiffness: 2.63,
        torsion: 7.44e-4,
        coupling: 9.27e-3,
    };

    #[test]
    fn equations_of_motion() {
        let q = SVector::from([0.04, -1.3]);
        let bias = [2.63 * q[0] + 4.635e-3 * q[1], 7.44e-4 * q[1] + 4.635e-3 * q[0]];
        assert_near(P.bias_forces(&q, &SVector::from([0.1, 2.0])), SVector::from(bias), 1e-15);
        let mass = SMatrix::<f64, 2, 2>::new(P.mass, 0.0, 0.0, P.inertia);
        assert_near(P.mass_matrix(&q), mass, 1e-16);
    }

    #[test]
    fn bouncing_becomes_twisting_and_back() -> Result<(), Error> {
        let omega2 = P.stiffness / P.mass;
        let tuned = WilberforcePendulum { torsion: omega2 * P.inertia, ..P };
        let split = P.coupling / (2.0 * (P.mass * P.inertia).sqrt());
        let (first, second) = ((omega2 + split).sqrt(), (omega2 - split).sqrt());
        let lever = (P.mass / P.inertia).sqrt();
        for sample in
            simulate(&tuned).from([0.1, 0.0], [0.0; 2]).method(precisely()).duration(40.0).sample_every(2.0)
        {
            let Sample { t, q, .. } = sample?;
            let (a, b) = ((first * t).cos(), (second * t).cos());
            assert_near(q, SVector::from([0.05 * (a + b), 0.05 * lever * (a - b)]), 1e-8);
        }
        Ok(())
    }
}
