use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = sphere(1, 1))]
    nut: Body,
    #[joint(ground -> nut, about = z)]
    thread: Screw,
}

fn main() {}
