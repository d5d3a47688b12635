use linkwork::mechanism;

/// Furuta's pendulum, or rotary pendulum: an arm that a motor turns about the vertical, and a pendulum pinned to its
/// end that swings across the arm.
///
/// Source: Furuta, Yamakita and Kobayashi, *Swing up control of inverted pendulum* (1991); Cazzolato and Prime, *On the
/// dynamics of the Furuta pendulum*, J. Control Sci. Eng. (2011).
///
/// - Coordinates: `motor`, the arm's angle `φ` about the vertical z; `elbow`, the pendulum's angle `θ` from hanging
///   about the arm; both rad. Input: `drive`, a torque on the arm, N·m.
/// - Mass matrix of uniform rods (mass and length of the arm `M`, `r`, of the pendulum `m`, `l`):
///   `M₁₁ = ⅓ M r² + m r² + ⅓ m l² sin² θ`, `M₁₂ = ½ m r l cos θ`, `M₂₂ = ⅓ m l²`.
/// - Bias forces: `h₁ = ⅔ m l² sin θ cos θ θ̇ φ̇ − ½ m r l sin θ θ̇²`, `h₂ = −⅓ m l² sin θ cos θ φ̇² + ½ m g l sin θ`.
/// - With the arm free, small swings have the frequency `√(½ m g l M₁₁ / (M₁₁ M₂₂ − M₁₂²))`, taken at `θ = 0`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FurutaPendulum {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the arm, kg.
    pub arm_mass: f64,
    /// Length of the arm, m.
    pub arm_length: f64,
    /// Mass of the pendulum, kg.
    pub mass: f64,
    /// Length of the pendulum, m.
    pub length: f64,

    #[body(mass = arm_mass, com = arm_length / 2 * x, inertia = rod(arm_mass, arm_length, x))]
    arm: Body,
    #[body(mass = mass, com = -length / 2 * z, inertia = rod(mass, length, z))]
    pendulum: Body,
    #[joint(ground -> arm, about = z)]
    motor: Pin,
    #[joint(arm.at(arm_length * x) -> pendulum, about = x)]
    elbow: Pin,
    #[acts(on = motor)]
    drive: Torque,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near, precisely};
    use linkwork::prelude::*;
    use std::f64::consts::TAU;

    const P: FurutaPendulum =
        FurutaPendulum { g: 9.81, arm_mass: 0.3, arm_length: 0.25, mass: 0.12, length: 0.4 };

    fn mass_matrix(theta: f64) -> SMatrix<f64, 2, 2> {
        let FurutaPendulum { arm_mass, arm_length: r, mass: m, length: l, .. } = P;
        let m22 = m * l * l / 3.0;
        let m12 = m * r * l * theta.cos() / 2.0;
        SMatrix::<f64, 2, 2>::new((arm_mass / 3.0 + m) * r * r + m22 * theta.sin().powi(2), m12, m12, m22)
    }

    #[test]
    fn mass_matrix_and_bias_forces() {
        let FurutaPendulum { g, arm_length: r, mass: m, length: l, .. } = P;
        let (theta, dphi, dtheta) = (0.8_f64, 2.1, -1.4);
        let (q, v) = (SVector::from([0.5, theta]), SVector::from([dphi, dtheta]));
        assert_near(P.mass_matrix(&q), mass_matrix(theta), 1e-15);
        let (s, c) = theta.sin_cos();
        let h1 = m * l * l * s * c * dtheta * dphi / 1.5 - m * r * l * s * dtheta * dtheta / 2.0;
        let h2 = -m * l * l * s * c * dphi * dphi / 3.0 + m * g * l * s / 2.0;
        assert_near(P.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
    }

    #[test]
    fn small_swings_with_a_free_arm() -> Result<(), Error> {
        let m = mass_matrix(0.0);
        let frequency = (P.mass * P.g * P.length / 2.0 * m[(0, 0)] / m.determinant()).sqrt();
        let end = simulate(&P)
            .from([0.0, 1e-4], [0.0, 0.0])
            .method(precisely())
            .until_crossing(Crossing::Falling, |_, _, v| v[1])
            .finish()?;
        assert_close(end.t, TAU / frequency, 1e-6);
        Ok(())
    }
}
