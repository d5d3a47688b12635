use linkwork::prelude::*;

#[mechanism(gravty = -9.81 * y)]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
