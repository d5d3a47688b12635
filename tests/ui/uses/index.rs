//! Names in `index!` are checked in constants and in functions.

use linkwork::index;
use linkwork::prelude::*;

#[mechanism]
struct Pendulum {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

const HINGE: usize = index!(Pendulum::CONFIGURATION, "hinges");

fn hinge() -> usize {
    index!(Pendulum::VELOCITIES, "hing")
}

fn main() {
    let _ = (Pendulum.neutral()[HINGE], hinge());
}
