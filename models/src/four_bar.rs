use linkwork::mechanism;

/// The planar four-bar linkage: a crank, a coupler and a rocker, between two pivots on the ground.
///
/// Source: Freudenstein, *Approximate synthesis of four-bar linkages*, Trans. ASME 77 (1955); Norton, *Design
/// of Machinery* (2004), ch. 4 and 6.
///
/// - Coordinates: `input` `θ₂`, the crank's angle from x; `joint`, the coupler's angle from the crank, so
///   that its own is `θ₃ = input + joint`; `output` `θ₄`, the rocker's angle from x; rad. y points up. The
///   pin `loop_` closes the loop. Input: `motor`, a torque on the crank, N·m.
/// - Freudenstein's equation: `d/a cos θ₄ − d/c cos θ₂ + (a² − b² + c² + d²) / (2 a c) = cos(θ₂ − θ₄)`, with
///   the lengths `a`, `b`, `c` of crank, coupler and rocker, and `d` of the base.
/// - Rates: `θ̇₄ / θ̇₂ = a sin(θ₃ − θ₂) / (c sin(θ₃ − θ₄))`, `θ̇₃ / θ̇₂ = a sin(θ₄ − θ₂) / (b sin(θ₃ − θ₄))`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the links per length, kg/m.
    pub density: f64,
    /// Length of the crank, m.
    pub a: f64,
    /// Length of the coupler, m.
    pub b: f64,
    /// Length of the rocker, m.
    pub c: f64,
    /// Distance of the fixed pivots, m.
    pub d: f64,

    #[body(mass = density * a, com = a / 2 * x, inertia = rod(density * a, a, x))]
    crank: Body,
    #[body(mass = density * b, com = b / 2 * x, inertia = rod(density * b, b, x))]
    coupler: Body,
    #[body(mass = density * c, com = c / 2 * x, inertia = rod(density * c, c, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    input: Pin,
    #[joint(crank.at(a * x) -> coupler, about = z)]
    joint: Pin,
    #[joint(ground.at(d * x) -> rocker, about = z)]
    output: Pin,
    #[joint(coupler.at(b * x) -> rocker.at(c * x), about = z)]
    loop_: Pin,
    #[acts(on = input)]
    motor: Torque,
}
