use linkwork::prelude::*;

#[mechanism]
struct Machine {
    t: f64,
    #[body(mass = t)]
    cart: Body,
    #[joint(ground -> cart, along = y)]
    rail: Sleeve,
}

fn main() {}
