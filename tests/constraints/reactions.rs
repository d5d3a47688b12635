//! Reactions of joints against the Newton-Euler equations of each free body.

use linkwork::nalgebra::Vector3;
use linkwork::prelude::*;
use support::slider_crank;

slider_crank! {
    /// Slider-crank with a spring between the crank's pin and the ground, and a motor.
    #[mechanism(gravity = -9.81 * y)]
    struct SliderCrank {
        #[acts(on = main)]
        motor: Torque,
        #[acts(between = (ground.at(0.5 * y), rod.at(0.2 * x)), stiffness = 40, free_length = 0.3)]
        coil: Spring,

        #[output(reaction_force(main))]
        on_crank: Vector,
        #[output(reaction_torque(main))]
        turning_crank: Vector,
        #[output(reaction_force(big_end))]
        on_rod: Vector,
        #[output(reaction_force(big_end), resolved_in = rod)]
        along_rod: Vector,
        #[output(reaction_force(cylinder))]
        wall: Vector,
        #[output(reaction_force(small_end))]
        on_piston: Vector,
        #[output(norm(reaction_force(small_end)))]
        load: Scalar,
        #[point(on = rod, at = 0.3 * x)]
        rod_centre: Point,
        #[point(on = crank, at = 0.1 * x)]
        crank_centre: Point,
        #[output(a(rod_centre / ground / ground))]
        rod_acceleration: Vector,
        #[output(a(crank_centre / ground / ground))]
        crank_acceleration: Vector,
    }
}

#[test]
fn reactions_balance_every_free_body() {
    let slider = SliderCrank {};
    let weight = Vector3::new(0.0, -9.81, 0.0);
    for crank in [0.3_f64, 1.2, 2.5, -1.0] {
        let guess = SVector::from([crank, -2.0 * crank.sin(), 0.6]);
        let q = slider.assemble(&guess, &[0]).expect("the rod is long enough");
        let v = slider.project_velocity(&q, &SVector::from([7.0, 0.0, 0.0])).expect("one degree of freedom");
        let u = SVector::from([3.0]);
        let a = slider.forward_dynamics(&q, &v, &slider.generalized_forces(&q, &u));
        let (on_rod, on_piston) = (slider.on_rod(&q, &v, &u), slider.on_piston(&q, &v, &u));
        let point_on_rod = |along: f64| {
            let turned = q[0] + q[1];
            Vector3::new(
                0.2 * q[0].cos() + along * turned.cos(),
                0.2 * q[0].sin() + along * turned.sin(),
                0.0,
            )
        };
        let stretch = Vector3::new(0.0, 0.5, 0.0) - point_on_rod(0.2);
        let spring = stretch * (40.0 * (stretch.norm() - 0.3) / stretch.norm());
        let assert_close_vectors = |found: Vector3<f64>, expected: Vector3<f64>| {
            assert!((found - expected).norm() < 1e-10 * (1.0 + expected.norm()), "{found} for {expected}");
        };
        // Forces: the joint reactions, the weight and the spring force give each centre of mass its
        // acceleration.
        let moved = slider.rod_acceleration(&q, &v, &a);
        assert_close_vectors(on_rod - on_piston + spring + weight * 0.8, moved * 0.8);
        let moved = slider.crank_acceleration(&q, &v, &a);
        assert_close_vectors(slider.on_crank(&q, &v, &u) - on_rod + weight * 1.5, moved * 1.5);
        assert_close_vectors(
            on_piston + slider.wall(&q, &v, &u) + weight * 0.5,
            Vector3::new(a[2], 0.0, 0.0) * 0.5,
        );
        // Moments about the centre of the rod, and about the crank's bearing, where the motor acts.
        let moment = (point_on_rod(0.0) - point_on_rod(0.3)).cross(&on_rod)
            - (point_on_rod(0.6) - point_on_rod(0.3)).cross(&on_piston)
            + (point_on_rod(0.2) - point_on_rod(0.3)).cross(&spring);
        assert_close_vectors(moment, Vector3::new(0.0, 0.0, 0.8 * 0.36 / 12.0 * (a[0] + a[1])));
        let moment = slider.turning_crank(&q, &v, &u) - point_on_rod(0.0).cross(&on_rod)
            + (point_on_rod(0.0) * 0.5).cross(&(weight * 1.5));
        assert_close_vectors(moment, Vector3::new(0.0, 0.0, 1.5 * 0.04 / 3.0 * a[0]));
        // Outputs in other axes, and as scalars.
        let turned = q[0] + q[1];
        let along = slider.along_rod(&q, &v, &u);
        assert!((along[0] - (on_rod[0] * turned.cos() + on_rod[1] * turned.sin())).abs() < 1e-9);
        assert!((slider.load(&q, &v, &u) - on_piston.norm()).abs() < 1e-9);
    }
}

/// Rod welded to the end of a rotating arm: the weld transmits its weight, the centripetal force and their
/// moment.
#[mechanism(gravity = -9.81 * z)]
struct WeldedArm {
    #[body(mass = 2, com = 0.5 * x, inertia = rod(2, 1, x))]
    arm: Body,
    #[body(mass = 3, com = 0.25 * z, inertia = rod(3, 0.5, z))]
    post: Body,
    #[joint(ground -> arm, about = z)]
    hub: Pin,
    #[joint(arm.at(x) -> post)]
    weld: Weld,
    #[output(reaction_force(weld), resolved_in = arm)]
    force: Vector,
    #[output(reaction_torque(weld), resolved_in = arm)]
    torque: Vector,
}

#[test]
fn weld_reaction_carries_the_suspended_bodies() {
    let arm = WeldedArm {};
    let (q, v): (SVector<f64, 1>, SVector<f64, 1>) = (SVector::from([0.7]), SVector::from([2.0]));
    let force = arm.force(&q, &v);
    assert!((force - Vector3::new(-3.0 * 4.0, 0.0, 3.0 * 9.81)).norm() < 1e-12, "{force}");
    // The centripetal force acts at the height of the centre of mass.
    let torque = arm.torque(&q, &v);
    assert!((torque - Vector3::new(0.0, 0.25 * -12.0, 0.0)).norm() < 1e-12, "{torque}");
}
