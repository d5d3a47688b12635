use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[particle(mass = 1, at = -y)]
    bob: Particle,
}

fn main() {}
