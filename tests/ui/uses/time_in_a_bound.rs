//! A time-dependent mechanism does not satisfy bounds without time: the message suggests to fix the instant.

use linkwork::prelude::*;

#[mechanism]
struct Driven {
    theta: Coordinate,
    #[particle(mass = 1, at = cos(3 * t) * x + sin(3 * t) * y + cos(theta) * z)]
    bead: Particle,
}

fn any<M, const NQ: usize, const NV: usize, const NU: usize>(_: &M)
where
    M: Mechanism<NQ, NV, NU> + linkwork::Scleronomic,
{
}

fn main() {
    any(&Driven);
    any(&at(&Driven, 0.5));
}
