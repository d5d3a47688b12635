use linkwork::prelude::*;

#[mechanism(gravity = -9.81)]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
