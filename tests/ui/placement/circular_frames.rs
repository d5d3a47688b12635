use linkwork::prelude::*;

#[mechanism]
struct Machine {
    a: Coordinate,
    #[particle(mass = 1, at = a * x)]
    bead: Particle,
    #[frame(second, x(a))]
    first: Frame,
    #[frame(first, x(a))]
    second: Frame,
}

fn main() {}
