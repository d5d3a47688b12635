use linkwork::prelude::*;

#[mechanism]
struct Cart {
    m: f64,
    k: f64,
    c: f64,
    #[body(mass = m)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, value = -k * rail - c)]
    coil: Force,
    #[acts(on = rail, damping = c)]
    damper: Dashpot,
    #[acts(on = rail, damping = 2 * sqrt(k / m))]
    brake: Dashpot,
}

fn main() {}
