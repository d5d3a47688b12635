use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = cilinder(1, 0.1, 0.2, z))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
