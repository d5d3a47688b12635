use linkwork::prelude::*;

#[mechanism(urdf = "urdf/two_roots.urdf")]
struct Robot;

fn main() {}
