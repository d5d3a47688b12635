use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = x, inertia = sphere(1, 1))]
    block: Body,
    #[joint(ground -> block, along = (x, unit(x + y)))]
    table: Planar,
}

fn main() {}
