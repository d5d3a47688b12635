//! The prelude is sufficient for wrapped mechanisms: with enforced contacts, stabilised constraints,
//! first-order states, and without contacts.

use linkwork::constraint::stabilized;
use linkwork::contact::{Touch, apart, hold};
use linkwork::prelude::*;

#[mechanism]
struct Bead {
    #[particle(mass = 2)]
    bead: Particle,
    #[joint(ground -> bead, along = (x, z))]
    plane: Stage,
    #[contact(bead, ground.plane(z), friction = 0)]
    floor: Contact,
}

#[mechanism]
struct BeadOnRing {
    #[particle(mass = 1)]
    bead: Particle,
    #[joint(ground -> bead, along = (x, y))]
    plane: Stage,
    #[constraint(plane.x * plane.x + plane.y * plane.y = 1)]
    ring: Holonomic,
}

#[mechanism]
struct CartWithThrustLag {
    lag: f64,
    command: Input,
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[state(rate = (command - thrust) / lag)]
    thrust: State,
    #[acts(on = rail, value = thrust)]
    push: Force,
}

#[test]
fn wrapped_driven_mechanisms_need_no_other_trait() {
    let bead = Bead {};
    let (q, v, tau) = ([0.0, 0.0].into(), [1.0, 0.0].into(), SVector::from([4.0, 6.0]));
    let held = hold(&bead, [Touch::Sticks]);
    let a = held.forward_dynamics(0.0, &q, &v, &tau);
    assert!((a - SVector::from([2.0, 0.0])).norm() < 1e-12);
    assert_eq!(held.try_forward_dynamics(0.0, &q, &v, &tau), Ok(a));
    assert_eq!(held.kinetic_energy(0.0, &q, &v), 1.0);
    assert_eq!(apart(&bead).forward_dynamics(0.0, &q, &v, &tau), SVector::from([2.0, 3.0]));
    assert_eq!(apart(&bead).mass_matrix(0.0, &q)[(1, 1)], 2.0);

    let ring = BeadOnRing {};
    let steady = stabilized(&ring, 3.0);
    let a = steady.forward_dynamics(0.0, &[1.1, 0.0].into(), &[0.0, 0.0].into(), &SVector::zeros());
    // 2.2 a = −9 (1.21 − 1).
    assert!((a[0] + 9.0 * 0.21 / 2.2).abs() < 1e-12);

    let cart = CartWithThrustLag { lag: 1.0, thrust: 5.0 };
    let whole = cart.extended();
    let tau = whole.generalized_forces(0.0, &[0.0].into(), &[0.0, 5.0].into(), &[7.0].into());
    let a = whole.forward_dynamics(0.0, &[0.0].into(), &[0.0, 5.0].into(), &tau);
    assert!((a - SVector::from([5.0, 2.0])).norm() < 1e-12);
}
