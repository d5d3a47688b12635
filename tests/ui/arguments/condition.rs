use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[cfg(test)]
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
