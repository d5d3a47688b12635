use linkwork::prelude::*;

#[mechanism(urdf = "urdf/other_format.urdf")]
struct Robot;

fn main() {}
