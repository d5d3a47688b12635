use linkwork::prelude::*;

#[mechanism]
struct Machine {
    l: f64,
    #[body(mass = 1, com = (l * y).y * y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
