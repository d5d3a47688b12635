//! Loops that are solved in closed form, against the same linkages with Lagrange multipliers.

use linkwork::prelude::*;

/// Declares each linkage with multipliers (`$branch` is empty), or with a closed-form solution for the
/// assembly mode `$branch`.
macro_rules! linkages {
    ($four_bar:ident, $slider:ident, $six_bar:ident $(, $branch:expr)?) => {
        /// Four-bar linkage on a cart, with joints on rotated axes.
        #[mechanism(gravity = -9.81 * y)]
        struct $four_bar {
            length: f64,
            #[body(mass = 2)]
            cart: Body,
            #[body(mass = 1, com = 0.15 * x, inertia = rod(1, 0.3, x))]
            crank: Body,
            #[body(mass = 0.7, com = 0.5 * length * x, inertia = rod(0.7, length, x))]
            coupler: Body,
            #[body(mass = 1.2, com = 0.3 * y, inertia = rod(1.2, 0.6, y))]
            rocker: Body,
            #[joint(ground -> cart, along = x)]
            rail: Sleeve,
            #[joint(cart -> crank, about = z)]
            main: Pin,
            #[joint(crank.at(0.3 * x) -> coupler, about = z)]
            first: Pin,
            #[joint(cart.at(0.8 * x + 0.1 * y).rotated(z(0.4)) -> rocker, about = -z)]
            second: Pin,
            #[joint(coupler.at(length * x) -> rocker.at(0.6 * y), about = z $(, branch = $branch)?)]
            closing: Pin,
            #[acts(on = main)]
            motor: Torque,
            #[acts(between = (cart.at(0.5 * y), coupler.at(0.2 * x)), stiffness = 40, free_length = 0.3)]
            coil: Spring,
            #[output(reaction_force(main))]
            on_crank: Vector,
            #[output(reaction_torque(main))]
            turning_crank: Vector,
            #[output(reaction_force(first))]
            on_coupler: Vector,
            #[output(reaction_force(second), resolved_in = rocker)]
            on_rocker: Vector,
            #[output(reaction_force(closing))]
            at_closing: Vector,
            #[output(reaction_force(rail))]
            on_cart: Vector,
            #[output(reaction_torque(rail))]
            turning_cart: Vector,
        }

        #[mechanism(gravity = -9.81 * y)]
        struct $slider {
            #[body(mass = 1.5, com = 0.1 * x, inertia = rod(1.5, 0.2, x))]
            crank: Body,
            #[body(mass = 0.8, com = 0.3 * x, inertia = rod(0.8, 0.6, x))]
            rod: Body,
            #[body(mass = 0.5)]
            piston: Body,
            #[joint(ground -> crank, about = z)]
            main: Pin,
            #[joint(crank.at(0.2 * x) -> rod, about = z)]
            big_end: Pin,
            #[joint(ground.at(0.05 * y) -> piston, along = x)]
            cylinder: Sleeve,
            #[joint(rod.at(0.6 * x) -> piston, about = z $(, branch = $branch)?)]
            small_end: Pin,
            #[output(reaction_force(cylinder))]
            wall: Vector,
            #[output(reaction_torque(cylinder))]
            tilting: Vector,
            #[output(reaction_force(small_end))]
            on_piston: Vector,
            #[output(reaction_force(big_end), resolved_in = rod)]
            on_rod: Vector,
            #[output(reaction_force(main))]
            on_crank: Vector,
        }

        /// Watt's six-bar linkage: the rocker of a four-bar linkage drives a slide by another rod.
        #[mechanism(gravity = -9.81 * y)]
        struct $six_bar {
            #[body(mass = 1, com = 0.15 * x, inertia = rod(1, 0.3, x))]
            crank: Body,
            #[body(mass = 0.7, com = 0.45 * x, inertia = rod(0.7, 0.9, x))]
            coupler: Body,
            #[body(mass = 1.2, com = 0.3 * y, inertia = rod(1.2, 0.6, y))]
            rocker: Body,
            #[body(mass = 0.5, com = 0.4 * x, inertia = rod(0.5, 0.8, x))]
            rod: Body,
            #[body(mass = 2)]
            slide: Body,
            #[joint(ground -> crank, about = z)]
            main: Pin,
            #[joint(crank.at(0.3 * x) -> coupler, about = z)]
            first: Pin,
            #[joint(ground.at(0.8 * x + 0.1 * y) -> rocker, about = z)]
            second: Pin,
            #[joint(coupler.at(0.9 * x) -> rocker.at(0.6 * y), about = z $(, branch = $branch)?)]
            closing: Pin,
            #[joint(ground.at(0.2 * y) -> slide, along = x)]
            guide: Sleeve,
            #[joint(rocker.at(0.5 * y + 0.2 * x) -> rod, about = z)]
            third: Pin,
            #[joint(slide -> rod.at(0.8 * x), about = z $(, branch = $branch)?)]
            last: Pin,
            #[output(reaction_force(closing))]
            at_closing: Vector,
            #[output(reaction_force(second))]
            on_rocker: Vector,
            #[output(reaction_force(guide))]
            on_slide: Vector,
            #[output(reaction_force(third))]
            on_rod: Vector,
            #[output(reaction_force(last), resolved_in = rod)]
            at_last: Vector,
            #[output(v(slide / ground / ground))]
            sliding: Vector,
        }
    };
}

