use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = 0.5)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
