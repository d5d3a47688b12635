use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = x + y + z)]
    arm: Body,
    #[joint(ground -> arm, about = unit(x - x))]
    hinge: Pin,
}

fn main() {}
