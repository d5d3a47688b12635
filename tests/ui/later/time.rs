use linkwork::prelude::*;

#[mechanism]
struct Machine {
    spin: f64,
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge, stiffness = sin(spin * t))]
    coil: Spring,
}

fn main() {}
