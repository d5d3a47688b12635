//! Frames are identified by checked names, not by strings.

use linkwork::prelude::*;

#[mechanism]
struct Arm {
    #[body(mass = 1, com = -y)]
    tool: Body,
    #[joint(ground -> tool, about = z)]
    hinge: Pin,
}

fn main() {
    let q = [0.0].into();
    let _ = Arm.frame_placement("tool", &q);
    let _ = Arm.frame_jacobian("tool", &q);
}
