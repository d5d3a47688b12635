//! A can that rolls or slides on a fixed can until it leaves it.

use linkwork::nalgebra::{Quaternion, UnitQuaternion};
use linkwork::prelude::*;

const G: f64 = 9.81;

#[mechanism(gravity = -9.81 * z)]
struct CanOnCan {
    friction: f64,
    #[body(mass = 1, inertia = cylinder(1, 0.1, 0.3, y))]
    can: Body,
    #[joint(ground -> can)]
    pose: Free,
    #[contact(can.cylinder(0.1, 0.3, y), ground.cylinder(0.2, 0.4, y), friction = friction)]
    drum: Contact,
}

/// A can starts at rest near the top of a fixed one. It rolls or slides until the normal force is zero, at an
/// angle whose cosine is 4/7 or 2/3 of that at the start; then it falls with constant horizontal velocity.
/// The radial balance at this angle is `v² = g L cos θ`, where `L` is the sum of the radii.
#[test]
fn can_leaves_a_can_at_the_angle_of_the_closed_form() {
    for (friction, share) in [(100.0, 4.0 / 7.0), (0.0, 2.0 / 3.0)] {
        let (m, start, length) = (CanOnCan { friction }, 0.3_f64, 0.3_f64);
        let q = [length * start.sin(), 0.02, length * start.cos(), 0.0, 0.0, 0.0, 1.0].into();
        let cosine = share * start.cos();
        let speed = (G * length * cosine).sqrt() * cosine;
        let energy_of = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
        let energy = energy_of(&q, &SVector::zeros());
        let mut horizontal = None;
        for sample in simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(5e-4)).duration(0.6) {
            let sample = sample.unwrap();
            let lost = energy - energy_of(&sample.q, &sample.v);
            assert!(lost.abs() < 2e-4, "{friction} {}: {lost}", sample.t);
            assert!((sample.q[1] - 0.02).abs() < 1e-4, "{}", sample.q);
            if m.contact_gaps(&sample.q).min() > 0.01 {
                // The velocity is in the axes of the can.
                let rotation = Quaternion::from(sample.q.fixed_rows::<4>(3).into_owned());
                let velocity = sample.v.fixed_rows::<3>(0).into_owned();
                horizontal = Some((UnitQuaternion::from_quaternion(rotation) * velocity)[0]);
                break;
            }
        }
        let horizontal = horizontal.expect("the can leaves");
        assert!((horizontal / speed - 1.0).abs() < 3e-3, "{friction}: {horizontal} {speed}");
    }
}
