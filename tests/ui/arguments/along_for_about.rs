use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = y)]
    arm: Body,
    #[joint(ground -> arm, along = z)]
    hinge: Pin,
}

fn main() {}
