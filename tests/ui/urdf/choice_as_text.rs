use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf", mimic = "follow")]
struct Robot;

fn main() {}
