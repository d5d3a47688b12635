use linkwork::prelude::*;

#[mechanism(urdf = arm.urdf)]
struct Robot;

fn main() {}
