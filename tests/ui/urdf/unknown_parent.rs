use linkwork::prelude::*;

#[mechanism(urdf = "urdf/unknown_parent.urdf")]
struct Robot;

fn main() {}
