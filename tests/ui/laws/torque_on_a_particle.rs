use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * y)]
struct Machine {
    a: Coordinate,
    #[body(mass = 1, inertia = diagonal(1, 1, 1))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    pin: Pin,
    #[particle(mass = 1, at = arm.at(a * x))]
    bead: Particle,
    #[frame(arm, x(a))]
    tilted: Frame,
    #[acts(on = bead, value = a * z)]
    twist: Torque,
}

fn main() {}
