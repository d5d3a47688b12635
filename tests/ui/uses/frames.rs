//! A misspelt name of a frame, and an unrelated name.

use linkwork::prelude::*;

#[mechanism]
struct Arm {
    #[body(mass = 1, com = -y)]
    upper_arm: Body,
    #[body(mass = 1, com = -y)]
    hand: Body,
    #[joint(ground -> upper_arm, about = z)]
    shoulder: Pin,
    #[joint(upper_arm.at(-y) -> hand, about = z)]
    wrist: Pin,
}

fn main() {
    let _ = frame!(Arm, "Hand");
    let _ = frame!(Arm, "upper");
    let _ = frame!(Arm, "gripper");
}
