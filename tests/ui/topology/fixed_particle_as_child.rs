use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[particle(mass = 1, at = arm.at(x))]
    bob: Particle,
    #[joint(arm -> bob, along = x)]
    rail: Sleeve,
}

fn main() {}
