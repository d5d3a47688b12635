use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(ground -> cart, mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
