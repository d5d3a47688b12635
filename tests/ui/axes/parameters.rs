use linkwork::prelude::*;

#[mechanism]
struct Machine {
    a: f64,
    b: f64,
    #[body(mass = 1, com = x + y + z)]
    arm: Body,
    #[joint(ground -> arm, about = a * x + b * y)]
    hinge: Pin,
}

fn main() {}
