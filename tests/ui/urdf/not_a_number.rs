use linkwork::prelude::*;

#[mechanism(urdf = "urdf/not_a_number.urdf")]
struct Robot;

fn main() {}
