//! Derivatives of inverse dynamics of mechanisms with long chains of links, computed by loops of the runtime.

use linkwork::prelude::*;
use support::compare::assert_close_relative_to_largest;
use support::random::Random;

/// Chain of pins, sleeves and screws about coordinate axes and skew axes, with passive forces.
#[mechanism(gravity = 1.2 * x - 9.6 * z, derivatives, batch)]
struct ChainOfMixedJoints {
    #[body(mass = 1.43, com = [0.05, 0.06, 0.19], inertia = cuboid(1.43, 0.25, 0.28, 0.21))]
    link0: Body,
    #[joint(ground.at(0.2 * y).rotated(x(0.3)) -> link0, about = x)]
    link_joint0: Pin,
    #[body(mass = 1.47, com = [0.08, -0.08, 0.12], inertia = cuboid(1.47, 0.15, 0.21, 0.31))]
    link1: Body,
    #[joint(link0.at(-0.01 * x + 0.39 * z) -> link1, about = z)]
    link_joint1: Pin,
    #[body(mass = 0.92, com = [0.08, 0.05, 0.07], inertia = cuboid(0.92, 0.26, 0.13, 0.32))]
    link2: Body,
    #[joint(link1.at(-0.1 * x + 0.24 * z) -> link2, along = [0, -0.6, 0.8])]
    link_joint2: Sleeve,
    #[body(mass = 1.81, com = [-0.06, -0.06, 0.2], inertia = cuboid(1.81, 0.27, 0.16, 0.39))]
    link3: Body,
    #[joint(link2.at(-0.07 * x + 0.2 * z) -> link3, about = y)]
    link_joint3: Pin,
    #[body(mass = 0.81, com = [0.09, 0.04, 0.19], inertia = cuboid(0.81, 0.28, 0.16, 0.27))]
    link4: Body,
    #[joint(link3.at(0.01 * x + 0.34 * z) -> link4, about = [0.6, 0.8, 0], pitch = 0.03)]
    link_joint4: Screw,
    #[body(mass = 0.6, com = [-0.04, 0.02, 0.05], inertia = cuboid(0.6, 0.24, 0.17, 0.26))]
    link5: Body,
    #[joint(link4.at(-0.07 * x + 0.23 * z) -> link5, about = x)]
    link_joint5: Pin,
    #[body(mass = 0.97, com = [-0.0, 0.04, 0.06], inertia = cuboid(0.97, 0.3, 0.1, 0.35))]
    link6: Body,
    #[joint(link5.at(0.06 * x + 0.3 * z) -> link6, about = z)]
    link_joint6: Pin,
    #[body(mass = 1.68, com = [-0.03, 0.02, 0.05], inertia = cuboid(1.68, 0.11, 0.14, 0.39))]
    link7: Body,
    #[joint(link6.at(0.07 * x + 0.2 * z) -> link7, along = [0, -0.6, 0.8])]
    link_joint7: Sleeve,
    #[body(mass = 1.89, com = [0.09, -0.03, 0.1], inertia = cuboid(1.89, 0.2, 0.26, 0.22))]
    link8: Body,
    #[joint(link7.at(-0.06 * x + 0.35 * z) -> link8, about = y)]
    link_joint8: Pin,
    #[body(mass = 1.79, com = [-0.09, 0.09, 0.06], inertia = cuboid(1.79, 0.17, 0.22, 0.38))]
    link9: Body,
    #[joint(link8.at(0.05 * x + 0.36 * z) -> link9, about = [0.6, 0.8, 0], pitch = 0.03)]
    link_joint9: Screw,
    #[body(mass = 1.32, com = [-0.04, -0.04, 0.08], inertia = cuboid(1.32, 0.12, 0.13, 0.34))]
    link10: Body,
    #[joint(link9.at(-0.03 * x + 0.38 * z) -> link10, about = x)]
    link_joint10: Pin,
    #[body(mass = 0.57, com = [0.1, 0.01, 0.11], inertia = cuboid(0.57, 0.15, 0.22, 0.37))]
    link11: Body,
    #[joint(link10.at(0.1 * x + 0.23 * z) -> link11, about = z)]
    link_joint11: Pin,
    #[body(mass = 0.58, com = [0.08, -0.09, 0.12], inertia = cuboid(0.58, 0.27, 0.13, 0.35))]
    link12: Body,
    #[joint(link11.at(-0.01 * x + 0.28 * z) -> link12, along = [0, -0.6, 0.8])]
    link_joint12: Sleeve,
    #[acts(on = link_joint1, stiffness = 3, free_angle = 0.2)]
    spring: Spring,
    #[acts(on = link_joint7, damping = 0.4)]
    damper: Dashpot,
    #[acts(between = (ground, link9.at(0.1 * x)), stiffness = 5, free_length = 0.3)]
    cable: Spring,
}

