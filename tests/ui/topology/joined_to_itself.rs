use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(cart -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
