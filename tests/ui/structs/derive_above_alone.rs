//! Derives above the attribute: each struct gives exactly one error, and uses of the struct give none.

use linkwork::prelude::*;

#[derive(Clone)]
#[mechanism(gravity = -9.81 * y)]
pub struct CartPole {
    pub cart_mass: f64,
    #[body(mass = cart_mass)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = cart, along = x)]
    push: Force,
}

impl CartPole {
    fn heavy() -> CartPole {
        CartPole { cart_mass: 10.0 }
    }
}

#[derive(Debug, Default)]
#[mechanism]
struct Scaled<T> {
    mass: T,
    #[body(mass = mass)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

#[derive(Clone, Copy)]
#[mechanism]
#[derive(Debug)]
struct Bare {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn main() -> Result<(), Error> {
    let cart = CartPole { cart_mass: 1.0 };
    let other = cart.clone();
    println!("{} {}", other.mass_matrix(&[0.0].into()), CartPole::heavy().cart_mass);
    let end = simulate(&cart).from(cart.neutral(), [0.0].into()).duration(1.0).finish()?;
    println!("{} {:?}", end.q, CartPole::VELOCITIES);
    let scaled = Scaled { mass: 1.0_f32 };
    println!("{scaled:?} {}", scaled.kinetic_energy(&[0.0].into(), &[1.0].into()));
    let (bare, again) = (Bare, Bare {});
    println!("{bare:?} {}", again.frame_placement(frame!(Bare, "cart"), &[0.0].into()));
    Ok(())
}
