use linkwork::prelude::*;

#[mechanism]
struct Machine {
    mass: f64,
    load: f64,
    #[body(mass = mass)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
