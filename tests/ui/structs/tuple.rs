use linkwork::prelude::*;

#[mechanism]
struct Machine(f64, f64);

fn main() {}
