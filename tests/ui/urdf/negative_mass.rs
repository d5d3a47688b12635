use linkwork::prelude::*;

#[mechanism(urdf = "urdf/negative_mass.urdf")]
struct Robot;

fn main() {}