/// Free body with a long tail.
#[mechanism(gravity = -9.81 * z, derivatives, batch)]
struct Snake {
    #[body(mass = 2, com = 0.1 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    head: Body,
    #[joint(ground -> head)]
    pose: Free,
    #[body(mass = 1.68, com = [-0.08, -0.01, 0.07], inertia = cuboid(1.68, 0.27, 0.16, 0.29))]
    part0: Body,
    #[joint(head.at(0.2 * x) -> part0, about = x)]
    part_joint0: Pin,
    #[body(mass = 1.96, com = [-0.01, -0.0, 0.16], inertia = cuboid(1.96, 0.2, 0.16, 0.28))]
    part1: Body,
    #[joint(part0.at(0.1 * x + 0.37 * z) -> part1, about = z)]
    part_joint1: Pin,
    #[body(mass = 1.98, com = [0.09, 0.03, 0.12], inertia = cuboid(1.98, 0.17, 0.12, 0.25))]
    part2: Body,
    #[joint(part1.at(-0.07 * x + 0.28 * z) -> part2, along = [0, -0.6, 0.8])]
    part_joint2: Sleeve,
    #[body(mass = 1.04, com = [0.06, 0.05, 0.15], inertia = cuboid(1.04, 0.23, 0.25, 0.27))]
    part3: Body,
    #[joint(part2.at(0.06 * x + 0.37 * z) -> part3, about = y)]
    part_joint3: Pin,
    #[body(mass = 1.23, com = [0.05, 0.04, 0.09], inertia = cuboid(1.23, 0.29, 0.23, 0.32))]
    part4: Body,
    #[joint(part3.at(0.04 * x + 0.26 * z) -> part4, about = [0.6, 0.8, 0], pitch = 0.03)]
    part_joint4: Screw,
    #[body(mass = 0.88, com = [0.03, -0.01, 0.17], inertia = cuboid(0.88, 0.23, 0.26, 0.27))]
    part5: Body,
    #[joint(part4.at(-0.1 * x + 0.31 * z) -> part5, about = x)]
    part_joint5: Pin,
    #[body(mass = 1.74, com = [-0.03, 0.07, 0.18], inertia = cuboid(1.74, 0.24, 0.3, 0.39))]
    part6: Body,
    #[joint(part5.at(0.03 * x + 0.35 * z) -> part6, about = z)]
    part_joint6: Pin,
    #[body(mass = 0.75, com = [0.07, 0.09, 0.12], inertia = cuboid(0.75, 0.24, 0.24, 0.35))]
    part7: Body,
    #[joint(part6.at(0.0 * x + 0.31 * z) -> part7, along = [0, -0.6, 0.8])]
    part_joint7: Sleeve,
    #[body(mass = 1.37, com = [0.03, -0.02, 0.14], inertia = cuboid(1.37, 0.25, 0.23, 0.34))]
    part8: Body,
    #[joint(part7.at(-0.07 * x + 0.36 * z) -> part8, about = y)]
    part_joint8: Pin,
    #[body(mass = 1.16, com = [0.03, -0.06, 0.15], inertia = cuboid(1.16, 0.23, 0.11, 0.29))]
    part9: Body,
    #[joint(part8.at(-0.09 * x + 0.23 * z) -> part9, about = [0.6, 0.8, 0], pitch = 0.03)]
    part_joint9: Screw,
    #[body(mass = 0.7, com = [-0.04, -0.06, 0.08], inertia = cuboid(0.7, 0.11, 0.19, 0.28))]
    part10: Body,
    #[joint(part9.at(-0.05 * x + 0.21 * z) -> part10, about = x)]
    part_joint10: Pin,
    #[body(mass = 0.86, com = [0.08, -0.1, 0.11], inertia = cuboid(0.86, 0.16, 0.18, 0.22))]
    part11: Body,
    #[joint(part10.at(0.02 * x + 0.32 * z) -> part11, about = z)]
    part_joint11: Pin,
    #[body(mass = 0.55, com = [0.02, -0.08, 0.13], inertia = cuboid(0.55, 0.17, 0.22, 0.39))]
    part12: Body,
    #[joint(part11.at(0.07 * x + 0.27 * z) -> part12, along = [0, -0.6, 0.8])]
    part_joint12: Sleeve,
    #[body(mass = 1.72, com = [0.03, -0.03, 0.07], inertia = cuboid(1.72, 0.22, 0.21, 0.39))]
    part13: Body,
    #[joint(part12.at(0.06 * x + 0.28 * z) -> part13, about = y)]
    part_joint13: Pin,
    #[body(mass = 1.03, com = [0.08, -0.1, 0.07], inertia = cuboid(1.03, 0.21, 0.22, 0.23))]
    part14: Body,
    #[joint(part13.at(0.09 * x + 0.32 * z) -> part14, about = [0.6, 0.8, 0], pitch = 0.03)]
    part_joint14: Screw,
    #[body(mass = 1.06, com = [-0.01, -0.05, 0.09], inertia = cuboid(1.06, 0.29, 0.18, 0.39))]
    part15: Body,
    #[joint(part14.at(0.03 * x + 0.38 * z) -> part15, about = x)]
    part_joint15: Pin,
}

