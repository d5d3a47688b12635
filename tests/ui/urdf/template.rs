use linkwork::prelude::*;

#[mechanism(urdf = "urdf/template.urdf")]
struct Robot;

fn main() {}
