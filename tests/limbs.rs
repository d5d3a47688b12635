//! Mechanisms with identical limbs, which are evaluated as SIMD lanes. The generated functions are consistent
//! with each other for every scalar type, on the ground and on a free base, and with parameters shared by all
//! limbs or of single limbs.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Lanes, Mechanism, Real, mechanism};
use support::random::Random;

/// Body on four legs of two joints, mirrored front to back and left to right.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct Quadruped<T> {
    trunk_mass: T,
    thigh_mass: T,
    shank_mass: T,
    length: T,
    damping: T,
    load: T,

    #[body(mass = trunk_mass, inertia = cuboid(trunk_mass, 4 * length, 2 * length, length))]
    trunk: Body,
    #[joint(ground -> trunk)]
    base: Free,

    #[body(mass = thigh_mass, com = [0.01, 0.02, -length / 2], inertia = rod(thigh_mass, length, z))]
    thigh_a: Body,
    #[body(mass = shank_mass, com = [0.01, 0, -length / 2], inertia = rod(shank_mass, length, z))]
    shank_a: Body,
    #[joint(trunk.at([2 * length, length, 0]) -> thigh_a, about = x)]
    hip_a: Pin,
    #[joint(thigh_a.at([0, 0.03, -length]) -> shank_a, about = y)]
    knee_a: Pin,
    #[acts(on = knee_a, damping = damping)]
    friction_a: Dashpot,

    #[body(mass = thigh_mass, com = [0.01, -0.02, -length / 2], inertia = rod(thigh_mass, length, z))]
    thigh_b: Body,
    #[body(mass = shank_mass, com = [0.01, 0, -length / 2], inertia = rod(shank_mass, length, z))]
    shank_b: Body,
    #[joint(trunk.at([2 * length, -length, 0]) -> thigh_b, about = -x)]
    hip_b: Pin,
    #[joint(thigh_b.at([0, -0.03, -length]) -> shank_b, about = y)]
    knee_b: Pin,
    #[acts(on = knee_b, damping = damping)]
    friction_b: Dashpot,

    #[body(mass = thigh_mass, com = [-0.01, 0.02, -length / 2], inertia = rod(thigh_mass, length, z))]
    thigh_c: Body,
    #[body(mass = shank_mass, com = [-0.01, 0, -length / 2], inertia = rod(shank_mass, length, z))]
    shank_c: Body,
    #[joint(trunk.at([-2 * length, length, 0]) -> thigh_c, about = x)]
    hip_c: Pin,
    #[joint(thigh_c.at([0, 0.03, -length]) -> shank_c, about = y)]
    knee_c: Pin,
    #[acts(on = knee_c, damping = damping)]
    friction_c: Dashpot,

    /// Upper segment of the fourth leg, whose shank is heavier than those of the other legs.
    #[body(mass = thigh_mass, com = [-0.01, -0.02, -length / 2], inertia = rod(thigh_mass, length, z))]
    thigh_d: Body,
    #[body(mass = load, com = [-0.01, 0, -length / 2], inertia = rod(load, length, z))]
    shank_d: Body,
    #[joint(trunk.at([-2 * length, -length, 0]) -> thigh_d, about = -x)]
    hip_d: Pin,
    #[joint(thigh_d.at([0, -0.03, -length]) -> shank_d, about = y)]
    knee_d: Pin,
    #[acts(on = knee_d, damping = damping)]
    friction_d: Dashpot,
}

/// Gripper whose three fingers are fixed to the ground, in single precision.
#[mechanism(gravity = -9.81 * z)]
struct Gripper {
    mass: f32,

    #[body(mass = mass, com = 0.05 * x, inertia = rod(mass, 0.1, x))]
    left: Body,
    #[joint(ground.at(0.1 * x).rotated(z(0.2)) -> left, about = y)]
    open_left: Pin,
    #[body(mass = 0.1, com = 0.02 * z, inertia = rod(0.1, 0.04, z))]
    left_tip: Body,
    #[joint(left.at(0.1 * x) -> left_tip, about = y)]
    bend_left: Pin,

    #[body(mass = mass, com = 0.05 * x, inertia = rod(mass, 0.1, x))]
    right: Body,
    #[joint(ground.at(0.1 * y).rotated(z(2.1)) -> right, about = y)]
    open_right: Pin,
    #[body(mass = 0.1, com = 0.02 * z, inertia = rod(0.1, 0.04, z))]
    right_tip: Body,
    #[joint(right.at(0.1 * x) -> right_tip, about = y)]
    bend_right: Pin,

