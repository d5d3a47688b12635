use linkwork::mechanism;

/// Car's axle on a road that is bumpy on one side: each wheel carries a mass on a spring, a massless bar
/// joins the masses, and the left spring is always perpendicular to the line from wheel to wheel.
///
/// Source: Test Set for IVP Solvers (Mazzia and Magherini), problem `caraxis`; Hairer and Wanner, *Solving
/// Ordinary Differential Equations II* (1996), ch. VII.
///
/// - Coordinates: `xl`, `yl` and `xr`, `yr`, the positions of the left and the right mass, m; y points up.
///   The left wheel is the origin, the right one is at `(√(1 − b²), b)` with the bump `b = 0.1 sin 10 t`: the
///   functions have the time as their first argument.
/// - All numbers are those of the test set: masses of 0.5 g, springs of 1 N/m and 0.5 m, a bar of 1 m, and
///   gravity of 1 m/s².
#[mechanism(gravity = -1 * y, derivatives)]
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
