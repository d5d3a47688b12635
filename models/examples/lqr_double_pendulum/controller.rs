//! Cart with two poles in series, and its stabilising controller. This file does not use the standard
//! library, since the static library in `../controller_for_c` includes it, too.

use linkwork::optimal::{Policy, Quadratic};
use linkwork::prelude::*;

/// Cart on a rail with a pole pinned to it, and a second pole pinned to the end of the first. Both are
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

/// Position of the cart, m, angle of the lower pole and angle between both poles, rad; or the rates of these
/// three.
pub type State = SVector<f64, { Cart::NV }>;
/// Feedback policy from the state to the force on the cart.
pub type Regulator = Policy<f64, { Cart::NV }, { Cart::NU }>;

/// Returns the costs of one control period, with weights of displacement, angles, rates and force.
pub fn quadratic_costs() -> Quadratic<f64, { Cart::NV }, { Cart::NU }> {
    Quadratic {
        qq: SMatrix::from_diagonal(&[10.0, 100.0, 100.0].into()),
        vv: SMatrix::from_diagonal(&[1.0, 1.0, 1.0].into()),
        uu: [0.1].into(),
        ..Quadratic::zeros()
    }
}

/// Returns the force on the cart for a state, N, limited to the motor's strength.
pub fn force_on_cart(regulator: &Regulator, q: &State, v: &State) -> f64 {
    let strength = Cart {}.effort_limits()[index!(Cart::VELOCITIES, "rail")];
    regulator.inputs(1.0, q, v)[0].clamp(-strength, strength)
}
