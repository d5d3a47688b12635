use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = x + y + z)]
    arm: Body,
    #[joint(ground -> arm, about = 0 * z)]
    hinge: Pin,
}

fn main() {}
