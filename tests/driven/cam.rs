//! Cam with a given speed that lifts a follower against a spring.

use linkwork::prelude::*;
use support::compare::assert_close;

/// Round disk on an eccentric shaft under a flat follower.
#[mechanism(gravity = -9.81 * y)]
struct Cam {
    speed: f64,
    #[body(mass = 0.6, com = 0.02 * x, inertia = disk(0.6, 0.05, z))]
    cam: Body,
    #[body(mass = 0.4)]
    follower: Body,
    #[joint(ground -> cam, about = z)]
    shaft: Pin,
    #[joint(ground -> follower, along = y)]
    guide: Sleeve,
    #[acts(on = guide, stiffness = 900)]
    valve: Spring,
    #[constraint(guide = 0.05 + dot(r(cam.at(0.02 * x) / ground), y))]
    contact: Holonomic,
    #[constraint(shaft = speed * t)]
    motor: Holonomic,
    #[output(reaction_force(shaft))]
    bearing: Vector,
}

/// Checks a cam with the lift `s = 0.05 + e sin φ`: the normal force of the follower is `m s̈ + k s + m g`.
/// The torque of the cam is this force times `e cos φ`, plus the moment of the weight of the cam.
#[test]
fn cam_carries_spring_weight_and_inertia_forces() {
    let (speed, e, mass) = (40.0, 0.02, 0.4);
    let m = Cam { speed };
    for k in 0..20 {
        let t = 0.009 * f64::from(k);
        let (s, c) = (speed * t).sin_cos();
        let q = m.assemble(t, &[speed * t, 0.0].into(), &[0]).unwrap();
        assert_close("lift", &[q[1]], &[0.05 + e * s], 1e-12);
        let v = m.project_velocity(t, &q, &SVector::zeros()).unwrap();
        let (a, lambda) = m.constrained_dynamics(t, &q, &v, &SVector::zeros());
        assert_close("lifting", &a.data.0[0], &[0.0, -e * speed * speed * s], 1e-10);
        let press = mass * (a[1] + 9.81) + 900.0 * q[1];
        assert_close("contact", &[lambda[0]], &[press], 1e-9);
        assert_close("torque", &[lambda[1]], &[press * e * c + 0.6 * 9.81 * e * c], 1e-9);
        let centre = [-e * speed * speed * c, -e * speed * speed * s];
        let bearing = m.bearing(t, &q, &v);
        let expected = [0.6 * centre[0], 0.6 * (centre[1] + 9.81) + press];
        assert_close("bearing", &bearing.data.0[0][..2], &expected, 1e-9);
    }
}
