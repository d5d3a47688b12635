use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = )]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
