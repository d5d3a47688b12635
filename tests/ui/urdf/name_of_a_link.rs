use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf")]
struct Robot {
    #[body(mass = 1)]
    upper: Body,
    #[joint(lower -> upper)]
    flange: Weld,
}

fn main() {}
