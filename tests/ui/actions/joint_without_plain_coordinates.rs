use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = sphere(1, 1))]
    ball: Body,
    #[joint(ground -> ball)]
    socket: Ball,
    #[acts(on = socket, damping = 1)]
    acting: Dashpot,
}

fn main() {}
