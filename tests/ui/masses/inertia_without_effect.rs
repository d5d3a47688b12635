use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = rod(1, 1, z))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
