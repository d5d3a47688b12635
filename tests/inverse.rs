//! Inverse of the mass matrix, and derivatives that use it, for mechanisms that are large enough to be
//! evaluated in loops.

use linkwork::prelude::*;
use support::compare::assert_close_relative_to_largest;
use support::random::Random;

/// Chain of bodies on ball joints and pins, without branches.
#[mechanism(gravity = -9.81 * z, derivatives, packed)]
struct UnbranchedChain {
    #[body(mass = 3, com = 0.2 * x, inertia = cuboid(3, 0.4, 0.3, 0.2))]
    a: Body,
    #[joint(ground -> a)]
    root: Ball,
    #[body(mass = 2, com = 0.2 * x, inertia = cylinder(2, 0.1, 0.4, x))]
    b: Body,
    #[joint(a.at(0.4 * x) -> b)]
    first: Ball,
    #[body(mass = 1, com = 0.2 * x, inertia = cylinder(1, 0.1, 0.4, x))]
    c: Body,
    #[joint(b.at(0.4 * x) -> c)]
    second: Ball,
    #[body(mass = 0.5, com = 0.1 * x, inertia = cylinder(0.5, 0.1, 0.3, x))]
    d: Body,
    #[joint(c.at(0.4 * x) -> d)]
    third: Ball,
    #[body(mass = 0.4, com = 0.1 * x, inertia = cylinder(0.4, 0.1, 0.3, x))]
    e: Body,
    #[joint(d.at(0.3 * x) -> e)]
    fourth: Ball,
}

/// Three different arms whose links are declared in turn, so that the velocities of an arm are not adjacent.
/// The tail does not move with the neck.
#[mechanism(gravity = -9.81 * z, derivatives, packed)]
struct ThreeInterleavedArms {
    #[body(mass = 5, com = 0.1 * x + 0.1 * z, inertia = cuboid(5, 0.4, 0.3, 0.2))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[body(mass = 1, com = 0.2 * x, inertia = cylinder(1, 0.1, 0.4, x))]
    left: Body,
    #[body(mass = 2, com = 0.1 * z, inertia = cuboid(2, 0.1, 0.2, 0.3))]
    head: Body,
    #[joint(hull.at(0.2 * z) -> head, about = y)]
    neck: Pin,
    #[joint(head.at(0.3 * y) -> left)]
    left_first: Ball,
    #[body(mass = 1, com = 0.2 * x, inertia = cylinder(1, 0.1, 0.4, x))]
    right: Body,
    #[joint(head.at(-0.3 * y) -> right)]
    right_first: Ball,
    #[body(mass = 1.5, com = 0.3 * x, inertia = cylinder(1.5, 0.1, 0.6, x))]
    tail: Body,
    #[joint(hull.at(-0.3 * x) -> tail)]
    tail_first: Ball,
    #[body(mass = 0.8, com = 0.2 * x, inertia = cylinder(0.8, 0.1, 0.4, x))]
    left_middle: Body,
    #[joint(left.at(0.4 * x) -> left_middle)]
    left_second: Ball,
    #[body(mass = 0.8, com = 0.2 * x, inertia = cylinder(0.8, 0.1, 0.4, x))]
    right_middle: Body,
    #[joint(right.at(0.4 * x) -> right_middle)]
    right_second: Ball,
    #[body(mass = 0.7, com = 0.2 * x, inertia = cylinder(0.7, 0.1, 0.4, x))]
    tail_middle: Body,
    #[joint(tail.at(0.6 * x) -> tail_middle)]
    tail_second: Ball,
    #[body(mass = 0.3, com = 0.1 * x, inertia = cylinder(0.3, 0.1, 0.2, x))]
    left_tip: Body,
    #[joint(left_middle.at(0.4 * x) -> left_tip, about = y)]
    left_third: Pin,
}

