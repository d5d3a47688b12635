//! Centroidal momentum matrix and its bias. They are compared with the momentum itself, with differences
//! along motions, and with Newton's and Euler's laws for the whole system.

use linkwork::nalgebra::{SMatrix, SVector, Vector6};
use linkwork::{Mechanism, mechanism};
use support::compare::assert_close_relative_to_largest;
use support::random::Random;

/// Tolerance between two derivations of the same quantity.
const EXACT: f64 = 1e-11;
/// Tolerance of derivatives against finite differences.
const DIFFERENCE: f64 = 1e-7;

/// Solo12 quadruped robot with a free base.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, centroidal)]
struct Quadruped;

/// Humanoid robot with a free base.
#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free, centroidal)]
struct Humanoid;

/// Panda arm fixed to the ground, whose second finger follows the first one.
#[mechanism(urdf = "../models/urdf/panda.urdf", centroidal)]
struct Panda;

/// Mechanism with a universal joint, a ball joint and a screw, and a bead on a wire that is fixed to a body.
#[mechanism(gravity = [0.3, -9.7, 0.4], centroidal)]
struct MechanismOfAllJoints {
    mass: f64,
    length: f64,
    #[body(mass = 2 * mass, com = length * x, inertia = cuboid(2 * mass, 0.2, 0.3, 0.4))]
    hub: Body,
    #[body(mass = mass, com = 0.1 * z - 0.05 * x, inertia = disk(mass, 0.2, z))]
    mirror: Body,
    #[body(mass = 0.3, com = 0.02 * y, inertia = rod(0.3, length, x))]
    bolt: Body,
    #[joint(ground.at([0.1, 0.2, -0.1]).rotated(x(0.3)) -> hub.at(0.1 * y), about = (x, y))]
    gimbal: Universal,
    #[joint(hub.at(length * x) -> mirror.at(0.02 * y))]
    bearing: Ball,
    #[joint(mirror.at(0.3 * y) -> bolt, about = z, pitch = 0.05)]
    thread: Screw,
    s: Coordinate,
    #[particle(mass = mass / 2, at = mirror.at(s * x + s * s / 2 * y))]
    bead: Particle,
}

/// Checks that `A v` is the momentum, and that the momentum changes by `Ȧ v` where all accelerations are
/// zero.
macro_rules! check {
    ($at:expr) => {{
        let robot = $at;
        let mut random = Random::new(11);
        for _ in 0..8 {
            let q = random.random_configuration(&robot);
            let v = random.random_vector(1.5);
            let matrix = robot.centroidal_momentum_matrix(&q);
            let momentum = robot.momentum(&q, &v);
            assert_close_relative_to_largest("momentum", (matrix * v).as_slice(), momentum.as_slice(), EXACT);
            let h = 1e-4;
            let momentum_after_displacement = |s: f64| robot.momentum(&robot.integrate(&q, &(v * s)), &v);
            let rate = ((momentum_after_displacement(h) - momentum_after_displacement(-h)) * 8.0
                - (momentum_after_displacement(2.0 * h) - momentum_after_displacement(-2.0 * h)))
                / (12.0 * h);
            let bias = robot.centroidal_momentum_bias(&q, &v);
            assert_close_relative_to_largest("bias", bias.as_slice(), rate.as_slice(), DIFFERENCE);
        }
    }};
}

#[test]
fn centroidal_momentum_of_robots_equals_body_momenta() {
    check!(Quadruped);
    check!(Humanoid);
    check!(Panda);
    check!(MechanismOfAllJoints { mass: 0.7, length: 0.4 });
}

/// Checks that the weight alone changes the momentum of a free-flying robot, for any motor torques.
fn check_momentum_change_by_weight<M, const NQ: usize, const NV: usize, const NU: usize>(
    robot: &M,
    mass: f64,
    matrix: impl Fn(&SVector<f64, NQ>) -> SMatrix<f64, 6, NV>,
    bias: impl Fn(&SVector<f64, NQ>, &SVector<f64, NV>) -> Vector6<f64>,
) where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(12);
    for _ in 0..8 {
        let (q, v) = (random.random_configuration(robot), random.random_vector(2.0));
        let tau = robot.generalized_forces(0.0, &q, &v, &random.random_vector(20.0));
        let a = robot.forward_dynamics(0.0, &q, &v, &tau);
        let rate = matrix(&q) * a + bias(&q, &v);
        let weight = [0.0, 0.0, -9.81 * mass, 0.0, 0.0, 0.0];
        assert_close_relative_to_largest("rate of momentum", rate.as_slice(), &weight, 1e-9);
    }
}

#[test]
fn only_weight_changes_the_momentum_of_flying_robots() {
    let robot = Quadruped;
    let momentum_bias = |q: &_, v: &_| robot.centroidal_momentum_bias(q, v);
    check_momentum_change_by_weight(
        &robot,
        robot.total_mass(),
        |q| robot.centroidal_momentum_matrix(q),
        momentum_bias,
    );
    let robot = Humanoid;
    let momentum_bias = |q: &_, v: &_| robot.centroidal_momentum_bias(q, v);
    check_momentum_change_by_weight(
        &robot,
        robot.total_mass(),
        |q| robot.centroidal_momentum_matrix(q),
        momentum_bias,
    );
}
