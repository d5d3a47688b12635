use linkwork::prelude::*;

#[mechanism]
struct Pendulum {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {
    let pendulum = Pendulum;
    let _ = pendulum.frame_placement(frame!(Pendulum, "hand"), &pendulum.neutral());
}
