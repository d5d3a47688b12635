//! A missing comma between fields is reported once, by rustc, and the functions exist.

use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * y)]
pub struct Pendulum {
    pub mass: f64
    pub length: f64,
    #[body(mass = mass, com = -length * y)]
    bob: Body
    #[joint(ground -> bob, about = z)]
    hinge: Pin;
    #[acts(on = hinge)]
    motor: Torque,
}

fn main() {
    let pendulum = Pendulum { mass: 1.0, length: 0.5 };
    let _ = pendulum.forward_dynamics(&[0.1].into(), &[0.0].into(), &[0.0].into());
}
