use crate::testing::precise_integrator;
use linkwork::prelude::*;
use linkwork_models::CarAxle;

/// Reference configuration of the car axle at t = 3 s, recomputed at 160 and at 230 bits; the published
/// digits are accurate to 2e-13 and 5e-12.
#[test]
fn car_axle_ends_where_published() -> Result<(), Error> {
    let start = ([0.0, 0.5, 1.0, 0.5], [-0.5, 0.0, -0.5, 0.0]);
    let end =
        simulate(&CarAxle {}).from(start.0, start.1).method(precise_integrator()).duration(3.0).finish()?;
    let q =
        [0.049_345_578_427_524_09, 0.496_989_460_230_008_1, 1.041_742_524_885_426_1, 0.373_911_027_265_365_8];
    let v = [
        -0.077_058_368_403_592_08,
        0.007_446_866_592_068_416,
        0.017_556_815_753_541_737,
        0.770_341_043_779_601_1,
    ];
    for k in 0..4 {
        assert!((end.q[k] - q[k]).abs() < 1e-9, "{} for {}", end.q[k], q[k]);
        assert!((end.v[k] - v[k]).abs() < 1e-8, "{} for {}", end.v[k], v[k]);
    }
    let (_, lambda) = CarAxle {}.constrained_dynamics(3.0, &end.q, &end.v, &SVector::zeros());
    assert!((lambda[0].abs() - 0.004_736_890_853_327).abs() < 1e-5);
    Ok(())
}
