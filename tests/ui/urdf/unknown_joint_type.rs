use linkwork::prelude::*;

#[mechanism(urdf = "urdf/unknown_joint_type.urdf")]
struct Robot;

fn main() {}
