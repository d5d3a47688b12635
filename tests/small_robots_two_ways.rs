//! Robots of `models/urdf` and the same robots in the struct language have the same equations.

use linkwork::{frame, mechanism};
use support::compare::{assert_close, assert_same_dynamics};
use support::random::Random;
use support::robots::{CartPole as CartPoleFile, DoublePendulum as DoublePendulumFile, Ur5 as Ur5File};

const TOLERANCE: f64 = 1e-12;

#[mechanism(gravity = -9.81 * z)]
struct CartPole {
    #[body(mass = 1.0, inertia = diagonal(0.004, 0.003, 0.005))]
    cart: Body,
    #[body(
        mass = 0.1, com = [0.01, 0, 0.5], inertia = [[0.0085, 0, 0.0001], [0, 0.0084, 0], [0.0001, 0, 0.0002]]
    )]
    pole: Body,
    #[joint(ground.at(0.2 * z) -> cart, along = x)]
    slide: Sleeve,
    #[joint(cart.at(0.05 * z) -> pole, about = y)]
    swing: Pin,
    #[acts(on = slide)]
    drive: Force,
    #[acts(on = swing)]
    motor: Torque,
}

#[mechanism(gravity = -9.81 * z)]
struct DoublePendulum {
    #[body(mass = 0.1, inertia = diagonal(1, 1, 1))]
    base_link: Body,
    #[body(mass = 0.2, com = 0.05 * z, inertia = diagonal(0.000177083, 0.000177083, 0.000020833))]
    link1: Body,
    #[body(mass = 0.3, com = 0.1 * z, inertia = diagonal(0.001015625, 0.001015625, 0.002))]
    link2: Body,
    #[body]
    link3: Body,
    #[joint(ground -> base_link)]
    base: Weld,
    #[joint(base_link.at(0.025 * x) -> link1, about = x)]
    joint1: Pin,
    #[joint(link1.at(0.0125 * x + 0.1 * z) -> link2, about = x)]
    joint2: Pin,
    #[joint(link2.at(0.2 * z) -> link3)]
    joint3: Weld,
    #[acts(on = joint1)]
    motor1: Torque,
    #[acts(on = joint2)]
    motor2: Torque,
}

/// UR5 arm in the struct language, with right angles rounded as in its URDF file.
#[mechanism(gravity = -9.81 * z)]
struct Ur5 {
    #[body(mass = 4, inertia = [[0.00443333156, 0, 0], [0, 0.00443333156, 0], [0, 0, 0.0072]])]
    base_link: Body,
    #[body]
    base: Body,
    #[body(mass = 3.7, inertia = [[0.010267495893, 0, 0], [0, 0.010267495893, 0], [0, 0, 0.00666]])]
    shoulder_link: Body,
    #[body(
        mass = 8.393, com = 0.28 * z,
        inertia = [[0.22689067591, 0, 0], [0, 0.22689067591, 0], [0, 0, 0.0151074]]
    )]
    upper_arm_link: Body,
    #[body(
        mass = 2.275, com = 0.25 * z,
        inertia = [[0.049443313556, 0, 0], [0, 0.049443313556, 0], [0, 0, 0.004095]]
    )]
    forearm_link: Body,
    #[body(mass = 1.219, inertia = [[0.111172755531, 0, 0], [0, 0.111172755531, 0], [0, 0, 0.21942]])]
    wrist_1_link: Body,
    #[body(mass = 1.219, inertia = [[0.111172755531, 0, 0], [0, 0.111172755531, 0], [0, 0, 0.21942]])]
    wrist_2_link: Body,
    #[body(mass = 0.1879, inertia = [[0.0171364731454, 0, 0], [0, 0.0171364731454, 0], [0, 0, 0.033822]])]
    wrist_3_link: Body,
    #[body]
    ee_link: Body,
    #[body]
    tool0: Body,

    #[joint(ground -> base_link)]
    world_joint: Weld,
    #[joint(base_link.rotated(z(-3.14159265359)) -> base)]
    base_joint: Weld,
    #[joint(base_link.at(0.089159 * z) -> shoulder_link, about = z)]
    shoulder_pan: Pin,
    #[joint(shoulder_link.at(0.13585 * y).rotated(y(1.57079632679)) -> upper_arm_link, about = y)]
    shoulder_lift: Pin,
    #[joint(upper_arm_link.at(-0.1197 * y + 0.425 * z) -> forearm_link, about = y)]
    elbow: Pin,
    #[joint(forearm_link.at(0.39225 * z).rotated(y(1.57079632679)) -> wrist_1_link, about = y)]
    wrist_1: Pin,
    #[joint(wrist_1_link.at(0.093 * y) -> wrist_2_link, about = z)]
    wrist_2: Pin,
    #[joint(wrist_2_link.at(0.09465 * z) -> wrist_3_link, about = y)]
    wrist_3: Pin,
    #[joint(wrist_3_link.at(0.0823 * y).rotated(z(1.57079632679)) -> ee_link)]
    ee_joint: Weld,
    #[joint(wrist_3_link.at(0.0823 * y).rotated(x(-1.57079632679)) -> tool0)]
    tool0_joint: Weld,

    #[acts(on = shoulder_pan)]
    motor0: Torque,
    #[acts(on = shoulder_lift)]
    motor1: Torque,
    #[acts(on = elbow)]
    motor2: Torque,
    #[acts(on = wrist_1)]
    motor3: Torque,
    #[acts(on = wrist_2)]
    motor4: Torque,
    #[acts(on = wrist_3)]
    motor5: Torque,
}

