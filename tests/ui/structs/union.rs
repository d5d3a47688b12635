use linkwork::prelude::*;

#[mechanism]
union Machine {
    a: f64,
    b: f64,
}

fn main() {}
