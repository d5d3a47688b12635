use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x, rotation = z(pi / 2))]
    rail: Sleeve,
}

fn main() {}
