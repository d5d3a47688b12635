use linkwork::prelude::*;

#[mechanism]
struct Machine {
    x: f64,
    #[body(mass = x)]
    cart: Body,
    #[joint(ground -> cart, along = y)]
    rail: Sleeve,
}

fn main() {}
