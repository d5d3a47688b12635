use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[particle(mass = 1)]
    bob: Particle,
    #[joint(ground -> bob)]
    pose: Free,
}

fn main() {}
