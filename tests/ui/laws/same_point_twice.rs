use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[particle(mass = 1)]
    bead: Particle,
    #[joint(ground -> bead, along = x)]
    rail: Sleeve,
    #[acts(between = (bead, bead), stiffness = 1)]
    spring: Spring,
}

fn main() {}
