use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = y)]
    arm: Body,
    #[joint(ground -> arm, about = (y, z))]
    hinge: Pin,
}

fn main() {}
