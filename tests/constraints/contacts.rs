//! Rolling and sliding on cones, tori, bowls and parametric surfaces, compared with closed forms and with
//! equivalent descriptions.

use linkwork::integrate::DormandPrince;
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;

/// Bevel gears without teeth: two cones that roll on each other, on intersecting axles.
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

/// Bevel gears: a cone that rolls inside a funnel, each on an axle of its own. The surface of the driven
/// wheel is named first.
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

/// `ω₁ sin α = ∓ ω₂ sin β`: the difference of the angular velocities is along the common line.
#[test]
fn cones_on_axles_are_bevel_gears() {
    let (small, large, inertia) = (0.4_f64, 0.9_f64, 0.02);
    let ratio = small.sin() / large.sin();
    // The denominator adds the reflected inertia of the wheel to the pinion's.
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

/// Cone that is free to move in a funnel.
#[mechanism(gravity = -9.81 * z)]
struct FreeConeInFunnel {
    #[body(mass = 0.2, com = 0.15 * z, inertia = cone(0.2, 0.1, 0.2, z))]
    cone: Body,
    #[joint(ground -> cone)]
    pose: Free,
    #[constraint(rolls(cone.cone(0.46, z), ground.funnel(0.8, z)))]
    contact: Rolling,
}

/// Cone in a funnel with its apex on a ball joint, which makes a part of the contact's conditions redundant.
#[mechanism(gravity = -9.81 * z)]
struct ConeOnBallJoint {
    #[body(mass = 0.2, com = 0.15 * z, inertia = cone(0.2, 0.1, 0.2, z))]
    cone: Body,
    #[joint(ground -> cone)]
    apex: Ball,
    #[constraint(rolls(cone.cone(0.46, z), ground.funnel(0.8, z)))]
    contact: Rolling,
}

#[test]
fn cone_rotates_about_its_line_of_contact() {
    assert_eq!((FreeConeInFunnel::NC, FreeConeInFunnel::NH, FreeConeInFunnel::NS), (5, 4, 1));
    assert_eq!((ConeOnBallJoint::NC, ConeOnBallJoint::NH, ConeOnBallJoint::NS), (2, 1, 1));
    // The cone leans towards x by the difference of the angles, and is rotated about its axis.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.8 - 0.46)
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 1.1);
    let line = turn.inverse() * Vector3::new(0.8_f64.sin(), 0.0, 0.8_f64.cos());
    let q = [0.0, 0.0, 0.0, turn.i, turn.j, turn.k, turn.w].into();
    assert!(FreeConeInFunnel {}.constraint_residuals(&q).amax() < 1e-15);
    let v =
        FreeConeInFunnel {}.project_velocity(&q, &[0.3, -0.4, 0.5, 1.0, 2.0, 3.0].into()).expect("regular");
    let w = Vector3::new(v[3], v[4], v[5]);
    assert!(w.norm() > 0.1 && w.cross(&line).norm() < 1e-14, "{w} is not along {line}");
    assert!(v.fixed_rows::<3>(0).norm() < 1e-14);
    let a = FreeConeInFunnel {}.forward_dynamics(&q, &v, &SVector::zeros());
    let held = ConeOnBallJoint {}.forward_dynamics(&[q[3], q[4], q[5], q[6]].into(), &w, &SVector::zeros());
    assert!((held - a.fixed_rows::<3>(3)).amax() < 1e-11 * held.amax());
}

/// Ball that rolls on a cone, which stands on its base.
#[mechanism(gravity = -9.81 * z)]
struct BallOnCone {
    #[body(mass = 0.3, inertia = sphere(0.3, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(rolls(ball.sphere(0.05), ground.cone(0.5, -z)))]
    contact: Rolling,
}

