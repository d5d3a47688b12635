use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = "1 kg")]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
