use linkwork::prelude::*;

#[mechanism]
struct Cart {
    #[unit]
    a: f64,
    #[unit(kg, m)]
    b: f64,
    #[unit(kg)]
    #[unit(kg)]
    c: f64,
    #[unit(kg)]
    #[body(mass = a + b + c)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() {}