/// Along the line of steepest descent the acceleration is that on an incline: `5/7` of the component of
/// gravity.
#[test]
fn ball_rolls_down_a_cone_as_on_an_incline() {
    let (s, c) = 0.5_f64.sin_cos();
    // The contact is at the distance 0.3 along the cone from its apex; the centre is one radius away from it.
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

/// Disk on a plane, and on the same plane in parametric form.
#[mechanism(gravity = -9.81 * z)]
struct TorusOnPlane {
    #[body(mass = 0.4, inertia = disk(0.4, 0.2, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[constraint(rolls(disk.torus(0.2, 0.03, y), ground.plane(unit(0.2 * x + z))))]
    contact: Rolling,
}

#[mechanism(gravity = -9.81 * z, derivatives)]
struct TorusOnParametricPlane {
    u: Coordinate,
    w: Coordinate,
    #[body(mass = 0.4, inertia = disk(0.4, 0.2, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[constraint(rolls(disk.torus(0.2, 0.03, y), ground.surface(u, w, u * x + w * y - 0.2 * u * z)))]
    contact: Rolling,
}

#[mechanism(gravity = -9.81 * z, formulation = speeds)]
struct DiskOnParametricPlaneInSpeeds {
    u: Coordinate,
    w: Coordinate,
    #[body(mass = 0.4, inertia = disk(0.4, 0.2, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[constraint(rolls(disk.torus(0.2, 0.03, y), ground.surface(u, w, u * x + w * y - 0.2 * u * z)))]
    contact: Rolling,
}

/// The accelerations and the normal force are equal, with a compressive and with a tensile normal force.
#[test]
fn parametric_plane_equals_a_plane_contact() {
    let turn = UnitQuaternion::from_euler_angles(0.4, 0.1, -0.7);
    let near = [0.3, 0.2, 0.3, 0.2, 0.2, turn.i, turn.j, turn.k, turn.w].into();
    let on = TorusOnParametricPlane {}.assemble(&near, &[]).expect("it is near");
    let q = on.fixed_rows::<7>(2).into_owned();
    assert!(TorusOnPlane {}.constraint_residuals(&q).amax() < 1e-14);
    let v = TorusOnPlane {}.project_velocity(&q, &[0.3, 0.1, -0.4, 2.0, -3.0, 1.0].into()).expect("regular");
    let all = SVector::from_fn(|k, _| if k < 2 { 0.0 } else { v[k - 2] });
    let then = TorusOnParametricPlane {}.project_velocity(&on, &all).expect("regular");
    assert!((then - all).rows(2, 6).amax() < 1e-12);
    let (a, lambda) = TorusOnPlane {}.constrained_dynamics(&q, &v, &SVector::zeros());
    let (b, forces) = TorusOnParametricPlane {}.constrained_dynamics(&on, &then, &SVector::zeros());
    assert!((a - b.rows(2, 6)).amax() < 1e-10, "{a} {b}");
    assert_eq!(TorusOnParametricPlane::CONSTRAINTS[0], "contact.normal");
    assert!((lambda[0] - forces[0]).abs() < 1e-10 && forces.rows(1, 2).amax() < 1e-11, "{lambda} {forces}");
    let (c, others) = DiskOnParametricPlaneInSpeeds {}.constrained_dynamics(&on, &then, &SVector::zeros());
    assert!((b - c).amax() < 1e-9 * b.amax() && (forces - others).amax() < 1e-9, "{b} {c} {forces} {others}");
    // The auxiliary inertia of the contact's coordinates does not appear in inverse dynamics.
    let held = TorusOnParametricPlane {}.constraint_jacobian(&on).transpose() * forces;
    assert!((TorusOnParametricPlane {}.inverse_dynamics(&on, &then, &b) - held).amax() < 1e-11);
}

/// Derivatives of a contact on a parametric surface agree with differences.
#[test]
fn parametric_surface_contact_has_exact_derivatives() {
    let turn = UnitQuaternion::from_euler_angles(0.4, 0.1, -0.7);
    let near = [0.3, 0.2, 0.3, 0.2, 0.2, turn.i, turn.j, turn.k, turn.w].into();
    let q = TorusOnParametricPlane {}.assemble(&near, &[]).expect("it is near");
    let any = [0.0, 0.0, 0.3, 0.1, -0.4, 2.0, -3.0, 1.0].into();
    let v = TorusOnParametricPlane {}.project_velocity(&q, &any).expect("regular");
    let (by_q, by_v, _) = TorusOnParametricPlane {}.forward_dynamics_derivatives(&q, &v, &SVector::zeros());
    let accelerations_on_parametric_plane = |q: &SVector<f64, 9>, v: &SVector<f64, 8>| {
        TorusOnParametricPlane {}.forward_dynamics(q, v, &SVector::zeros())
    };
    for k in 0..8 {
        let unit_direction_times = |h: f64| SVector::<f64, 8>::from_fn(|i, _| if i == k { h } else { 0.0 });
        let five_point_derivative = |f: &dyn Fn(f64) -> SVector<f64, 8>, h: f64| {
            ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
        };
        let found = five_point_derivative(
            &|h| {
                accelerations_on_parametric_plane(
                    &TorusOnParametricPlane {}.integrate(&q, &unit_direction_times(h)),
                    &v,
                )
            },
            1e-3,
        );
        assert!((found - by_q.column(k)).amax() < 1e-6 * by_q.amax(), "{found} {}", by_q.column(k));
        let found = five_point_derivative(
            &|h| accelerations_on_parametric_plane(&q, &(v + unit_direction_times(h))),
            1e-3,
        );
        assert!((found - by_v.column(k)).amax() < 1e-6 * by_v.amax(), "{found} {}", by_v.column(k));
    }
}

/// Ball in a rotating bowl that is described by two angles, with dry friction. The normal points inwards.
#[mechanism(gravity = -9.81 * z)]
struct BallInBowlByAngles {
    polar: Coordinate,
    around: Coordinate,
    #[frame(ground, y(0.5 * t))]
    turned: Frame,
    #[body(massive, frame = turned)]
    bowl: Body,
    #[body(mass = 0.3, inertia = sphere(0.3, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(
        slips(
            ball.sphere(0.05),
            bowl.surface(
                around,
                polar,
                0.45 * (sin(polar) * (cos(around) * x + sin(around) * y) + cos(polar) * z)
            )
        ),
        friction = 0.4
    )]
    contact: Slipping,
}

