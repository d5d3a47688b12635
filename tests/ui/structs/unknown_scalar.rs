use linkwork::prelude::*;

#[mechanism(scalar = f16)]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
