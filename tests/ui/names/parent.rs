use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[body(mass = 1, com = y)]
    pole: Body,
    #[joint(chart -> pole, about = z)]
    hinge: Pin,
}

fn main() {}
