use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    a: Body,
    #[body(mass = 1)]
    b: Body,
    #[joint(a -> b, along = x)]
    first: Sleeve,
    #[joint(b -> a, along = x)]
    second: Sleeve,
}

fn main() {}
