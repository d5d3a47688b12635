use linkwork::prelude::*;

#[mechanism]
struct Machine {
    m: f64,
    #[body(mass = if m { 1 } else { 2 })]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
