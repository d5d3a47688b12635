use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = arm * y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
