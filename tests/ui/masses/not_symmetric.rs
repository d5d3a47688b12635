use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]])]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