/// Long stem with two different branches.
#[mechanism(gravity = -9.81 * z, derivatives, batch)]
struct Fork {
    #[body(mass = 0.89, com = [0.1, -0.0, 0.11], inertia = cuboid(0.89, 0.16, 0.3, 0.3))]
    stem0: Body,
    #[joint(ground -> stem0, about = x)]
    stem_joint0: Pin,
    #[body(mass = 0.68, com = [0.02, -0.01, 0.09], inertia = cuboid(0.68, 0.26, 0.27, 0.2))]
    stem1: Body,
    #[joint(stem0.at(-0.04 * x + 0.3 * z) -> stem1, about = z)]
    stem_joint1: Pin,
    #[body(mass = 1.9, com = [0.06, -0.05, 0.09], inertia = cuboid(1.9, 0.13, 0.3, 0.26))]
    stem2: Body,
    #[joint(stem1.at(0.01 * x + 0.25 * z) -> stem2, along = [0, -0.6, 0.8])]
    stem_joint2: Sleeve,
    #[body(mass = 1.47, com = [0.02, 0.05, 0.07], inertia = cuboid(1.47, 0.25, 0.16, 0.31))]
    stem3: Body,
    #[joint(stem2.at(0.02 * x + 0.29 * z) -> stem3, about = y)]
    stem_joint3: Pin,
    #[body(mass = 1.29, com = [-0.01, -0.03, 0.16], inertia = cuboid(1.29, 0.22, 0.11, 0.25))]
    stem4: Body,
    #[joint(stem3.at(-0.03 * x + 0.26 * z) -> stem4, about = [0.6, 0.8, 0], pitch = 0.03)]
    stem_joint4: Screw,
    #[body(mass = 1.83, com = [0.01, -0.1, 0.17], inertia = cuboid(1.83, 0.19, 0.22, 0.34))]
    stem5: Body,
    #[joint(stem4.at(-0.01 * x + 0.38 * z) -> stem5, about = x)]
    stem_joint5: Pin,
    #[body(mass = 1.87, com = [-0.02, -0.02, 0.18], inertia = cuboid(1.87, 0.14, 0.16, 0.37))]
    stem6: Body,
    #[joint(stem5.at(0.03 * x + 0.3 * z) -> stem6, about = z)]
    stem_joint6: Pin,
    #[body(mass = 1.54, com = [-0.01, -0.04, 0.17], inertia = cuboid(1.54, 0.28, 0.13, 0.3))]
    stem7: Body,
    #[joint(stem6.at(-0.09 * x + 0.37 * z) -> stem7, along = [0, -0.6, 0.8])]
    stem_joint7: Sleeve,
    #[body(mass = 1.0, com = [-0.07, 0.02, 0.17], inertia = cuboid(1.0, 0.11, 0.15, 0.36))]
    stem8: Body,
    #[joint(stem7.at(0.01 * x + 0.3 * z) -> stem8, about = y)]
    stem_joint8: Pin,
    #[body(mass = 0.54, com = [0.04, 0.1, 0.2], inertia = cuboid(0.54, 0.24, 0.11, 0.37))]
    stem9: Body,
    #[joint(stem8.at(0.06 * x + 0.33 * z) -> stem9, about = [0.6, 0.8, 0], pitch = 0.03)]
    stem_joint9: Screw,
    #[body(mass = 1.93, com = [0.04, -0.07, 0.09], inertia = cuboid(1.93, 0.28, 0.13, 0.32))]
    stem10: Body,
    #[joint(stem9.at(-0.06 * x + 0.33 * z) -> stem10, about = x)]
    stem_joint10: Pin,
    #[body(mass = 0.7, com = 0.1 * x, inertia = cuboid(0.7, 0.2, 0.1, 0.1))]
    left: Body,
    #[joint(stem10.at(0.2 * z + 0.1 * y) -> left, about = x)]
    left_joint: Pin,
    #[body(mass = 0.8, com = 0.1 * y, inertia = cuboid(0.8, 0.1, 0.2, 0.1))]
    right: Body,
    #[joint(stem10.at(0.2 * z - 0.1 * y) -> right, about = [0.6, 0, 0.8])]
    right_joint: Pin,
    #[body(mass = 0.4, com = 0.1 * y, inertia = cuboid(0.4, 0.1, 0.2, 0.1))]
    tip: Body,
    #[joint(right.at(0.2 * y) -> tip, along = z)]
    tip_joint: Sleeve,
}

