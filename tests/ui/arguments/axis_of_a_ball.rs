use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = sphere(1, 1))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Ball,
}

fn main() {}
