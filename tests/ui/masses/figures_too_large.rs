use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1e200, com = 1e200 * x)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
