use linkwork::prelude::*;

#[mechanism]
struct Machine;

fn main() {}
