use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(between = (ground, cart), stiffness = 1)]
    thing: Spring,
}

fn main() {}