    #[body(mass = mass, com = 0.05 * x, inertia = rod(mass, 0.1, x))]
    thumb: Body,
    #[joint(ground.at(-0.1 * y).rotated(z(-2.1)) -> thumb, about = y)]
    open_thumb: Pin,
    #[body(mass = 0.2, com = 0.02 * z, inertia = rod(0.2, 0.04, z))]
    thumb_tip: Body,
    #[joint(thumb.at(0.1 * x) -> thumb_tip, about = y)]
    bend_thumb: Pin,
}

fn sample_quadruped<T: Real>() -> Quadruped<T> {
    let number = linkwork::nalgebra::convert::<f64, T>;
    Quadruped {
        trunk_mass: number(8.0),
        thigh_mass: number(1.5),
        shank_mass: number(0.6),
        length: number(0.3),
        damping: number(0.2),
        load: number(0.9),
    }
}

/// Returns a random configuration, velocity and acceleration of the quadruped.
fn random_state(random: &mut Random) -> (SVector<f64, 15>, [SVector<f64, 14>; 2]) {
    (random.random_configuration(&sample_quadruped()), [random.random_vector(2.0), random.random_vector(2.0)])
}

#[test]
fn limb_lanes_give_equal_functions() {
    let (robot, mut random) = (sample_quadruped::<f64>(), Random::new(7));
    for _ in 0..20 {
        let (q, [v, a]) = random_state(&mut random);
        let (m, h) = (robot.mass_matrix(&q), robot.bias_forces(&q, &v));
        let tau = robot.inverse_dynamics(&q, &v, &a);
        assert!((m * a + h - tau).amax() < 1e-12 * (1.0 + tau.amax()));
        assert!((robot.forward_dynamics(&q, &v, &tau) - a).amax() < 1e-10);
        // Dashpot forces are odd in the velocities, Coriolis forces even.
        let (c, back, weight) = (
            robot.coriolis_matrix(&q, &v),
            robot.bias_forces(&q, &-v),
            robot.bias_forces(&q, &SVector::zeros()),
        );
        assert!((c * v - ((h + back) / 2.0 - weight)).amax() < 1e-11 * (1.0 + h.amax()));
        // Energies and momenta are not evaluated in lanes.
        assert!((v.dot(&(m * v)) / 2.0 - robot.kinetic_energy(&q, &v)).abs() < 1e-12);
        assert!((m * v - robot.generalized_momentum(&q, &v)).amax() < 1e-12);
    }
}

/// Returns the derivatives of `f` by differences, a column for each velocity.
fn difference_columns(f: impl Fn(f64, &SVector<f64, 14>) -> SVector<f64, 14>) -> SMatrix<f64, 14, 14> {
    const STEP: f64 = 1e-6;
    let difference_column = |k: usize| {
        let axis = SVector::from_fn(|i, _| f64::from(u8::from(i == k)));
        (f(STEP, &axis) - f(-STEP, &axis)) / (2.0 * STEP)
    };
    SMatrix::from_columns(&std::array::from_fn::<_, 14, _>(difference_column))
}

#[test]
fn limb_derivatives_agree_with_finite_differences() {
    let (robot, mut random) = (sample_quadruped::<f64>(), Random::new(5));
    let is_close =
        |x: &SMatrix<f64, 14, 14>, y: &SMatrix<f64, 14, 14>| (x - y).amax() < 1e-7 * (1.0 + y.amax());
    for _ in 0..5 {
        let (q, [v, a]) = random_state(&mut random);
        let displaced_configuration =
            |step: f64, axis: &SVector<f64, 14>| robot.integrate(&q, &(axis * step));
        let tau = robot.inverse_dynamics(&q, &v, &a);
        let (by_q, by_v) = robot.inverse_dynamics_derivatives(&q, &v, &a);
        assert!(is_close(
            &by_q,
            &difference_columns(|h, axis| robot.inverse_dynamics(&displaced_configuration(h, axis), &v, &a))
        ));
        assert!(is_close(
            &by_v,
            &difference_columns(|h, axis| robot.inverse_dynamics(&q, &(v + axis * h), &a))
        ));
        let (by_q, by_v, inverse) = robot.forward_dynamics_derivatives(&q, &v, &tau);
        assert!(is_close(
            &by_q,
            &difference_columns(|h, axis| robot.forward_dynamics(
                &displaced_configuration(h, axis),
                &v,
                &tau
            ))
        ));
        assert!(is_close(
            &by_v,
            &difference_columns(|h, axis| robot.forward_dynamics(&q, &(v + axis * h), &tau))
        ));
        assert!(is_close(&(inverse * robot.mass_matrix(&q)), &SMatrix::identity()));
        assert!(is_close(&robot.mass_matrix_inverse(&q), &inverse));
    }
}

