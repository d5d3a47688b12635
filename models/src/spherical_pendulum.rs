use linkwork::mechanism;

/// The spherical pendulum: a particle on a massless rod that hangs from a universal joint.
///
/// Source: Landau and Lifshitz, *Mechanics* (1976), §14, problem 1.
///
/// - Coordinates: `suspension.first` about x, then `suspension.second` about the carried y, `a` and `b`, rad; z points
///   up. The particle is at `l (−sin b, sin a cos b, −cos a cos b)`; the coordinates are singular where the rod lies
///   along x.
/// - Equations of motion: `m l² cos²b ä − 2 m l² sin b cos b ȧ ḃ + m g l sin a cos b = 0`,
///   `m l² b̈ + m l² sin b cos b ȧ² + m g l cos a sin b = 0`.
/// - Conical motion: at the inclination `α` the particle goes round in `T = 2π √(l cos α / g)`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalPendulum {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the particle, kg.
    pub mass: f64,
    /// Length of the rod, m.
    pub length: f64,

    #[body]
    rod: Body,
    #[particle(mass = mass, at = rod.at(-length * z))]
    bob: Particle,
    #[joint(ground -> rod, about = (x, y))]
    suspension: Universal,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;

    const P: SphericalPendulum = SphericalPendulum { g: 9.81, mass: 0.6, length: 1.2 };

    #[test]
    fn equations_of_motion() {
        let (a, b, da, db) = (0.7_f64, -1.1_f64, 1.3, 0.8);
        let (q, v) = (SVector::from([a, b]), SVector::from([da, db]));
        let ml2 = P.mass * P.length * P.length;
        let mgl = P.mass * P.g * P.length;
        let mass = SMatrix::<f64, 2, 2>::new(ml2 * b.cos() * b.cos(), 0.0, 0.0, ml2);
        assert_near(P.mass_matrix(&q), mass, 1e-14);
        let h1 = -2.0 * ml2 * b.sin() * b.cos() * da * db + mgl * a.sin() * b.cos();
        let h2 = ml2 * b.sin() * b.cos() * da * da + mgl * a.cos() * b.sin();
        assert_near(P.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
    }

    #[test]
    fn conical_motion() -> Result<(), Error> {
        // From the (y, z) plane at inclination α, a = α, b = 0, moving along −x: ḃ = ω sin α.
        let alpha = 0.9_f64;
        let period = 2.0 * std::f64::consts::PI * (P.length * alpha.cos() / P.g).sqrt();
        let speed = 2.0 * std::f64::consts::PI / period * alpha.sin();
        let method = DormandPrince::new().tolerance(1e-12, 1e-12);
        let run = simulate(&P).from([alpha, 0.0], [0.0, speed]).method(method);
        for (k, sample) in run.duration(period).sample_every(period / 8.0).enumerate() {
            let q = sample?.q;
            let turned = std::f64::consts::PI / 4.0 * k as f64;
            let at = [-q[1].sin(), q[0].sin() * q[1].cos(), -q[0].cos() * q[1].cos()];
            let circle = [-alpha.sin() * turned.sin(), alpha.sin() * turned.cos(), -alpha.cos()];
            assert_near(SVector::from(at), SVector::from(circle), 1e-9);
        }
        Ok(())
    }
}
