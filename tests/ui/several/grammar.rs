use linkwork::prelude::*;

#[mechanism(gravty = -9.81 * y)]
struct CartPole {
    masses: Vec<f64>,
    #[body(mas = 1)]
    cart: Body,
    #[body(mass = 1 +, com = y)]
    pole: Body,
    #[joint(along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, along = z)]
    hinge: Pin,
    #[acts(on = rail)]
    friction: Dashpot,
    #[acts(on = rail, damping = 1)]
    brake: Dashpott,
}

fn main() {}
