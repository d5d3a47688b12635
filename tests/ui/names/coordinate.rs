use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1, inertia = sphere(1, 1))]
    block: Body,
    #[joint(ground -> block, along = x, about = z)]
    slot: Slot,
    #[acts(on = slot.slid, damping = 1)]
    friction: Dashpot,
}

fn main() {}
