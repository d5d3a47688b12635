//! Checks of bodies on frames whose motion is a function of time: without any coordinate, on each other, and
//! several on one frame.

use linkwork::prelude::*;
use support::compare::assert_close;

/// Arm that rotates with constant angular velocity, a lamp that moves with it, and a second arm that rotates
/// relative to the first one. No body has a coordinate.
#[mechanism(gravity = -9.81 * y)]
struct RotatingArmsWithLamp {
    first_speed: f64,
    second_speed: f64,
    #[frame(ground, z(first_speed * t))]
    lower: Frame,
    #[body(mass = 2, com = 0.25 * x, inertia = rod(2, 0.5, x), frame = lower)]
    arm: Body,
    #[particle(mass = 0.7, at = 0.1 * lower.y)]
    lamp: Particle,
    #[frame(arm, z(second_speed * t))]
    upper: Frame,
    #[body(mass = 1, com = 0.2 * x, inertia = rod(1, 0.4, x), at = arm.at(0.5 * x), frame = upper)]
    forearm: Body,
    #[output(arm)]
    on_arm: FreeBody,
    #[output(forearm)]
    on_forearm: FreeBody,
    #[output(lamp)]
    on_lamp: FreeBody,
    #[output(v(forearm.at(0.4 * x) / ground / ground))]
    speed: Vector,
    #[output(a(forearm.at(0.4 * x) / ground / ground))]
    acceleration: Vector,
    #[output(angular_momentum((arm, forearm, lamp) / ground))]
    spin: Vector,
}

#[test]
fn arms_on_frames_output_their_drive_torques() {
    let (w1, w2) = (3.0, -2.0);
    let m = RotatingArmsWithLamp { first_speed: w1, second_speed: w2 };
    assert_eq!((RotatingArmsWithLamp::NQ, RotatingArmsWithLamp::NV), (0, 0));
    let (q, v) = (SVector::<f64, 0>::zeros(), SVector::<f64, 0>::zeros());
    let w = w1 + w2;
    let direction_at_angle = |angle: f64| [angle.cos(), angle.sin()];
    for k in 0..12 {
        let t = 0.2 * f64::from(k);
        let ([c1, s1], [c2, s2]) = (direction_at_angle(w1 * t), direction_at_angle(w * t));
        let tip = m.speed(t, &q);
        assert_close(
            "speed",
            &tip.data.0[0][..2],
            &[-0.5 * w1 * s1 - 0.4 * w * s2, 0.5 * w1 * c1 + 0.4 * w * c2],
            1e-12,
        );
        let a = m.acceleration(t, &q);
        let expected_acceleration =
            |l: f64| [-0.5 * w1 * w1 * c1 - l * w * w * c2, -0.5 * w1 * w1 * s1 - l * w * w * s2];
        assert_close("acceleration", &a.data.0[0][..2], &expected_acceleration(0.4), 1e-12);
        // Force that the arm exerts on the forearm at its elbow.
        let a = expected_acceleration(0.2);
        let force = [a[0], a[1] + 9.81];
        let elbow = 0.2 * (c2 * force[1] - s2 * force[0]);
        let on_forearm = m.on_forearm(t, &q, &v);
        let place = on_forearm.get("forearm.place").unwrap();
        assert_close("force", &place.force.data.0[0][..2], &force, 1e-11);
        assert_close("torque", &[place.torque[2]], &[elbow], 1e-11);
        // The frame exerts a force on the arm, and the forearm a reaction; the lamp hangs from the frame.
        let on_arm = m.on_arm(t, &q, &v);
        let names: Vec<&str> = on_arm.actions.iter().map(|action| action.name).collect();
        assert_eq!(names, ["gravity", "arm.place", "forearm.place"]);
        let arm = [-0.25 * w1 * w1 * c1, -0.25 * w1 * w1 * s1];
        let shoulder = [2.0 * arm[0] + force[0], 2.0 * (arm[1] + 9.81) + force[1]];
        let place = on_arm.get("arm.place").unwrap();
        assert_close("force", &place.force.data.0[0][..2], &shoulder, 1e-11);
        let torque = elbow + 0.5 * (c1 * force[1] - s1 * force[0]) + 2.0 * 9.81 * 0.25 * c1;
        assert_close("torque", &[place.torque[2]], &[torque], 1e-11);
        let lamp = m.on_lamp(t, &q, &v);
        let expected = [0.7 * 0.1 * w1 * w1 * s1, 0.7 * (9.81 - 0.1 * w1 * w1 * c1)];
        assert_close("lamp", &lamp.get("lamp.place").unwrap().force.data.0[0][..2], &expected, 1e-11);
        // The sum of all torques about the shoulder is the rate of the angular momentum.
        let rate = super::time_derivative(|t| m.spin(t, &q)[2], t);
        let weights = 9.81 * (2.0 * 0.25 * c1 + 0.5 * c1 + 0.2 * c2 - 0.7 * 0.1 * s1);
        let lamp = lamp.get("lamp.place").unwrap();
        let about = -0.1 * s1 * lamp.force[1] - 0.1 * c1 * lamp.force[0];
        assert_close("angular momentum", &[rate], &[torque + about - weights], 1e-8);
    }
}
