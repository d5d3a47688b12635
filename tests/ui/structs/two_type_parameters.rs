use linkwork::prelude::*;

#[mechanism]
struct Machine<T, U> {
    mass: T,
    other: U,
    #[body(mass = mass + other)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
