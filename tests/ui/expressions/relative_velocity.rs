use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = v(arm / ground))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
