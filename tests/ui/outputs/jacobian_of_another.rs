use linkwork::prelude::*;

#[mechanism]
struct Machine {
    a: Coordinate,
    #[particle(mass = 1, at = a * x)]
    bead: Particle,
    #[output(a)]
    reach: Scalar,
    #[output(rate(a))]
    reach_jacobian: Scalar,
}

fn main() {}
