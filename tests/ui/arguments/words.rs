use linkwork::prelude::*;

#[mechanism(derivative)]
struct Near {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

#[mechanism(derivatives, jacobians, derivatives)]
struct Far {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

#[mechanism(gravity, 2 + 2)]
struct Valueless {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

#[mechanism(prepare)]
struct Numbers {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = x)]
    rail: Sleeve,
}

fn main() {}