/// Two identical arms at the end of a long neck.
#[mechanism(gravity = -9.81 * z, derivatives, packed)]
struct TwoArmsOnLongNeck {
    #[body(mass = 5, com = 0.1 * x + 0.1 * z, inertia = cuboid(5, 0.4, 0.3, 0.2))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[body(mass = 1, com = 0.1 * z, inertia = cylinder(1, 0.1, 0.2, z))]
    neck: Body,
    #[joint(hull.at(0.2 * z) -> neck)]
    first: Ball,
    #[body(mass = 1, com = 0.1 * z, inertia = cylinder(1, 0.1, 0.2, z))]
    throat: Body,
    #[joint(neck.at(0.2 * z) -> throat)]
    second: Ball,
    #[body(mass = 2, com = 0.1 * z, inertia = cuboid(2, 0.1, 0.2, 0.3))]
    head: Body,
    #[joint(throat.at(0.2 * z) -> head, about = y)]
    third: Pin,
    #[body(mass = 1, com = 0.2 * x, inertia = cylinder(1, 0.1, 0.4, x))]
    left: Body,
    #[joint(head.at(0.3 * y) -> left)]
    left_first: Ball,
    #[body(mass = 1, com = 0.2 * x, inertia = cylinder(1, 0.1, 0.4, x))]
    right: Body,
    #[joint(head.at(-0.3 * y) -> right)]
    right_first: Ball,
    #[body(mass = 0.8, com = 0.2 * x, inertia = cylinder(0.8, 0.1, 0.4, x))]
    left_tip: Body,
    #[joint(left.at(0.4 * x) -> left_tip)]
    left_second: Ball,
    #[body(mass = 0.8, com = 0.2 * x, inertia = cylinder(0.8, 0.1, 0.4, x))]
    right_tip: Body,
    #[joint(right.at(0.4 * x) -> right_tip)]
    right_second: Ball,
}

/// Checks the inverse mass matrix and acceleration derivatives against the equations of motion: `M⁻¹ M` is
/// the identity, and derivatives of `v̇` are `−M⁻¹` times those of `M v̇ + h` with `v̇` fixed.
macro_rules! solve_the_equations {
    ($test:ident, $m:ident, $nv:literal) => {
        #[test]
        fn $test() {
            let mut random = Random::new(41);
            type Square = SMatrix<f64, $nv, $nv>;
            let mut given = [Square::zeros(); 3];
            for case in 0..20 {
                let [dq, v, tau] = [(); 3].map(|()| random.random_vector::<$nv>(2.0));
                let q = $m.integrate(&$m.neutral(), &dq);
                let mass = $m.mass_matrix(&q);
                let assert_close_matrices = |what: &str, found: &Square, expected: &Square| {
                    assert_close_relative_to_largest(
                        &format!("case {case}: {what}"),
                        found.as_slice(),
                        expected.as_slice(),
                        1e-10,
                    );
                };
                assert_close_matrices("M⁻¹ M", &($m.mass_matrix_inverse(&q) * mass), &Square::identity());
                let (by_q, by_v, inverse) = $m.forward_dynamics_derivatives(&q, &v, &tau);
                assert_close_matrices("∂v̇/∂τ M", &(inverse * mass), &Square::identity());
                let a = $m.forward_dynamics(&q, &v, &tau);
                let (forces_by_q, forces_by_v) = $m.inverse_dynamics_derivatives(&q, &v, &a);
                assert_close_matrices("M ∂v̇/∂q", &(mass * by_q), &-forces_by_q);
                assert_close_matrices("M ∂v̇/∂v", &(mass * by_v), &-forces_by_v);
                let [into_q, into_v, into] = &mut given;
                let with_derivatives =
                    $m.forward_dynamics_derivatives_into(&q, &v, &tau, into_q, into_v, into);
                assert_close_relative_to_largest("v̇", with_derivatives.as_slice(), a.as_slice(), 1e-10);
                assert!(given == [by_q, by_v, inverse], "case {case}");
            }
        }
    };
}

solve_the_equations!(a_chain, UnbranchedChain, 15);
solve_the_equations!(limbs_declared_in_turns, ThreeInterleavedArms, 26);
solve_the_equations!(limbs_alike_on_a_long_trunk, TwoArmsOnLongNeck, 25);