linkages!(FourBar, Slider, SixBar);
linkages!(SolvedFourBar, SolvedSlider, SolvedSixBar, 1);

#[test]
fn eliminated_four_bar_moves_as_with_multipliers() {
    assert_eq!((SolvedFourBar::NV, FourBar::NV, FourBar::NC), (2, 4, 2));
    let (bar, solved) = (FourBar { length: 0.9 }, SolvedFourBar { length: 0.9 });
    for angle in [0.2_f64, 1.1, 2.4, 4.0, -1.3] {
        let q = SVector::from([0.3, angle]);
        // Both linkages are in the same configuration: the position of the coupler's end follows from the
        // closed form.
        let end = solved.frame_placement(frame!(SolvedFourBar, "coupler"), &q);
        let rocker = solved.frame_placement(frame!(SolvedFourBar, "rocker"), &q);
        let reached = end.transform_point(&[0.9, 0.0, 0.0].into());
        assert!((reached - rocker.transform_point(&[0.0, 0.6, 0.0].into())).norm() < 1e-14);
        let direction = end.rotation * linkwork::nalgebra::Vector3::x();
        let up = rocker.rotation * linkwork::nalgebra::Vector3::y();
        // Relative angles of the tree's joints, computed from the same frames.
        let coupler = direction.y.atan2(direction.x) - angle;
        let swing = -(up.y.atan2(up.x) - std::f64::consts::FRAC_PI_2 - 0.4);
        let all = SVector::from([0.3, angle, coupler, swing]);
        assert!(bar.constraint_residuals(&all).amax() < 1e-13);
        let v = SVector::from([-0.4, 3.0]);
        let full = bar.project_velocity(&all, &SVector::from([-0.4, 3.0, 0.0, 0.0])).expect("regular");
        let v_all = full * 1.0;
        let tau = SVector::from([0.5, 2.0]);
        let a = solved.forward_dynamics(&q, &SVector::from([full[0], full[1]]), &tau);
        let b = bar.forward_dynamics(&all, &v_all, &SVector::from([0.5, 2.0, 0.0, 0.0]));
        assert!((a[0] - b[0]).abs() < 1e-9 * (1.0 + b.amax()), "{a} and {b} at {angle}");
        assert!((a[1] - b[1]).abs() < 1e-9 * (1.0 + b.amax()), "{a} and {b} at {angle}");
        // Reactions: one linkage has them from the multipliers of the elimination, the other from the joints
        // of the closed-form solution.
        let (u, here) = (SVector::from([2.0]), SVector::from([full[0], full[1]]));
        let assert_close_vectors = |x: linkwork::nalgebra::Vector3<f64>,
                                    y: linkwork::nalgebra::Vector3<f64>| {
            assert!((x - y).norm() < 1e-9 * (1.0 + y.norm()), "{x} for {y} at {angle}");
        };
        assert_close_vectors(solved.on_crank(&q, &here, &u), bar.on_crank(&all, &v_all, &u));
        assert_close_vectors(solved.turning_crank(&q, &here, &u), bar.turning_crank(&all, &v_all, &u));
        assert_close_vectors(solved.on_coupler(&q, &here, &u), bar.on_coupler(&all, &v_all, &u));
        assert_close_vectors(solved.on_rocker(&q, &here, &u), bar.on_rocker(&all, &v_all, &u));
        assert_close_vectors(solved.at_closing(&q, &here, &u), bar.at_closing(&all, &v_all, &u));
        assert_close_vectors(solved.on_cart(&q, &here, &u), bar.on_cart(&all, &v_all, &u));
        assert_close_vectors(solved.turning_cart(&q, &here, &u), bar.turning_cart(&all, &v_all, &u));
        assert!(solved.at_closing(&q, &here, &u).norm() > 1.0);
        let energy = solved.kinetic_energy(&q, &v) + solved.potential_energy(&q);
        assert!(energy.is_finite());
        let same = SVector::from([full[0], full[1]]);
        let difference = solved.kinetic_energy(&q, &same) - bar.kinetic_energy(&all, &full);
        assert!(difference.abs() < 1e-10, "{difference}");
    }
}

