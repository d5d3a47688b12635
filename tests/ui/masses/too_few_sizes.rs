use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = cylinder(1, 2, z))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {}
