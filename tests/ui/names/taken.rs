use linkwork::prelude::*;

#[mechanism]
struct Machine {
    pi: Input,
    x: Coordinate,
    #[body(mass = 1, inertia = sphere(1, 1))]
    disk: Body,
    #[joint(ground -> disk, about = z)]
    t: Pin,
    #[particle(mass = 1, at = x * ground.x)]
    bead: Particle,
    #[define(2 * t)]
    z: Scalar,
    #[acts(on = t, value = pi)]
    push: Torque,
}

fn main() {}
