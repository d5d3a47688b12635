use linkwork::prelude::*;

#[mechanism]
struct Machine {
    m: f64,
    #[body(mass = m as f64)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
