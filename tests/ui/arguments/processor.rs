use linkwork::prelude::*;

#[mechanism(processor = fast)]
struct Unknown {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

#[mechanism(processor)]
struct Valueless {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

fn main() {}
