use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge, stifness = 1)]
    coil: Spring,
}

fn main() {}
