use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = acting)]
    acting: Force,
}

fn main() {}
