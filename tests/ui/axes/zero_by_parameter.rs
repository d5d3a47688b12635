use linkwork::prelude::*;

#[mechanism]
struct Machine {
    n: f64,
    #[body(mass = 1, com = x + y + z)]
    arm: Body,
    #[joint(ground -> arm, about = n * z - n * z)]
    hinge: Pin,
}

fn main() {}
