use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    post: Body,
    #[joint(ground -> post)]
    footing: Weld,
}

fn main() {}
