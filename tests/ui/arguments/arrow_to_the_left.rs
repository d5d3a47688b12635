use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(cart <- ground, along = x)]
    rail: Sleeve,
}

fn main() {}
