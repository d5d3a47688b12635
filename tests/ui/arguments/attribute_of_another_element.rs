use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[joint(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
