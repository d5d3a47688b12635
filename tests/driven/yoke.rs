//! Scotch yoke: a pin of the crank moves in a slot of the slider, which oscillates as a cosine.

use linkwork::prelude::*;
use support::compare::assert_close;

#[mechanism]
struct ScotchYoke {
    omega: f64,
    start: f64,
    #[body(mass = 0.3, inertia = disk(0.3, 0.1, z))]
    crank: Body,
    #[body(mass = 2)]
    yoke: Body,
    #[joint(ground -> crank, about = z)]
    shaft: Pin,
    #[joint(ground -> yoke, along = x)]
    guide: Sleeve,
    #[constraint(dot(r(crank.at(0.1 * x) / yoke), x) = 0)]
    slot: Holonomic,
    #[constraint(shaft = start + omega * t)]
    motor: Holonomic,
}

/// Checks a Scotch yoke with `x = r cos φ`: the force of the slot is `m ẍ`, and the torque is
/// `m r² ω² sin φ cos φ`, at twice the frequency of the rotation.
#[test]
fn scotch_yoke_follows_a_cosine() {
    assert_eq!((ScotchYoke::NS, ScotchYoke::NP), (0, 0));
    let (omega, start) = (12.0, 0.3);
    let m = ScotchYoke { omega, start };
    for k in 0..20 {
        let t = 0.04 * f64::from(k);
        let (s, c) = (start + omega * t).sin_cos();
        let q = m.assemble(t, &m.neutral(), &[]).unwrap();
        assert_close("yoke", &[q[1]], &[0.1 * c], 1e-12);
        let v = m.complete_velocity(t, &q, &SVector::zeros(), &[]).unwrap();
        assert_close("rate", &v.data.0[0], &[omega, -0.1 * omega * s], 1e-12);
        let a = m.complete_acceleration(t, &q, &v, &SVector::zeros(), &[]).unwrap();
        assert_close("acceleration", &a.data.0[0], &[0.0, -0.1 * omega * omega * c], 1e-11);
        let (_, lambda) = m.constrained_inverse_dynamics(t, &q, &v, &a, &[]).unwrap();
        assert_close("slot", &[lambda[0].abs()], &[(2.0 * 0.1 * omega * omega * c).abs()], 1e-10);
        assert_close("torque", &[lambda[1]], &[2.0 * 0.01 * omega * omega * s * c], 1e-10);
    }
}
