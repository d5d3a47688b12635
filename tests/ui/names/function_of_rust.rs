use linkwork::prelude::*;

#[mechanism]
struct Machine {
    length: f64,
    #[body(mass = 1, com = -length.sqrt() * y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
