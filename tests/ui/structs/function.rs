use linkwork::prelude::*;

#[mechanism]
fn machine() {}

fn main() {}
