use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf", fix = ["elbow"])]
struct Robot;

fn main() {}
