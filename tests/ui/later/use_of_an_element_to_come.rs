use linkwork::prelude::*;

#[mechanism]
struct Machine {
    theta: Coordinate,
    #[particle(mass = 1, at = ground.at(sin(theta) * x))]
    bead: Particle,
}

fn main() {}
