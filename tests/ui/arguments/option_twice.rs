use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * y, gravity = -1.62 * y)]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
