use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = y, inertia = sphere(1, 1))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    cross: Universal,
}

fn main() {}
