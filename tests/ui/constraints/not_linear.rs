use linkwork::prelude::*;

#[mechanism]
struct Magnitude {
    #[body(mass = 1)]
    bead: Body,
    #[joint(ground -> bead, along = (x, y))]
    table: Stage,
    #[constraint(abs(rate(table.x)) = 0)]
    skate: Nonholonomic,
}

#[mechanism]
struct Larger {
    #[body(mass = 1)]
    bead: Body,
    #[joint(ground -> bead, along = (x, y))]
    table: Stage,
    #[constraint(max(rate(table.x), rate(table.y)) = 0)]
    skate: Nonholonomic,
}

#[mechanism]
struct Speed {
    #[body(mass = 1)]
    bead: Body,
    #[joint(ground -> bead, along = (x, y))]
    table: Stage,
    #[constraint(norm(v(bead / ground / ground)) = 1)]
    skate: Nonholonomic,
}

fn main() {}
