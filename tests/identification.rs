//! Inverse dynamics as a linear function of the inertial parameters, and the combinations of them that can be
//! identified (base parameters).

use linkwork::mechanism;
use linkwork::nalgebra::{DMatrix, SMatrix, SVector};
use support::compare::{assert_close, assert_close_relative_to_largest};
use support::random::Random;

/// Tolerance between two derivations of the same quantity.
const EXACT: f64 = 1e-10;
/// Singular values below this fraction of the largest count as zero.
const RANK: f64 = 1e-9;

/// UR5 robot arm with six axes.
#[mechanism(urdf = "../models/urdf/ur5.urdf", passive = ignore, regressor)]
struct Ur5;

/// Panda robot arm with seven axes and two independent fingers.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent, passive = ignore, regressor)]
struct Panda;

/// Solo12 quadruped robot with a free base.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, passive = ignore, regressor)]
struct Quadruped;

/// PUMA 560 arm with geometric parameters (Armstrong, Khatib and Burdick 1986). Its bodies have no symmetry,
/// and a load is fixed to one of them.
#[mechanism(gravity = -9.81 * z, regressor, prepare)]
struct Puma {
    a2: f64,
    a3: f64,
    d3: f64,
    d4: f64,
    m: f64,
    #[body(
        mass = 3 * m, com = [0.1 * a2, 0.02 * d3, 0.1 * d4],
        inertia = cuboid(3 * m, a2, d3, d4).rotated(x(0.3))
    )]
    trunk: Body,
    #[body(
        mass = 2 * m, com = [a2 / 2, d3, 0.1 * d4], inertia = cuboid(2 * m, a2, d3, d4).rotated(y(0.4), z(1))
    )]
    upper: Body,
    #[body(mass = m, com = [-a3, -d4 / 2, d3 / 9], inertia = cuboid(m, a3, d4, d3).rotated(y(0.2)))]
    fore: Body,
    #[body(mass = m / 2, com = [0, a3, d3 / 5], inertia = cuboid(m / 2, a3, d3, d3).rotated(z(0.2), x(0.5)))]
    first: Body,
    #[body(mass = m / 3, com = [a3, 0, -d3 / 8], inertia = cuboid(m / 3, d3, a3, a3).rotated(x(0.7), z(0.1)))]
    second: Body,
    #[body(mass = m / 4, com = [a3, a3, d3], inertia = cuboid(m / 4, d3, d3, a3).rotated(x(1.7), z(0.4)))]
    hand: Body,
    #[particle(mass = m / 5, at = hand.at(d3 * z + a3 * y))]
    load: Particle,
    #[joint(ground -> trunk, about = z)]
    waist: Pin,
    #[joint(trunk.rotated(x(-pi / 2)) -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(a2 * x + d3 * z) -> fore, about = z)]
    elbow: Pin,
    #[joint(fore.at(a3 * x - d4 * y).rotated(x(-pi / 2)) -> first, about = z)]
    roll: Pin,
    #[joint(first.rotated(x(pi / 2)) -> second, about = z)]
    pitch: Pin,
    #[joint(second.rotated(x(-pi / 2)) -> hand, about = z)]
    yaw: Pin,
}

/// Mechanism with a universal joint, a ball joint, a screw and a sleeve, bodies away from their joints, and a
/// bead on a wire.
#[mechanism(gravity = [0.3, -9.7, 0.4], regressor)]
struct MechanismOfAllJoints {
    mass: f64,
    length: f64,
    #[body(mass = 2 * mass, com = length * x, inertia = cuboid(2 * mass, 0.2, 0.3, 0.4))]
    hub: Body,
    #[body(mass = mass, com = 0.1 * z - 0.05 * x, inertia = disk(mass, 0.2, z))]
    mirror: Body,
    #[body(mass = 0.3, com = 0.02 * y, inertia = rod(0.3, length, x))]
    bolt: Body,
    #[body(mass = 0.4, com = 0.1 * x, inertia = sphere(0.4, 0.1))]
    slider: Body,
    #[joint(ground.at([0.1, 0.2, -0.1]).rotated(x(0.3)) -> hub.at(0.1 * y), about = (x, y))]
    gimbal: Universal,
    #[joint(hub.at(length * x) -> mirror.at(0.02 * y))]
    bearing: Ball,
    #[joint(mirror.at(0.3 * y) -> bolt, about = z, pitch = 0.05)]
    thread: Screw,
    #[joint(hub.at(0.3 * z).rotated(y(0.4)) -> slider, along = y)]
    rail: Sleeve,
    s: Coordinate,
    #[particle(mass = mass / 2, at = mirror.at(s * x + s * s / (2 * length) * y))]
    bead: Particle,
}

