//! Results are the same on every machine only if the arithmetic of the whole program is.

use linkwork::prelude::*;

#[mechanism(arithmetic = reproducible)]
struct Pendulum {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {
    let _ = Pendulum {}.mass_matrix(&[0.0].into());
}
