use linkwork::prelude::*;

struct Machine;

#[mechanism]
impl Machine {}

fn main() {}
