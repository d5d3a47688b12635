use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = [1, 1, 1])]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
