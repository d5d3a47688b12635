use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = rod(z, 1, 2))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
