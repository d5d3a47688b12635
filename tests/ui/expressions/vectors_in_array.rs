use linkwork::prelude::*;

#[mechanism]
struct Machine {
    l: f64,
    #[body(mass = 1, com = [l * x, l * y, l * z])]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
