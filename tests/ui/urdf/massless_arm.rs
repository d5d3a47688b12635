use linkwork::prelude::*;

#[mechanism(urdf = "urdf/massless_arm.urdf")]
struct Robot;

fn main() {}
