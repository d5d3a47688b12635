use linkwork::mechanism;

/// The rate gyroscope: a fast rotor in one gimbal on a turning base; the gimbal's deflection against its spring
/// measures how fast the base turns.
///
/// Source: Magnus, *Kreisel* (1971); Bernstein, Goel and Ansari, *Geometry, Kinematics, Statics, and Dynamics*, on
/// gimbals.
///
/// - The housing turns about z with the prescribed rate `Ω`, so the functions take the time first. Coordinates:
///   `gimbal`, its angle `θ` about the housing's x, rad; `spin`, the rotor's angle about its axis, the gimbal's y, rad.
/// - With `n = ψ̇ + Ω sin θ`, the rotor's whole spin, and the moments of inertia `C` about its axis and `A` across:
///   `A θ̈ + A Ω² sin θ cos θ − C n Ω cos θ + k θ + c θ̇ = 0`, `C ṅ = 0`.
/// - At rest `k θ = (C n − A Ω sin θ) Ω cos θ`: in proportion to `Ω` while that is small.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateGyroscope {
    /// Rate at which the housing turns, rad/s.
    pub rate: f64,
    /// Moment of inertia of the rotor about its axis, kg·m².
    pub axial: f64,
    /// Moment of inertia of the rotor across its axis, kg·m².
    pub transverse: f64,
    /// Stiffness of the spring that centres the gimbal, N·m/rad.
    pub stiffness: f64,
    /// Damping of the gimbal, N·m·s/rad.
    pub damping: f64,

    #[frame(ground, z(rate * t))]
    vehicle: Frame,
    #[body(frame = vehicle)]
    housing: Body,
    #[body]
    cradle: Body,
    #[body(inertia = diagonal(transverse, axial, transverse))]
    rotor: Body,
    #[joint(housing -> cradle, about = x)]
    gimbal: Pin,
    #[joint(cradle -> rotor, about = y)]
    spin: Pin,
    #[acts(on = gimbal, stiffness = stiffness)]
    centring: Spring,
    #[acts(on = gimbal, damping = damping)]
    damper: Dashpot,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near};
    use linkwork::prelude::*;

    const G: RateGyroscope =
        RateGyroscope { rate: 0.4, axial: 2e-4, transverse: 1.2e-4, stiffness: 0.5, damping: 0.01 };

    #[test]
    fn equations_of_motion() {
        let (theta, dtheta, spin) = (0.3_f64, -0.7, 900.0);
        let (q, v) = (SVector::from([theta, 1.1]), SVector::from([dtheta, spin]));
        let (s, c) = theta.sin_cos();
        let (a, n, rate) = (G.transverse, spin + G.rate * s, G.rate);
        let h1 = a * rate * rate * s * c - G.axial * n * rate * c + 0.5 * theta + 0.01 * dtheta;
        let h2 = G.axial * rate * c * dtheta;
        assert_near(G.bias_forces(2.5, &q, &v), SVector::from([h1, h2]), 1e-14);
        let mass = SMatrix::<f64, 2, 2>::new(a, 0.0, 0.0, G.axial);
        assert_near(G.mass_matrix(2.5, &q), mass, 1e-18);
    }

    #[test]
    fn deflection_measures_the_rate() -> Result<(), Error> {
        let whole = 900.0;
        let settled = simulate(&G).from([0.0, 0.0], [0.0, whole]).duration(3.0).finish()?;
        let (s, c) = settled.q[0].sin_cos();
        let expected = (G.axial * whole - G.transverse * G.rate * s) * G.rate * c / G.stiffness;
        assert_close(settled.q[0] / expected, 1.0, 1e-6);
        assert_close(settled.v[1] + G.rate * s, whole, 1e-8);
        Ok(())
    }
}
