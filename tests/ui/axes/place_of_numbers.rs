use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = y)]
    arm: Body,
    #[joint(ground.at(0, 1, 0) -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
