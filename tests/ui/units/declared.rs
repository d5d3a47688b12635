use linkwork::prelude::*;

#[mechanism]
struct Cart {
    #[unit(kg)]
    m: f64,
    #[unit(N * m / rad)]
    k: f64,
    #[body(mass = m)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = k)]
    coil: Spring,
}

fn main() {}
