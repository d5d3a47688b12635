use linkwork::prelude::*;

#[mechanism(gravity = -g * yy)]
struct CartPole {
    g: f64,
    cart_mass: f64,
    pole_mass: f64,

    #[body(mass = cart_mas)]
    cart: Body,
    #[body(mass = pole_mass, com = y, inertia = rood(pole_mass, 1, y))]
    pole: Body,
    #[joint(ground -> crt, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = zz)]
    hinge: Pin,
    #[acts(on = rial, damping = 1)]
    friction: Dashpot,
}

fn main() {}
