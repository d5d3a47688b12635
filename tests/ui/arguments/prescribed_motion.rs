use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(massive)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
