//! A name that is defined twice is reported once, not with every function of the struct.

use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * y, derivatives, batch)]
#[derive(Clone, Copy, Debug)]
struct Pendulum {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

#[mechanism(gravity = -9.81 * y)]
#[derive(Clone, Copy, Debug)]
struct Pendulum {
    #[body(mass = 2, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {
    let _ = Pendulum.mass_matrix(&Pendulum.neutral());
}
