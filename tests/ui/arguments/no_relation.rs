use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(along = x)]
    rail: Sleeve,
}

fn main() {}
