//! Test of a tower of boxes that must remain standing.

use linkwork::prelude::*;
use std::thread;

/// Tower of ten boxes, whose contacts are between the corners of each base and the top of the box below.
#[mechanism(gravity = -9.81 * z)]
struct Tower {
    #[body(mass = 1, inertia = cuboid(1, 0.2, 0.2, 0.1))]
    block: [Body; 10],
    #[joint(ground -> block[i])]
    pose: [Free; 10],
    #[contact(block[0].cuboid(0.2, 0.2, 0.1), ground.plane(z), friction = 0.6)]
    base: Contact,
    #[contact(block[i + 1].cuboid(0.2, 0.2, 0.1), block[i].at(0.05 * z).plane(z), friction = 0.6)]
    seat: [Contact; 9],
}

/// Checks that the tower stands: of eighty corners forty are in contact, with ten more normal forces than the
/// equilibrium of the bodies determines.
fn check_standing_tower() {
    let m = Tower {};
    let mut q = m.neutral();
    for k in 0..10 {
        q[7 * k] = 0.02 * ((k % 3) as f64 - 1.0);
        q[7 * k + 2] = 0.05 + 0.1 * k as f64;
    }
    let mut samples = 0;
    for sample in
        simulate(&m).from(q, [0.0; 60]).method(TimeStepping::step(1e-2)).sample_every(0.5).duration(2.0)
    {
        let sample = sample.unwrap();
        let moved = (sample.q - q).norm();
        assert!(moved < 1e-10, "{moved:e} m at {} s", sample.t);
        samples += 1;
    }
    assert_eq!(samples, 5);
}

/// The matrices of 240 contact velocities are on the stack: an unoptimised build needs more than the two
/// megabytes of a test's thread.
#[test]
fn tower_of_ten_boxes_remains_standing() {
    thread::Builder::new().stack_size(32 << 20).spawn(check_standing_tower).unwrap().join().unwrap();
}
