use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[bdy(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