#[test]
fn limb_lanes_agree_for_every_scalar_type() {
    let mut random = Random::new(11);
    let (double, single) = (sample_quadruped::<f64>(), sample_quadruped::<f32>());
    let lanes = sample_quadruped::<Lanes<f64, 2>>();
    for _ in 0..20 {
        let (q, [v, a]) = random_state(&mut random);
        let (tau, m) = (double.inverse_dynamics(&q, &v, &a), double.mass_matrix(&q));
        let (q32, v32, a32) = (q.map(|x| x as f32), v.map(|x| x as f32), a.map(|x| x as f32));
        let is_close = |x: f32, y: f64, scale: f64| (f64::from(x) - y).abs() < 2e-5 * (1.0 + scale);
        let found = single.inverse_dynamics(&q32, &v32, &a32);
        assert!(found.iter().zip(&tau).all(|(x, y)| is_close(*x, *y, tau.amax())));
        assert!(single.mass_matrix(&q32).iter().zip(&m).all(|(x, y)| is_close(*x, *y, m.amax())));
        let [q2, v2, a2] = [q.as_slice(), v.as_slice(), a.as_slice()].map(<[f64]>::to_vec);
        let entry_in_both_lanes = |x: &[f64], k: usize| Lanes([x[k], x[k]]);
        let found = lanes.inverse_dynamics(
            &SVector::from_fn(|k, _| entry_in_both_lanes(&q2, k)),
            &SVector::from_fn(|k, _| entry_in_both_lanes(&v2, k)),
            &SVector::from_fn(|k, _| entry_in_both_lanes(&a2, k)),
        );
        assert!(found.iter().zip(&tau).all(|(x, y)| x[0] == *y && x[1] == *y));
    }
}

#[test]
fn three_finger_lanes_agree() {
    let (gripper, mut random) = (Gripper { mass: 0.3 }, Random::new(3));
    for _ in 0..20 {
        let mut vector = || SVector::<f32, 6>::from_fn(|_, _| random.uniform_number(1.5) as f32);
        let (q, v, a) = (vector(), vector(), vector());
        let (m, tau) = (gripper.mass_matrix(&q), gripper.inverse_dynamics(&q, &v, &a));
        assert!((m * a + gripper.bias_forces(&q, &v) - tau).amax() < 1e-6);
        assert!((v.dot(&(m * v)) / 2.0 - Mechanism::kinetic_energy(&gripper, 0.0, &q, &v)).abs() < 1e-6);
        // The inertia of one finger does not couple to another.
        assert!((0..2).all(|i| (2..6).all(|j| m[(i, j)] == 0.0)));
        assert!((gripper.forward_dynamics(&q, &v, &tau) - a).amax() < 1e-3);
    }
}

/// Identical carts with a spring between two of them: no corresponding force acts on the third.
#[mechanism(gravity = -9.81 * z)]
struct CartsWithOneSpring {
    #[body(mass = 1)]
    a: Body,
    #[joint(ground -> a, along = x)]
    rail_a: Sleeve,
    #[body(mass = 2)]
    b: Body,
    #[joint(ground -> b, along = x)]
    rail_b: Sleeve,
    #[body(mass = 3)]
    c: Body,
    #[joint(ground -> c, along = x)]
    rail_c: Sleeve,
    #[acts(between = (a, b.at(2 * x)), stiffness = 5, free_length = 1)]
    buffer: Spring,
}

#[test]
fn spring_between_two_of_three_carts_acts_on_those() {
    let (m, mut random) = (CartsWithOneSpring {}, Random::new(5));
    for _ in 0..20 {
        let (q, v): (SVector<f64, 3>, _) = (random.random_vector(0.5), random.random_vector(1.0));
        let pull = 5.0 * (q[1] + 2.0 - q[0] - 1.0);
        let expected = SVector::from([-pull, pull, 0.0]);
        assert!((m.bias_forces(&q, &v) - expected).amax() < 1e-12);
        let a = m.forward_dynamics(&q, &v, &SVector::zeros());
        assert!((a - SVector::from([pull, -pull / 2.0, 0.0])).amax() < 1e-12);
    }
}

