use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body(mass = 1)]
    a: Body,
    #[body(mass = 1)]
    b: Body,
    #[body(mass = 1)]
    c: Body,
    #[body(mass = 1)]
    d: Body,
    #[joint(a -> b, along = x)]
    ab: Sleeve,
    #[joint(b -> a, along = x)]
    ba: Sleeve,
    #[joint(c -> d, along = x)]
    cd: Sleeve,
    #[joint(d -> c, along = x)]
    dc: Sleeve,
}

fn main() {}
