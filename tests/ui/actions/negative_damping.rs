use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, damping = -1)]
    acting: Dashpot,
}

fn main() {}
