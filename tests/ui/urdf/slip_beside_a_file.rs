use linkwork::prelude::*;

#[mechanism(urdf = "urdf/arm.urdf")]
struct Robot {
    #[acts(on = elbo, damping = 1)]
    friction: Dashpot,
}

fn main() {}
