use linkwork::prelude::*;

#[mechanism]
struct Machine {
    m: f64,
    #[body(mass = self.m)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
