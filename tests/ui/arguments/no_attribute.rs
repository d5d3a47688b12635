use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    friction: Dashpot,
}

fn main() {}
