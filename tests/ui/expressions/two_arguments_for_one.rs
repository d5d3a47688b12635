use linkwork::prelude::*;

#[mechanism]
struct Machine {
    l: f64,
    #[body(mass = 1, com = sin(l, l) * y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
