use linkwork::prelude::*;

#[mechanism(urdf = "urdf/infinite.urdf")]
struct Robot;

fn main() {}
