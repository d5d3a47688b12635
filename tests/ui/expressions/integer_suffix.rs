use linkwork::prelude::*;

#[mechanism]
struct Machine {
    m: f64,
    #[body(mass = m * 1u32)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
