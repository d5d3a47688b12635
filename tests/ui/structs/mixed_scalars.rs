use linkwork::prelude::*;

#[mechanism]
struct Machine {
    mass: f64,
    load: f32,
    #[body(mass = mass + load)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
