use linkwork::prelude::*;

#[mechanism(urdf = "urdf/impossible_inertia.urdf")]
struct Robot;

fn main() {}
