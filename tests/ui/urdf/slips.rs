use linkwork::prelude::*;

#[mechanism(urdf = "urdf/slips.urdf")]
struct Robot;

fn main() {}
