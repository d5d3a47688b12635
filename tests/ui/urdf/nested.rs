use linkwork::prelude::*;

#[mechanism(urdf = "urdf/nested.urdf")]
struct Robot;

fn main() {}
