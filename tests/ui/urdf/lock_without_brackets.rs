use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf", lock = "elbow")]
struct Robot;

fn main() {}
