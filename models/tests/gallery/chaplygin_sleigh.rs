use crate::testing::precise_integrator;
use linkwork::prelude::*;
use linkwork_models::ChaplyginSleigh;

/// Checks that the speed of the sleigh has the closed form `V tanh(a V t / b² + c₀)`; the values are
/// recomputed with 40 digits.
#[test]
fn chaplygin_sleigh_has_closed_form_speed() -> Result<(), Error> {
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
        let end = simulate(&sleigh)
            .from([0.0; 3], [1.0, 0.0, 2.0])
            .method(precise_integrator())
            .duration(t)
            .finish()?;
        let along = end.v[0] * end.q[2].cos() + end.v[1] * end.q[2].sin();
        for (found, expected) in
            [(along, speed), (end.v[2], omega), (end.q[2], theta), (end.q[0], x), (end.q[1], y)]
        {
            assert!((found - expected).abs() < 1e-9, "{found} for {expected} at {t}");
        }
    }
    Ok(())
}
