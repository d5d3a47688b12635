use linkwork::prelude::*;

#[mechanism]
struct Machine {
    m: f64,
    #[body(mass = std::f64::consts::PI * m)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
