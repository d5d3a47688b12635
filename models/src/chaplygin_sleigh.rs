use linkwork::mechanism;

/// Chaplygin's sleigh: a body on ice with a knife edge behind its centre of mass, which cannot move sideways.
///
/// Source: Neimark and Fufaev, *Dynamics of Nonholonomic Systems* (1972), ch. III.
///
/// - Coordinates: `ice.x`, `ice.y`, place of the knife, m; `ice.angle`, its heading from x, rad.
/// - With the speed `u` along the knife and the turning rate `ω`: `u̇ = a ω²`, `(J + m a²) ω̇ = −m a u ω`. The energy
///   is constant, and yet the motion settles: the sleigh comes to run straight, centre of mass ahead, with
///   `u = V tanh(a V t / b² + const)`, `b² = a² + J/m`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChaplyginSleigh {
    /// Mass, kg.
    pub m: f64,
    /// Moment of inertia about the centre of mass, kg·m².
    pub j: f64,
    /// Distance of the centre of mass ahead of the knife, m.
    pub a: f64,

    #[body(mass = m, com = a * x, inertia = diagonal(j, j, j))]
    sleigh: Body,
    #[joint(ground -> sleigh, about = z)]
    ice: Planar,
    #[constraint(dot(v(sleigh / ground / ground), sleigh.y) = 0)]
    knife: Nonholonomic,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::precisely;
    use linkwork::prelude::*;

    /// Closed form: the speed is `V tanh(a V t / b² + c₀)`; numbers recomputed with 40 digits.
    #[test]
    fn chaplygin_sleigh_turns_as_in_closed_form() -> Result<(), Error> {
        let sleigh = ChaplyginSleigh { m: 1.0, j: 0.5, a: 0.3 };
        assert_eq!((ChaplyginSleigh::NC, ChaplyginSleigh::NH), (1, 0));
        let expected = [
            (
                1.0,
                1.673_191_826_372_095_2,
                0.974_617_797_457_740_3,
                1.467_231_285_606_897_4,
                0.823_501_028_052_335_3,
                1.003_301_201_874_24,
            ),
            (
                2.0,
                1.807_301_740_160_160_3,
                0.398_430_012_172_898_86,
                2.114_909_695_873_111,
                0.358_507_785_605_608_25,
                2.668_852_065_606_508,
            ),
            (
                5.0,
                1.832_933_726_462_331_8,
                0.024_493_319_632_642_27,
                2.518_118_973_093_921_7,
                -3.663_966_360_101_140_4,
                6.349_650_348_860_546,
            ),
        ];
        for (t, speed, omega, theta, x, y) in expected {
            let end =
                simulate(&sleigh).from([0.0; 3], [1.0, 0.0, 2.0]).method(precisely()).duration(t).finish()?;
            let along = end.v[0] * end.q[2].cos() + end.v[1] * end.q[2].sin();
            for (found, expected) in
                [(along, speed), (end.v[2], omega), (end.q[2], theta), (end.q[0], x), (end.q[1], y)]
            {
                assert!((found - expected).abs() < 1e-9, "{found} for {expected} at {t}");
            }
        }
        Ok(())
    }
}
