use linkwork::prelude::*;

#[mechanism(urdf = "urdf/entity_bomb.urdf")]
struct Robot;

fn main() {}
