//! A robot on its feet.

use linkwork::contact;
use linkwork::prelude::*;

#[mechanism(
    urdf = "../../models/urdf/solo12.urdf",
    base = free,
    gravity = -9.81 * cos(slope) * z - 9.81 * sin(slope) * x
)]
struct Solo {
    slope: f64,
    #[contact(FL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_left: Contact,
    #[contact(FR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_right: Contact,
    #[contact(HL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_left: Contact,
    #[contact(HR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_right: Contact,
}

/// Springs and dampers at the joints, as drives have them.
fn hold(q: &SVector<f64, 19>, v: &SVector<f64, 18>) -> SVector<f64, 12> {
    SVector::from_fn(|k, _| {
        let wanted = [0.0, 0.8, -1.6][k % 3];
        6.0 * (wanted - q[7 + k]) - 0.15 * v[6 + k]
    })
}

/// It falls on its feet, and stands: on a slope of 10° it neither sinks nor creeps, where other engines creep by
/// millimetres a second.
#[test]
fn a_quadruped_stands() {
    let m = Solo { slope: 10.0_f64.to_radians() };
    let mut q = m.neutral();
    q[2] = 0.26;
    for leg in 0..4 {
        (q[8 + 3 * leg], q[9 + 3 * leg]) = (0.8, -1.6);
    }
    let run = simulate(&m)
        .from(q, [0.0; 18])
        .inputs(|_, q, v| hold(q, v))
        .method(TimeStepping::step(1e-3))
        .sample_every(0.5)
        .duration(14.0);
    let samples: Vec<_> = run.map(|sample| sample.unwrap()).collect();
    let (before, after) = (samples[samples.len() - 2], samples[samples.len() - 1]);
    let creep = (after.q - before.q).norm() / 0.5;
    assert!(creep < 1e-6, "{creep:e}");
    let gaps = m.contact_gaps(&after.q);
    assert!(gaps.amax() < 1e-8, "{gaps}");
    // The feet carry the robot, along and across the slope.
    let u = hold(&after.q, &after.v);
    let forces = contact::forces(&m, after.t, &after.q, &after.v, &u, 1e-3).unwrap();
    let normal: f64 = (0..4).map(|k| forces[3 * k]).sum();
    let weight = m.total_mass() * 9.81;
    assert!((normal - weight * m.slope.cos()).abs() < 1e-6 * weight, "{normal} {weight}");
    let along: [f64; 2] = [1, 2].map(|c| (0..4).map(|k| forces[3 * k + c]).sum());
    assert!((along[0].hypot(along[1]) - weight * m.slope.sin()).abs() < 1e-6 * weight, "{along:?}");
}
