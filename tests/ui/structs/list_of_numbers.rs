use linkwork::prelude::*;

#[mechanism]
struct Machine {
    masses: Vec<f64>,
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
