use linkwork::prelude::*;

#[mechanism]
struct Machine {
    i: f64,
    #[body(mass = 1, inertia = i)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
