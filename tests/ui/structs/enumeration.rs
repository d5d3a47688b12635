use linkwork::prelude::*;

#[mechanism]
enum Machine {
    Cart,
    Pole,
}

fn main() {}
