//! A cart with two poles, one on the other, and what keeps them upright. Nothing here needs the standard
//! library: the static library in `../controller_for_c` is made of this file, too.

use linkwork::optimal::{Policy, Quadratic};
use linkwork::prelude::*;

/// A cart on a rail with a pole pinned to it, and another pole pinned to the end of the first; both are
/// upright at zero.
#[mechanism(gravity = -9.81 * y, derivatives)]
#[derive(Clone, Copy, Debug)]
pub struct Cart {
    #[body(mass = 1)]
    cart: Body,
    #[body(mass = 0.2, com = 0.25 * y, inertia = rod(0.2, 0.5, y))]
    lower: Body,
    #[body(mass = 0.2, com = 0.25 * y, inertia = rod(0.2, 0.5, y))]
    upper: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> lower, about = z)]
    ankle: Pin,
    #[joint(lower.at(0.5 * y) -> upper, about = z)]
    hip: Pin,
    #[limit(on = rail, max_effort = 30)]
    strength: Limit,
    #[acts(on = rail)]
    push: Force,
}

/// Place of the cart, lean of the lower pole, angle between both: m and rad; or their rates.
pub type State = SVector<f64, { Cart::NV }>;
/// How the push follows from the state.
pub type Regulator = Policy<f64, { Cart::NV }, { Cart::NU }>;

/// What a period costs: displacements, angles, rates and pushes.
pub fn costs() -> Quadratic<f64, { Cart::NV }, { Cart::NU }> {
    Quadratic {
        qq: SMatrix::from_diagonal(&[10.0, 100.0, 100.0].into()),
        vv: SMatrix::from_diagonal(&[1.0, 1.0, 1.0].into()),
        uu: [0.1].into(),
        ..Quadratic::zeros()
    }
}

/// The push, N, for the state of an instant, no stronger than the motor.
pub fn control(regulator: &Regulator, q: &State, v: &State) -> f64 {
    let strength = Cart {}.effort_limits()[index!(Cart::VELOCITIES, "rail")];
    regulator.inputs(1.0, q, v)[0].clamp(-strength, strength)
}
