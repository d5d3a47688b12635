use linkwork::prelude::*;

#[mechanism]
struct Machine {
    m: f64,
    #[body(mass = m)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = m)]
    acting: Force,
}

fn main() {}
