use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
