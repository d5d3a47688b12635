use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground.ad(x) -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
