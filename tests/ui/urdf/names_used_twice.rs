use linkwork::prelude::*;

#[mechanism(urdf = "urdf/names_used_twice.urdf")]
struct Robot;

fn main() {}
