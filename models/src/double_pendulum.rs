use linkwork::mechanism;

/// The double pendulum of two uniform rods, the second pinned to the end of the first.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), ch. 1; chaotic for large swings.
///
/// - Coordinates: `shoulder` from the vertical and `elbow` relative to the upper rod, `θ₁` and `θ₂`, rad,
///   counter-clockwise seen from +z; y points up.
/// - Mass matrix: `M₁₁ = (m₁/3 + m₂) l₁² + m₂ l₂²/3 + m₂ l₁ l₂ cos θ₂`,
///   `M₁₂ = m₂ l₂²/3 + ½ m₂ l₁ l₂ cos θ₂`, `M₂₂ = m₂ l₂²/3`.
/// - Bias forces: `h₁ = −m₂ l₁ l₂ sin θ₂ (θ̇₁ + ½ θ̇₂) θ̇₂ + (½ m₁ + m₂) g l₁ sin θ₁ + ½ m₂ g l₂ sin(θ₁ + θ₂)`,
///   `h₂ = ½ m₂ l₁ l₂ sin θ₂ θ̇₁² + ½ m₂ g l₂ sin(θ₁ + θ₂)`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoublePendulum {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the upper rod, kg.
    pub m1: f64,
    /// Mass of the lower rod, kg.
    pub m2: f64,
    /// Length of the upper rod, m.
    pub l1: f64,
    /// Length of the lower rod, m.
    pub l2: f64,

    #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))]
    upper: Body,
    #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-l1 * y) -> lower, about = z)]
    elbow: Pin,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;

    #[test]
    fn mass_matrix_and_bias_forces() {
        let DoublePendulum { g, m1, m2, l1, l2 } =
            DoublePendulum { g: 9.81, m1: 1.2, m2: 0.7, l1: 0.9, l2: 0.6 };
        let p = DoublePendulum { g, m1, m2, l1, l2 };
        for (a, b, da, db) in [(0.4, -1.1, 2.0, -0.5), (2.9, 1.3, -0.7, 3.1)] {
            let (q, v) = (SVector::from([a, b]), SVector::from([da, db]));
            let (c, s) = (f64::cos(b), f64::sin(b));
            let m22 = m2 * l2 * l2 / 3.0;
            let m12 = m22 + m2 * l1 * l2 * c / 2.0;
            let m11 = (m1 / 3.0 + m2) * l1 * l1 + m22 + m2 * l1 * l2 * c;
            assert_near(p.mass_matrix(&q), SMatrix::<f64, 2, 2>::new(m11, m12, m12, m22), 1e-14);
            let lower = m2 * g * l2 / 2.0 * f64::sin(a + b);
            let h1 =
                -m2 * l1 * l2 * s * (da + db / 2.0) * db + (m1 / 2.0 + m2) * g * l1 * f64::sin(a) + lower;
            let h2 = m2 * l1 * l2 / 2.0 * s * da * da + lower;
            assert_near(p.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
        }
    }
}
