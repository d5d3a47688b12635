//! A mechanism whose equations contain time is none without time: the message says how it becomes one at an instant.

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