#[test]
fn eliminated_slider_moves_as_with_multipliers() {
    let (slider, solved) = (Slider {}, SolvedSlider {});
    for angle in [0.2_f64, 1.1, 2.4, 4.0, -1.3] {
        let q = SVector::from([angle]);
        let rod = ((0.05 - 0.2 * angle.sin()) / 0.6_f64).asin();
        let all = SVector::from([angle, rod - angle, 0.2 * angle.cos() + 0.6 * rod.cos()]);
        assert!(slider.constraint_residuals(&all).amax() < 1e-15);
        let piston = solved.frame_placement(frame!(SolvedSlider, "piston"), &q).translation;
        assert!((piston.x - all[2]).abs() < 1e-14);
        let v = slider.project_velocity(&all, &SVector::from([5.0, 0.0, 0.0])).expect("regular");
        let a = solved.forward_dynamics(&q, &SVector::from([v[0]]), &SVector::from([1.5]));
        let b = slider.forward_dynamics(&all, &v, &SVector::from([1.5, 0.0, 0.0]));
        assert!((a[0] - b[0]).abs() < 1e-9 * (1.0 + b[0].abs()), "{a} and {b} at {angle}");
        let here = SVector::from([v[0]]);
        for (x, y) in [
            (solved.wall(&q, &here), slider.wall(&all, &v)),
            (solved.tilting(&q, &here), slider.tilting(&all, &v)),
            (solved.on_piston(&q, &here), slider.on_piston(&all, &v)),
            (solved.on_rod(&q, &here), slider.on_rod(&all, &v)),
            (solved.on_crank(&q, &here), slider.on_crank(&all, &v)),
        ] {
            assert!((x - y).norm() < 1e-9 * (1.0 + y.norm()), "{x} for {y} at {angle}");
        }
        assert!(solved.on_piston(&q, &here).norm() > 1.0);
    }
}

#[test]
fn eliminated_six_bar_has_the_forces_of_multipliers() {
    let (bar, solved) = (SixBar {}, SolvedSixBar {});
    for angle in [0.4_f64, 1.3, 2.6, 4.0] {
        let q = SVector::from([angle]);
        let [coupler, rocker, rod, slide] = [
            solved.frame_placement(frame!(SolvedSixBar, "coupler"), &q),
            solved.frame_placement(frame!(SolvedSixBar, "rocker"), &q),
            solved.frame_placement(frame!(SolvedSixBar, "rod"), &q),
            solved.frame_placement(frame!(SolvedSixBar, "slide"), &q),
        ]
        .map(|place| {
            let x = place.rotation * linkwork::nalgebra::Vector3::x();
            (x.y.atan2(x.x), place.translation.x)
        });
        let mut all = SVector::from([angle, coupler.0 - angle, rocker.0, 0.0, 0.0]);
        let order = SixBar::VELOCITIES;
        let joint_index = |name: &str| order.iter().position(|v| *v == name).expect("a joint of the tree");
        all[joint_index("guide")] = slide.1;
        all[joint_index("third")] = rod.0 - rocker.0;
        assert!(bar.constraint_residuals(&all).amax() < 1e-13, "{}", bar.constraint_residuals(&all));
        let v = bar.project_velocity(&all, &SVector::from([3.0, 0.0, 0.0, 0.0, 0.0])).expect("regular");
        let here = SVector::from([v[0]]);
        assert!((solved.sliding(&q, &here).x - v[joint_index("guide")]).abs() < 1e-12);
        let a = solved.forward_dynamics(&q, &here, &SVector::zeros());
        let b = bar.forward_dynamics(&all, &v, &SVector::zeros());
        assert!((a[0] - b[0]).abs() < 1e-9 * (1.0 + b[0].abs()), "{a} and {b} at {angle}");
        for (x, y) in [
            (solved.at_closing(&q, &here), bar.at_closing(&all, &v)),
            (solved.on_rocker(&q, &here), bar.on_rocker(&all, &v)),
            (solved.on_slide(&q, &here), bar.on_slide(&all, &v)),
            (solved.on_rod(&q, &here), bar.on_rod(&all, &v)),
            (solved.at_last(&q, &here), bar.at_last(&all, &v)),
        ] {
            assert!((x - y).norm() < 1e-9 * (1.0 + y.norm()), "{x} for {y} at {angle}");
        }
    }
}
