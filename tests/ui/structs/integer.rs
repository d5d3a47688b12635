use linkwork::prelude::*;

#[mechanism]
struct Machine {
    mass: i32,
    #[body(mass = mass)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
