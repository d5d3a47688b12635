use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    ground: Body,
    #[joint(ground -> ground, along = x)]
    rail: Sleeve,
}

fn main() {}
