use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = y)]
    arm: Body,
    #[joint(ground.rotated([[1, 0, 0], [0, 1, 0], [0, 0, -1]]) -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
