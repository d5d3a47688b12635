use linkwork::prelude::*;

#[mechanism]
struct Machine {
    cart_mass: f64,
    #[body(mass = cart_mas)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
