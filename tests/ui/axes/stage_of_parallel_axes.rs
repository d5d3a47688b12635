use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    block: Body,
    #[joint(ground -> block, along = (x, x))]
    table: Stage,
}

fn main() {}
