//! A derive above the attribute processes elements that the attribute removes.

use linkwork::prelude::*;

#[derive(Clone, Copy, Debug, PartialEq)]
#[mechanism(gravity = -9.81 * y)]
pub struct CartPole {
    pub cart_mass: f64,
    #[body(mass = cart_mass)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {
    let cart = CartPole { cart_mass: 1.0 };
    println!("{cart:?} {}", cart.mass_matrix(&cart.neutral()));
}