#[mechanism(gravity = -9.81 * z)]
struct BallInRotatingBowl {
    #[frame(ground, y(0.5 * t))]
    turned: Frame,
    #[body(massive, frame = turned)]
    bowl: Body,
    #[body(mass = 0.3, inertia = sphere(0.3, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(slips(ball.sphere(0.05), bowl.bowl(0.45)), friction = 0.4)]
    contact: Slipping,
}

#[test]
fn parametric_bowl_equals_its_closed_form() {
    let t = 0.7;
    let near = [0.2, 0.1, -0.33, 0.5, 0.5, -0.5, 0.5].into();
    let q = BallInRotatingBowl {}.project_configuration(t, &near).expect("the bowl is near");
    let v = BallInRotatingBowl {}
        .project_velocity(t, &q, &[0.3, 0.1, -0.4, 2.0, -3.0, 1.0].into())
        .expect("regular");
    let center =
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -0.5 * t) * Vector3::new(q[0], q[1], q[2]);
    let angles = [(center.z / center.norm()).acos(), center.y.atan2(center.x)];
    let on = SVector::from_fn(|k, _| if k < 2 { angles[k] } else { q[k - 2] });
    assert!(BallInBowlByAngles {}.constraint_residuals(t, &on).amax() < 1e-14);
    let all = SVector::from_fn(|k, _| if k < 2 { 0.0 } else { v[k - 2] });
    let then = BallInBowlByAngles {}.project_velocity(t, &on, &all).expect("regular");
    let (a, lambda) = BallInRotatingBowl {}.constrained_dynamics(t, &q, &v, &SVector::zeros());
    let (b, forces) = BallInBowlByAngles {}.constrained_dynamics(t, &on, &then, &SVector::zeros());
    assert!((a - b.rows(2, 6)).amax() < 1e-10 * a.amax(), "{a} {b}");
    assert!((lambda[0] - forces[0]).abs() < 1e-11 && forces.rows(1, 2).amax() < 1e-11, "{lambda} {forces}");
}

/// Particle in a paraboloid, which is declared as a constraint on the coordinates.
#[mechanism(gravity = -9.81 * z)]
struct BeadInDish {
    #[particle(mass = 0.1)]
    bead: Particle,
    #[joint(ground -> bead, along = (x, y, z))]
    place: Stage,
    #[constraint(place.z = (place.x * place.x + place.y * place.y) / (2 * 0.3))]
    dish: Holonomic,
}

/// A particle circles at any constant height with `Ω² = g / c`.
#[test]
fn particle_circles_in_a_dish_at_constant_rate() -> Result<(), Error> {
    let rate = (9.81_f64 / 0.3).sqrt();
    for radius in [0.01, 0.4] {
        let q = [radius, 0.0, radius * radius / 0.6];
        let method = DormandPrince::new().tolerance(1e-11, 1e-11);
        let end = simulate(&BeadInDish {})
            .from(q, [0.0, rate * radius, 0.0])
            .method(method)
            .duration(1.0)
            .finish()?;
        let expected = SVector::from([radius * rate.cos(), radius * rate.sin(), q[2]]);
        assert!((end.q - expected).amax() < 1e-8, "{} {expected}", end.q);
    }
    Ok(())
}
