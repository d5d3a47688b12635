use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    post: Body,
    #[joint(ground -> post)]
    footing: Weld,
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = footing, damping = 1)]
    acting: Dashpot,
}

fn main() {}
