use linkwork::prelude::*;

#[mechanism(skip_passes = [frames, limb])]
struct Unknown {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

#[mechanism(skip_passes = frames)]
struct NoList {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

fn main() {}