/// Declares a hand of three fingers with elements between them. It is declared once with and once without
/// passes of the compiler over the model.
macro_rules! hand {
    ($name:ident, $($options:tt)*) => {
        #[mechanism(gravity = -9.81 * z $($options)*)]
        struct $name {
            #[body(mass = 2, com = 0.1 * z, inertia = cuboid(2, 0.3, 0.2, 0.1))]
            palm: Body,
            #[joint(ground -> palm, about = unit(x + z))]
            wrist: Pin,
            #[body(mass = 0.3, com = 0.05 * x, inertia = rod(0.3, 0.1, x))]
            left: Body,
            #[joint(palm.at(0.1 * x).rotated(z(0.2)) -> left, about = y)]
            open_left: Pin,
            #[body(mass = 0.1, com = 0.02 * z, inertia = rod(0.1, 0.04, z))]
            left_tip: Body,
            #[joint(left.at(0.1 * x) -> left_tip, about = y)]
            bend_left: Pin,
            #[body(mass = 0.3, com = 0.05 * x, inertia = rod(0.3, 0.1, x))]
            right: Body,
            #[joint(palm.at(0.1 * y).rotated(z(2.1)) -> right, about = y)]
            open_right: Pin,
            #[body(mass = 0.1, com = 0.02 * z, inertia = rod(0.1, 0.04, z))]
            right_tip: Body,
            #[joint(right.at(0.1 * x) -> right_tip, about = y)]
            bend_right: Pin,
            #[body(mass = 0.4, com = 0.05 * x, inertia = rod(0.4, 0.1, x))]
            thumb: Body,
            #[joint(palm.at(-0.1 * y).rotated(z(-2.1)) -> thumb, about = y)]
            open_thumb: Pin,
            #[body(mass = 0.2, com = 0.02 * z, inertia = rod(0.2, 0.04, z))]
            thumb_tip: Body,
            #[joint(thumb.at(0.1 * x) -> thumb_tip, about = y)]
            bend_thumb: Pin,
            #[acts(
                between = (left_tip.at(0.04 * z), right_tip.at(0.04 * z)), stiffness = 20, free_length = 0.1
            )]
            band: Spring,
            #[acts(between = (thumb_tip.at(0.04 * z), ground.at(0.3 * x)), damping = 2)]
            cord: Dashpot,
            #[energy(pow(open_left - open_right, 2) * 0.3)]
            web: Potential,
        }
    };
}

hand!(Hand,);
hand!(PlainHand, , skip_passes = [frames, regroup, parallel, limbs]);

#[test]
fn springs_between_limbs_act_with_and_without_passes() {
    support::compare::assert_same_dynamics(&Hand {}, &PlainHand {}, 20, 1e-11);
}

/// Arm whose angles and positions have rounding noise of an exporter: nearly parallel axes, offsets of nearly
/// zero length, and centres of mass close to axes.
macro_rules! noisy {
    ($name:ident, $($options:tt)*) => {
        #[mechanism(gravity = -9.81 * z $($options)*)]
        struct $name {
            #[body(mass = 3, com = [2e-16, 1e-17, 0.2], inertia = diagonal(0.05, 0.05, 0.01))]
            a: Body,
            #[joint(ground.at([0, 0, 0.3]).rotated(x(1e-15)) -> a, about = z)]
            first: Pin,
            #[body(mass = 2, com = [3e-17, 0.1, 0.03], inertia = diagonal(0.02, 0.01, 0.02).rotated(x(0.3)))]
            b: Body,
            #[joint(a.at([1e-9, 0.1, 0.4]).rotated(x(3e-15), y(-2e-15)) -> b, about = z)]
            second: Pin,
            #[body(
                mass = 1, com = [1e-12, 2e-13, 0.03], inertia = diagonal(0.02, 0.01, 0.02).rotated(y(0.3))
            )]
            c: Body,
            #[joint(b.at([0.2, 1e-16, 0.1]).rotated(y(1.3e-8), x(4e-9)) -> c, about = z)]
            third: Pin,
            #[body(mass = 0.1, com = [0.01, 0, 0.02], inertia = diagonal(2e-5, 1e-5, 2e-5))]
            d: Body,
            #[joint(c.at([0.02, -1e-3, 0.05]).rotated(x(1.5707963), z(2e-7)) -> d, about = z)]
            fourth: Pin,
            #[body(mass = 0.05, com = [0.01, 1e-18, 0], inertia = diagonal(1e-6, 2e-6, 2e-6))]
            e: Body,
            #[joint(d.at([0.03, 1e-10, 2e-9]).rotated(y(7e-12)) -> e, about = z)]
            fifth: Pin,
        }
    };
}

noisy!(NoisyArm,);
noisy!(NoisyPlainArm, , skip_passes = [frames, regroup, parallel]);

#[test]
fn coefficient_noise_costs_no_accuracy() {
    support::compare::assert_same_dynamics(&NoisyArm {}, &NoisyPlainArm {}, 50, 1e-11);
}
