//! Checks of a ratchet, in which the weight of a pawl holds it in the teeth of a rack.

use linkwork::contact;
use linkwork::prelude::*;

/// Ratchet with teeth 0.1 m long: a gentle flank of slope 1/2 and a steep flank of slope 2.
#[mechanism(gravity = -9.81 * z)]
struct Ratchet {
    friction: f64,
    load: f64,
    #[body(mass = 1)]
    rack: Body,
    #[joint(ground -> rack, along = x)]
    rail: Sleeve,
    #[particle(mass = 0.5)]
    pawl: Particle,
    #[joint(ground -> pawl, along = z)]
    guide: Sleeve,
    #[acts(on = rack, value = load * x)]
    pull: Force,
    #[contact(
        pawl,
        rack.terrain(max(max(min(u / 2, 2 * (0.1 - u)), min((u - 0.1) / 2, 2 * (0.2 - u))), min((u - 0.2) / 2, 2 * (0.3 - u)))),
        friction = friction
    )]
    teeth: Contact,
}

const WEIGHT: f64 = 0.5 * 9.81;

/// Returns the displacement of the rack after 0.05 s from rest, with the pawl on a flank at the position `u`
/// of the rack and at the height `z`.
fn displacement_of_rack(friction: f64, load: f64, [u, z]: [f64; 2]) -> f64 {
    let m = Ratchet { friction, load };
    let q = SVector::from([-u, z]);
    contact::check(&m, 0.0, &q).unwrap();
    let end = simulate(&m).from(q, [0.0; 2]).method(TimeStepping::step(1e-3)).duration(0.05).finish();
    end.unwrap().q[0] - q[0]
}

/// The pawl climbs a flank of slope `s = tan α` under a load of `m g tan(α + φ) = m g (s + μ) / (1 − s μ)`
/// with `μ = tan φ`. For `s μ > 1` no load moves the rack. A locked rack does not creep.
#[test]
fn pawl_holds_its_load_in_one_direction() {
    let climbing_force = |s: f64, friction: f64| WEIGHT * (s + friction) / (1.0 - s * friction);
    let (gentle, steep) = ([0.03, 0.015], [0.19, 0.02]);
    for friction in [0.3, 0.6] {
        let load = -climbing_force(0.5, friction);
        assert!(displacement_of_rack(friction, load * 1.001, gentle) < -1e-7, "{friction}");
        if friction > 0.5 {
            // The flank supports the pawl without a load, and with a load up to the limit.
            assert!(displacement_of_rack(friction, load * 0.999, gentle).abs() < 1e-12);
        }
    }
    let load = climbing_force(2.0, 0.3);
    assert!(displacement_of_rack(0.3, load * 1.001, steep) > 1e-7);
    assert!(displacement_of_rack(0.3, load * 0.999, steep).abs() < 1e-12);
    for times in [2.0, 1e3] {
        let moved = displacement_of_rack(0.6, WEIGHT * times, steep);
        assert!(moved.abs() < 1e-12, "{times}: {moved}");
    }
}

/// Checks that the rack, pulled in its free direction, moves under the pawl, which falls into one tooth gap
/// after another.
#[test]
fn rack_moves_only_in_its_free_direction() {
    // The load is slightly above the limit of the gentle flanks.
    let m = Ratchet { friction: 0.3, load: -1.1 * WEIGHT };
    let run = simulate(&m).from([-0.03, 0.015], [0.0; 2]).method(TimeStepping::step(2e-4)).duration(3.0);
    let (mut falls, mut before) = (0, 0.0);
    for sample in run {
        let sample = sample.unwrap();
        if sample.q[0] < -0.28 {
            break;
        }
        falls += usize::from(before >= 0.0 && sample.v[1] < 0.0);
        before = sample.v[1];
        assert!(m.contact_gaps(&sample.q)[0] > -2e-3, "{}", sample.q);
    }
    assert!(falls >= 2, "{falls}");
}
