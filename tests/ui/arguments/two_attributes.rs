use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    #[body(inertia = sphere(1, 1))]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
