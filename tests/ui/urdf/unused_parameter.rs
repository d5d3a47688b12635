use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf")]
struct Robot {
    mass: f64,
}

fn main() {}
