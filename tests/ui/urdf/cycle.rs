use linkwork::prelude::*;

#[mechanism(urdf = "urdf/cycle.urdf")]
struct Robot;

fn main() {}
