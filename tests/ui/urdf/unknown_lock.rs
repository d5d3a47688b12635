use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf", lock = ["wrist", "elbwo"])]
struct Robot;

fn main() {}
