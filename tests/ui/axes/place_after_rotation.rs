use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = y)]
    arm: Body,
    #[joint(ground.rotated(z(1)).at(x) -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
