use linkwork::prelude::*;

#[mechanism]
struct CartPole {
    #[body(mass = -1)]
    cart: Body,
    #[body(mass = 1, com = y, inertia = diagonal(1, 1, 5))]
    pole: Body,
    #[joint(ground -> cart, along = 2 * x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = 0 * z)]
    hinge: Pin,
    #[acts(on = rail)]
    push: Torque,
    #[acts(on = hinge, damping = -1)]
    friction: Dashpot,
}

fn main() {}