/// Compares the derivatives of a mechanism with central differences, with those of several states, which are
/// computed without loops, and with those that are written to matrices.
macro_rules! check_derivatives {
    ($mechanism:expr, $type:ident) => {{
        type Square = SMatrix<f64, { $type::NV }, { $type::NV }>;
        let m = $mechanism;
        let mut random = Random::new(7);
        for _ in 0..3 {
            let q = random.random_configuration(&m);
            let (v, a) = (random.random_vector(1.0), random.random_vector(1.0));
            let (by_q, by_v) = m.inverse_dynamics_derivatives(&q, &v, &a);
            let step = 1e-5;
            for j in 0..$type::NV {
                let mut d = SVector::<f64, { $type::NV }>::zeros();
                d[j] = step;
                let tau = |d: &SVector<f64, { $type::NV }>| m.inverse_dynamics(&m.integrate(&q, d), &v, &a);
                let expected = (tau(&d) - tau(&-d)) / (2.0 * step);
                assert_close_relative_to_largest(
                    "∂τ/∂q",
                    by_q.column(j).clone_owned().as_slice(),
                    expected.as_slice(),
                    1e-7,
                );
                let tau = |v: &SVector<f64, { $type::NV }>| m.inverse_dynamics(&q, v, &a);
                let expected = (tau(&(v + d)) - tau(&(v - d))) / (2.0 * step);
                assert_close_relative_to_largest(
                    "∂τ/∂v",
                    by_v.column(j).clone_owned().as_slice(),
                    expected.as_slice(),
                    1e-7,
                );
            }
            let (mut into_q, mut into_v) = (Square::zeros(), Square::zeros());
            m.inverse_dynamics_derivatives_into(&q, &v, &a, &mut into_q, &mut into_v);
            assert_eq!((into_q, into_v), (by_q, by_v));

            let (q, v, a) = (q.map(f64x4::splat), v.map(f64x4::splat), a.map(f64x4::splat));
            let (lanes_q, lanes_v) = m.inverse_dynamics_derivatives_lanes(&q, &v, &a);
            let first = |x: f64x4| x[0];
            assert_close_relative_to_largest(
                "∂τ/∂q, by lanes",
                by_q.as_slice(),
                lanes_q.map(first).as_slice(),
                1e-12,
            );
            assert_close_relative_to_largest(
                "∂τ/∂v, by lanes",
                by_v.as_slice(),
                lanes_v.map(first).as_slice(),
                1e-12,
            );
        }
    }};
}

#[test]
fn a_chain_with_passive_forces_has_the_derivatives_of_its_inverse_dynamics() {
    check_derivatives!(ChainOfMixedJoints {}, ChainOfMixedJoints);
}

#[test]
fn a_free_chain_has_the_derivatives_of_its_inverse_dynamics() {
    check_derivatives!(Snake {}, Snake);
}

#[test]
fn a_branching_chain_has_the_derivatives_of_its_inverse_dynamics() {
    check_derivatives!(Fork {}, Fork);
}
