use linkwork::prelude::*;

#[mechanism]
struct Cart {
    #[unit(mm)]
    a: f64,
    #[unit(Kg)]
    b: f64,
    #[unit(N + m)]
    c: f64,
    #[unit(furlong)]
    d: f64,
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, value = a + b + c + d)]
    push: Force,
}

fn main() {}