/// Tree with universal joints on moving bodies: one on a pendulum, and one on a bob that hangs from a ball
/// joint. Inertial parameters that move from one body to the next across a universal joint move along both of
/// its axes.
#[mechanism(gravity = [0.3, -9.7, 0.4], regressor)]
struct UniversalJointsOnMovingBodies {
    #[body(mass = 0.3, com = -0.3 * z, inertia = sphere(0.3, 0.05))]
    sling: Body,
    #[joint(ground -> sling, about = y)]
    hook: Pin,
    #[body(mass = 0.1, com = 0.1 * y, inertia = rod(0.1, 0.2, y))]
    rotor: Body,
    #[joint(sling.at(-0.3 * z) -> rotor, about = (x, z))]
    gimbal: Universal,
    #[body(mass = 0.2, com = 0.1 * x + 0.05 * z, inertia = cuboid(0.2, 0.1, 0.2, 0.3))]
    bob: Body,
    #[joint(sling.at(0.1 * x) -> bob)]
    ball: Ball,
    #[body(mass = 0.4, com = 0.1 * y, inertia = cuboid(0.4, 0.3, 0.2, 0.1))]
    tail: Body,
    #[joint(bob.at(0.2 * z) -> tail, about = (z, x))]
    second: Universal,
}

/// Returns the rank of the stacked matrices: the number of independent columns.
fn rank_of_stacked_matrices<const N: usize, const M: usize>(matrices: &[SMatrix<f64, N, M>]) -> usize {
    let stacked = DMatrix::from_fn(N * matrices.len(), M, |i, j| matrices[i / N][(i % N, j)]);
    let singular = stacked.singular_values();
    singular.iter().filter(|s| **s > RANK * singular.max()).count()
}

/// Checks that both regressors reproduce inverse dynamics, for the inertial parameters of the mechanism and
/// for random ones. The number of base parameters must equal the rank of the regressor.
macro_rules! check {
    ($robot:ident, $at:expr) => {{
        const STANDARD: usize = 10 * $robot::BODIES.len();
        const BASE: usize = $robot::BASE_PARAMETERS.len();
        let robot = $at;
        let mut random = Random::new(21);
        let own = robot.standard_parameters();
        let total: f64 = own.iter().step_by(10).sum();
        assert_close("total mass", &[total], &[robot.total_mass()], EXACT);
        let (mut standard, mut base) = (Vec::new(), Vec::new());
        for _ in 0..2 * STANDARD / $robot::NV + 4 {
            let q = random.random_configuration(&robot);
            let [v, a] = [random.random_vector(2.0), random.random_vector(3.0)];
            let whole = robot.joint_torque_regressor(&q, &v, &a);
            let least = robot.base_regressor(&q, &v, &a);
            let tau = robot.inverse_dynamics(&q, &v, &a);
            assert_close_relative_to_largest(
                "inverse dynamics",
                (whole * own).as_slice(),
                tau.as_slice(),
                EXACT,
            );
            for other in [own, random.random_vector(1.0)] {
                let reduced = least * robot.base_parameters(&other);
                assert_close_relative_to_largest(
                    "base parameters",
                    reduced.as_slice(),
                    (whole * other).as_slice(),
                    1e-8,
                );
            }
            standard.push(whole);
            base.push(least);
        }
        assert_eq!(rank_of_stacked_matrices(&standard), BASE, "independent columns of the whole");
        assert_eq!(rank_of_stacked_matrices(&base), BASE, "independent columns of the base regressor");
        BASE
    }};
}

#[test]
fn regressors_of_robots_reproduce_inverse_dynamics() {
    // 7 for each pin except the first, whose axis is vertical: only the inertia about this axis has an
    // effect.
    assert_eq!(check!(Ur5, Ur5), 36);
    // The arm's 43 (Gaz et al. 2019), and the mass and first moment of each finger.
    assert_eq!(check!(Panda, Panda), 43 + 2 * 4);
    // All ten of the floating body, and 7 for each pin.
    assert_eq!(check!(Quadruped, Quadruped), 10 + 12 * 7);
}

