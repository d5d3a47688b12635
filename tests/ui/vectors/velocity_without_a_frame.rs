use linkwork::prelude::*;

#[mechanism]
struct Machine {
    a: Coordinate,
    #[particle(mass = 1, at = a * x)]
    bead: Particle,
    #[output(v(bead / ground))]
    looked: Vector,
}

fn main() {}