/// Checks functions that are not in the trait `Mechanism`: inputs, the robot as a whole, and its bodies by
/// name.
macro_rules! assert_same_kinematics {
    ($written:ident, $read:ident, $last:literal) => {
        let (written, read) = ($written {}, $read);
        let (last, last_read) = (frame!($written, $last), frame!($read, $last));
        let assert_same_values = |what: &str, a: &[f64], b: &[f64]| assert_close(what, a, b, TOLERANCE);
        let mut random = Random::new(2);
        for _ in 0..10 {
            let q = random.random_configuration(&written);
            let (v, a, u) = (random.random_vector(2.0), random.random_vector(2.0), random.random_vector(2.0));
            let forces = written.generalized_forces(&q, &u);
            assert_same_values("inputs", forces.as_slice(), read.generalized_forces(&q, &u).as_slice());
            assert_same_values("total mass", &[written.total_mass()], &[read.total_mass()]);
            assert_same_values(
                "centre of mass",
                written.center_of_mass(&q).as_slice(),
                read.center_of_mass(&q).as_slice(),
            );
            assert_same_values(
                "momentum",
                written.momentum(&q, &v).as_slice(),
                read.momentum(&q, &v).as_slice(),
            );

            for (name, placement) in $written::FRAMES.iter().zip(written.frame_placements(&q)) {
                let k = $read::FRAMES.iter().position(|frame| frame == name).expect("the same names");
                let expected = read.frame_placements(&q)[k].to_homogeneous();
                assert_same_values(name, placement.to_homogeneous().as_slice(), expected.as_slice());
            }
            let velocity = written.frame_velocity(last, &q, &v);
            assert_same_values(
                "velocity",
                velocity.as_slice(),
                read.frame_velocity(last_read, &q, &v).as_slice(),
            );
            let acceleration = written.frame_acceleration(last, &q, &v, &a);
            let expected = read.frame_acceleration(last_read, &q, &v, &a);
            assert_same_values("acceleration", acceleration.as_slice(), expected.as_slice());
            let jacobian = written.frame_jacobian(last, &q);
            assert_same_values(
                "Jacobian",
                jacobian.as_slice(),
                read.frame_jacobian(last_read, &q).as_slice(),
            );
        }
    };
}

#[test]
fn cart_pole_struct_equals_its_urdf() {
    assert_same_dynamics(&CartPole {}, &CartPoleFile, 20, TOLERANCE);
    assert_same_kinematics!(CartPole, CartPoleFile, "pole");
}

#[test]
fn double_pendulum_struct_equals_its_urdf() {
    assert_same_dynamics(&DoublePendulum {}, &DoublePendulumFile, 20, TOLERANCE);
    assert_same_kinematics!(DoublePendulum, DoublePendulumFile, "link3");
}

#[test]
fn ur5_struct_equals_its_urdf() {
    assert_same_dynamics(&Ur5 {}, &Ur5File, 20, TOLERANCE);
    assert_same_kinematics!(Ur5, Ur5File, "tool0");
}
