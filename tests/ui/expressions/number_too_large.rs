use linkwork::prelude::*;

#[mechanism]
struct Machine {
    m: f64,
    #[body(mass = 1e999)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
