use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = sphere(1, 1))]
    block: Body,
    #[joint(ground -> block, about = (x, -x))]
    cross: Universal,
}

fn main() {}
