use linkwork::prelude::*;

#[mechanism]
struct Machine<const N: usize> {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
