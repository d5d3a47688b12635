use linkwork::mechanism;

/// A car's axle on a road that is bumpy on one side: each wheel carries a mass on a spring, a massless bar joins the
/// masses, and the left spring stays at right angles to the line from wheel to wheel.
///
/// Source: Test Set for IVP Solvers (Mazzia and Magherini), problem `caraxis`; Hairer and Wanner, *Solving Ordinary
/// Differential Equations II* (1996), ch. VII.
///
/// - Coordinates: `xl`, `yl` and `xr`, `yr`, the places of the left and the right mass, m; y points up. The left wheel
///   is the origin, the right one is at `(√(1 − b²), b)` with the bump `b = 0.1 sin 10 t`: the functions take the time
///   first.
/// - All numbers are those of the test set: masses of 0.5 g, springs of 1 N/m and 0.5 m, a bar of 1 m, and gravity of
///   1 m/s².
#[mechanism(gravity = -1 * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarAxle {
    xl: Coordinate,
    yl: Coordinate,
    xr: Coordinate,
    yr: Coordinate,
    #[particle(mass = 5e-4, at = xl * x + yl * y)]
    left: Particle,
    #[particle(mass = 5e-4, at = xr * x + yr * y)]
    right: Particle,
    #[define(0.1 * sin(10 * t))]
    bump: Scalar,
    #[point(at = sqrt(1 - bump * bump) * x + bump * y)]
    wheel: Point,
    #[acts(between = (ground, left), stiffness = 1, free_length = 0.5)]
    left_spring: Spring,
    #[acts(between = (wheel, right), stiffness = 1, free_length = 0.5)]
    right_spring: Spring,
    #[constraint(dot(r(wheel / ground), r(left / ground)) = 0)]
    upright: Holonomic,
    #[constraint(norm(r(right / left)) = 1)]
    bar: Holonomic,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::precisely;
    use linkwork::prelude::*;

    /// At t = 3 s, recomputed at 160 and at 230 bits; the published digits are good to 2e-13 and 5e-12.
    #[test]
    fn car_axle_ends_where_published() -> Result<(), Error> {
        let start = ([0.0, 0.5, 1.0, 0.5], [-0.5, 0.0, -0.5, 0.0]);
        let end = simulate(&CarAxle {}).from(start.0, start.1).method(precisely()).duration(3.0).finish()?;
        let q = [
            0.049_345_578_427_524_09,
            0.496_989_460_230_008_1,
            1.041_742_524_885_426_1,
            0.373_911_027_265_365_8,
        ];
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
}