fn sample_puma_arm() -> Puma {
    Puma { a2: 0.4318, a3: 0.0203, d3: 0.15005, d4: 0.4318, m: 4.0 }
}

#[test]
fn regressors_of_parametric_mechanisms_reproduce_dynamics() {
    assert_eq!(check!(Puma, sample_puma_arm()), 36);
    assert_eq!(Puma::BODIES, ["trunk", "upper", "fore", "first", "second", "hand"]);
    assert_eq!(Puma::BASE_PARAMETERS[0], "trunk.zz");
    check!(MechanismOfAllJoints, MechanismOfAllJoints { mass: 0.7, length: 0.4 });
    check!(UniversalJointsOnMovingBodies, UniversalJointsOnMovingBodies {});
}

#[test]
fn prepared_regressors_equal_unprepared_ones() {
    let (robot, mut random) = (sample_puma_arm(), Random::new(22));
    let prepared = robot.prepare();
    let (q, v, a) = (random.random_vector(2.0), random.random_vector(2.0), random.random_vector(2.0));
    let (one, other) = (prepared.base_regressor(&q, &v, &a), robot.base_regressor(&q, &v, &a));
    assert_close("base regressor", one.as_slice(), other.as_slice(), EXACT);
    let standard = prepared.standard_parameters();
    assert_close("parameters", standard.as_slice(), robot.standard_parameters().as_slice(), EXACT);
    let base = (prepared.base_parameters(&standard), robot.base_parameters(&standard));
    assert_close("base parameters", base.0.as_slice(), base.1.as_slice(), EXACT);
}

/// Two rods with a spring, a dashpot and friction.
#[mechanism(gravity = -9.81 * y, regressor)]
struct DoublePendulum {
    m: f64,
    l: f64,
    k: f64,
    c: f64,
    #[body(mass = 2 * m, com = -l / 2 * y, inertia = rod(2 * m, l, y))]
    upper: Body,
    #[body(mass = m, com = -l / 2 * y, inertia = rod(m, l, y))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-l * y) -> lower, about = z)]
    elbow: Pin,
    #[acts(on = shoulder, stiffness = k)]
    spring: Spring,
    #[acts(on = elbow, damping = c)]
    dashpot: Dashpot,
}

/// Checks the base parameters of a planar chain by hand: each link has two first moments and one inertia,
/// through which the masses act. Forces of elements are not part of the regressor.
#[test]
fn base_parameters_of_a_planar_chain_agree_with_hand_derivation() {
    let (m, l, k, c) = (1.5, 0.8, 7.0, 0.3);
    let pendulum = DoublePendulum { m, l, k, c };
    let rod_parameters =
        |m: f64| [m, 0.0, -m * l / 2.0, 0.0, m * l * l / 3.0, 0.0, 0.0, 0.0, 0.0, m * l * l / 3.0];
    let expected = [rod_parameters(2.0 * m), rod_parameters(m)].concat();
    assert_close("parameters", pendulum.standard_parameters().as_slice(), &expected, 1e-15);
    let names = ["upper.mx", "upper.my", "upper.zz", "lower.mx", "lower.my", "lower.zz"];
    assert_eq!(DoublePendulum::BASE_PARAMETERS, names);
    let base = pendulum.base_parameters(&pendulum.standard_parameters());
    let expected = [
        0.0,
        -2.0 * m * l / 2.0 - m * l,
        2.0 * m * l * l / 3.0 + m * l * l,
        0.0,
        -m * l / 2.0,
        m * l * l / 3.0,
    ];
    assert_close("base parameters", base.as_slice(), &expected, 1e-14);
    let (q, v, a) = (SVector::from([0.4, -0.7]), SVector::from([1.0, 2.0]), SVector::from([0.5, -3.0]));
    let rest = pendulum.inverse_dynamics(&q, &v, &a)
        - pendulum.joint_torque_regressor(&q, &v, &a) * pendulum.standard_parameters();
    assert_close("elements", rest.as_slice(), &[k * q[0], c * v[1]], 1e-13);
}
