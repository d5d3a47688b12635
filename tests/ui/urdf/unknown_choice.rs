use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf", base = floating)]
struct Robot;

fn main() {}
