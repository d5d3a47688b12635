use linkwork::mechanism;

/// A planar arm with two links whose motors both stand on the ground: geared, and the second drives the forearm by a
/// belt, so that the coordinates are the links' absolute angles.
///
/// Source: Spong and Vidyasagar, *Robot Dynamics and Control* (1989), §6.4 (planar elbow manipulator with remotely
/// driven link).
///
/// - Coordinates: `p1` and `p2`, the angles of both links from x, rad; y points up. Inputs: `motor1` and `motor2`,
///   torques on the links from the ground (a motor's own times the gear ratio), N·m. Output: `hand`, the place of the
///   forearm's end, m.
/// - With uniform links and rotors `J` behind gears of ratio `n`: `M₁₁ = (⅓ m₁ + m₂) l₁² + n² J`,
///   `M₁₂ = ½ m₂ l₁ l₂ cos(p₂ − p₁)`, `M₂₂ = ⅓ m₂ l₂² + n² J`.
/// - `h₁ = −½ m₂ l₁ l₂ sin(p₂ − p₁) ṗ₂² + (½ m₁ + m₂) g l₁ cos p₁`,
///   `h₂ = ½ m₂ l₁ l₂ sin(p₂ − p₁) ṗ₁² + ½ m₂ g l₂ cos p₂`: in absolute angles there are no Coriolis terms, only
///   centrifugal ones.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemotelyDrivenArm {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the upper arm, kg.
    pub m1: f64,
    /// Mass of the forearm, kg.
    pub m2: f64,
    /// Length of the upper arm, m.
    pub l1: f64,
    /// Length of the forearm, m.
    pub l2: f64,
    /// Moment of inertia of each motor's rotor about its axis, kg·m².
    pub rotor: f64,
    /// Turns of a rotor for one turn of its link.
    pub ratio: f64,

    p1: Coordinate,
    p2: Coordinate,
    #[frame(ground, z(p1))]
    upper_axes: Frame,
    #[frame(ground, z(p2))]
    lower_axes: Frame,
    #[frame(ground, z(ratio * p1))]
    rotor1_axes: Frame,
    #[frame(ground, z(ratio * p2))]
    rotor2_axes: Frame,

    #[body(mass = m1, com = l1 / 2 * x, inertia = rod(m1, l1, x), frame = upper_axes)]
    upper: Body,
    #[body(mass = m2, com = l2 / 2 * x, inertia = rod(m2, l2, x), at = upper.at(l1 * x), frame = lower_axes)]
    lower: Body,
    #[body(inertia = diagonal(rotor / 2, rotor / 2, rotor), frame = rotor1_axes)]
    rotor1: Body,
    #[body(inertia = diagonal(rotor / 2, rotor / 2, rotor), frame = rotor2_axes)]
    rotor2: Body,
    #[acts(on = upper, about = z)]
    motor1: Torque,
    #[acts(on = lower, about = z)]
    motor2: Torque,
    #[output(r(lower.at(l2 * x) / ground))]
    hand: Vector,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;

    const A: RemotelyDrivenArm =
        RemotelyDrivenArm { g: 9.81, m1: 2.0, m2: 1.3, l1: 0.6, l2: 0.5, rotor: 3e-5, ratio: 60.0 };

    #[test]
    fn mass_matrix_and_bias_forces() {
        let RemotelyDrivenArm { g, m1, m2, l1, l2, rotor, ratio } = A;
        let (p1, p2, d1, d2) = (0.4_f64, 1.5_f64, 2.0, -0.8);
        let (q, v) = (SVector::from([p1, p2]), SVector::from([d1, d2]));
        let geared = ratio * ratio * rotor;
        let (s, c) = (p2 - p1).sin_cos();
        let both = m2 * l1 * l2 / 2.0;
        let m11 = (m1 / 3.0 + m2) * l1 * l1 + geared;
        let m22 = m2 * l2 * l2 / 3.0 + geared;
        assert_near(A.mass_matrix(&q), SMatrix::<f64, 2, 2>::new(m11, both * c, both * c, m22), 1e-14);
        let h1 = -both * s * d2 * d2 + (m1 / 2.0 + m2) * g * l1 * p1.cos();
        let h2 = both * s * d1 * d1 + m2 * g * l2 / 2.0 * p2.cos();
        assert_near(A.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-13);
        let u = SVector::from([1.5, -0.7]);
        assert_near(A.generalized_forces(&q, &u), u, 1e-15);
        let hand = [l1 * p1.cos() + l2 * p2.cos(), l1 * p1.sin() + l2 * p2.sin(), 0.0];
        assert_near(A.hand(&q), SVector::from(hand), 1e-15);
    }
}
