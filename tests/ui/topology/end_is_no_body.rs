use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(0 -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
