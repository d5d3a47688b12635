use linkwork::prelude::*;

#[mechanism(urdf = "urdf/amr.urdf")]
struct Robot;

fn main() {}
