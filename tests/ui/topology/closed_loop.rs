use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[body(mass = 1, com = x)]
    rod: Body,
    #[joint(arm -> rod, about = z)]
    elbow: Pin,
    #[joint(ground -> rod, about = z)]
    end: Pin,
}

fn main() {}
