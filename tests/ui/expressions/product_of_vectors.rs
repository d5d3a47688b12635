use linkwork::prelude::*;

#[mechanism]
struct Machine {
    l: f64,
    #[body(mass = 1, com = l * x * y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
