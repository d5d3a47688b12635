//! Contacts between surfaces, where the gallery has no mechanism of its own.

use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;

/// Bevel gears without teeth: cones on crossed axles.
#[mechanism]
struct Cones {
    small: f64,
    large: f64,
    inertia: f64,

    #[body(inertia = diagonal(inertia, inertia, inertia))]
    pinion: Body,
    #[body(inertia = diagonal(inertia, inertia, 2 * inertia))]
    wheel: Body,
    #[joint(ground.rotated(x(small + large)) -> pinion, about = z)]
    fast: Pin,
    #[joint(ground -> wheel, about = z)]
    slow: Pin,
    #[acts(on = fast)]
    motor: Torque,
    #[constraint(rolls(pinion.cone(small, z), wheel.cone(large, z)))]
    contact: Rolling,
}

/// The same with one inside of the other, and the pair the other way round.
#[mechanism]
struct ConeInFunnel {
    small: f64,
    large: f64,
    inertia: f64,

    #[body(inertia = diagonal(inertia, inertia, inertia))]
    pinion: Body,
    #[body(inertia = diagonal(inertia, inertia, 2 * inertia))]
    wheel: Body,
    #[joint(ground.rotated(x(large - small)) -> pinion, about = z)]
    fast: Pin,
    #[joint(ground -> wheel, about = z)]
    slow: Pin,
    #[acts(on = fast)]
    motor: Torque,
    #[constraint(rolls(wheel.funnel(large, z), pinion.cone(small, z)))]
    contact: Rolling,
}

/// `ω₁ sin α = ∓ ω₂ sin β`: the angular velocities differ by one along the common line.
#[test]
fn cones_on_axles_are_bevel_gears() {
    let (small, large, inertia) = (0.4_f64, 0.9_f64, 0.02);
    let ratio = small.sin() / large.sin();
    // What the wheel adds to the pinion's inertia.
    let expected = 3.0 / (inertia * (1.0 + 2.0 * ratio * ratio));
    let (q, v) = ([0.3, 0.1].into(), [0.0, 0.0].into());
    let cones = Cones { small, large, inertia };
    assert_eq!((Cones::NC, Cones::NH, Cones::CONSTRAINTS[0]), (1, 0, "contact.spin"));
    let a = cones.forward_dynamics(&q, &v, &[3.0, 0.0].into());
    assert!((a - SVector::from([expected, -ratio * expected])).amax() < 1e-11, "{a}");
    let nested = ConeInFunnel { small, large, inertia };
    assert_eq!((ConeInFunnel::NC, ConeInFunnel::NH, ConeInFunnel::CONSTRAINTS[0]), (1, 0, "contact.spin"));
    let a = nested.forward_dynamics(&q, &v, &[3.0, 0.0].into());
    assert!((a - SVector::from([expected, ratio * expected])).amax() < 1e-11, "{a}");
}

/// A cone that is free to move in a funnel.
#[mechanism(gravity = -9.81 * z)]
struct FreeCone {
    #[body(mass = 0.2, com = 0.15 * z, inertia = cone(0.2, 0.1, 0.2, z))]
    cone: Body,
    #[joint(ground -> cone)]
    pose: Free,
    #[constraint(rolls(cone.cone(0.46, z), ground.funnel(0.8, z)))]
    contact: Rolling,
}

/// The same with its apex on a ball joint, which holds what the contact does as well.
#[mechanism(gravity = -9.81 * z)]
struct HeldCone {
    #[body(mass = 0.2, com = 0.15 * z, inertia = cone(0.2, 0.1, 0.2, z))]
    cone: Body,
    #[joint(ground -> cone)]
    apex: Ball,
    #[constraint(rolls(cone.cone(0.46, z), ground.funnel(0.8, z)))]
    contact: Rolling,
}

#[test]
fn a_cone_turns_about_the_line_of_contact() {
    assert_eq!((FreeCone::NC, FreeCone::NH, FreeCone::NS), (5, 4, 1));
    assert_eq!((HeldCone::NC, HeldCone::NH, HeldCone::NS), (2, 1, 1));
    // Leaning towards x by the difference of the angles; turned about its axis.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.8 - 0.46)
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 1.1);
    let line = turn.inverse() * Vector3::new(0.8_f64.sin(), 0.0, 0.8_f64.cos());
    let q = [0.0, 0.0, 0.0, turn.i, turn.j, turn.k, turn.w].into();
    assert!(FreeCone {}.constraint_residuals(&q).amax() < 1e-15);
    let v = FreeCone {}.project_velocity(&q, &[0.3, -0.4, 0.5, 1.0, 2.0, 3.0].into()).expect("regular");
    let w = Vector3::new(v[3], v[4], v[5]);
    assert!(w.norm() > 0.1 && w.cross(&line).norm() < 1e-14, "{w} is not along {line}");
    assert!(v.fixed_rows::<3>(0).norm() < 1e-14);
    let a = FreeCone {}.forward_dynamics(&q, &v, &SVector::zeros());
    let held = HeldCone {}.forward_dynamics(&[q[3], q[4], q[5], q[6]].into(), &w, &SVector::zeros());
    assert!((held - a.fixed_rows::<3>(3)).amax() < 1e-11 * held.amax());
}

/// A ball on the tip of a cone that stands on its base.
#[mechanism(gravity = -9.81 * z)]
struct BallOnCone {
    #[body(mass = 0.3, inertia = sphere(0.3, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(rolls(ball.sphere(0.05), ground.cone(0.5, -z)))]
    contact: Rolling,
}

/// Down the line of fall as on an incline: `5/7` of the component of gravity.
#[test]
fn a_ball_rolls_down_a_cone() {
    let (s, c) = 0.5_f64.sin_cos();
    // At the distance 0.3 along the cone from its apex, away from it by the radius.
    let (line, normal) = (Vector3::new(s, 0.0, -c), Vector3::new(c, 0.0, s));
    let center = line * 0.3 + normal * 0.05;
    let q = [center.x, center.y, center.z, 0.0, 0.0, 0.0, 1.0].into();
    assert!(BallOnCone {}.constraint_residuals(&q).amax() < 1e-16);
    let (a, lambda) = BallOnCone {}.constrained_dynamics(&q, &SVector::zeros(), &SVector::zeros());
    let down = line * (5.0 / 7.0 * 9.81 * c);
    assert!((a.fixed_rows::<3>(0) - down).amax() < 1e-13);
    assert!((a[4] - 5.0 / 7.0 * 9.81 * c / 0.05).abs() < 1e-11);
    assert!((lambda[0] - 0.3 * 9.81 * s).abs() < 1e-13);
}
