use linkwork::prelude::*;

#[mechanism(scalar = f32)]
struct Machine {
    mass: f64,
    #[body(mass = mass)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
