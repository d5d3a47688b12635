use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge, stiffness = 1, free_length = 1)]
    acting: Spring,
}

fn main() {}
