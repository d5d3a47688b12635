//! Loops that are solved in closed form, against the same linkages with multipliers.

use linkwork::prelude::*;

/// A linkage twice: `$branch` is empty, or names the branch of the closed form.
macro_rules! linkages {
    ($four_bar:ident, $slider:ident $(, $branch:expr)?) => {
        /// A four-bar linkage on a cart, with joints placed on turned axes.
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
        }
    };
}

linkages!(FourBar, Slider);
linkages!(SolvedFourBar, SolvedSlider, 1);

#[test]
fn a_solved_four_bar_moves_as_with_multipliers() {
    assert_eq!((SolvedFourBar::NV, FourBar::NV, FourBar::NC), (2, 4, 2));
    let (bar, solved) = (FourBar { length: 0.9 }, SolvedFourBar { length: 0.9 });
    for angle in [0.2_f64, 1.1, 2.4, 4.0, -1.3] {
        let q = SVector::from([0.3, angle]);
        // The same configuration: the coupler's end is where the closed form has it.
        let end = solved.frame_placement(frame!(SolvedFourBar, "coupler"), &q);
        let rocker = solved.frame_placement(frame!(SolvedFourBar, "rocker"), &q);
        let reached = end.transform_point(&[0.9, 0.0, 0.0].into());
        assert!((reached - rocker.transform_point(&[0.0, 0.6, 0.0].into())).norm() < 1e-14);
        let direction = end.rotation * linkwork::nalgebra::Vector3::x();
        let up = rocker.rotation * linkwork::nalgebra::Vector3::y();
        // Relative angles of the tree, from the same frames.
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
        let energy = solved.kinetic_energy(&q, &v) + solved.potential_energy(&q);
        assert!(energy.is_finite());
        let same = SVector::from([full[0], full[1]]);
        let difference = solved.kinetic_energy(&q, &same) - bar.kinetic_energy(&all, &full);
        assert!(difference.abs() < 1e-10, "{difference}");
    }
}

#[test]
fn a_solved_slider_moves_as_with_multipliers() {
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
    }
}
