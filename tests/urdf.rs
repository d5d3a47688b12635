//! URDF files and the options of `#[mechanism(urdf = …)]`, against the same mechanisms in the struct
//! language.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{frame, mechanism};
use support::compare::{assert_close, assert_same_dynamics};
use support::random::Random;

const TOLERANCE: f64 = 1e-13;

/// Mechanism in which every joint is independent, without passive forces, and with changed gravity.
#[mechanism(urdf = "data/urdf/everything.urdf", mimic = independent, passive = ignore, gravity = x - 9 * z)]
struct RobotOfAllUrdfElements;

#[mechanism(gravity = x - 9 * z)]
struct HandWrittenMechanism {
    #[body(mass = 7, inertia = diagonal(1, 1, 1))]
    root: Body,
    #[body(
        mass = 0.9,
        com = [0.01, 0.02, 0.03],
        inertia = [[0.02, 0, 0.001], [0, 0.03, 0], [0.001, 0, 0.04]]
    )]
    drone: Body,
    #[body(
        mass = 1.5,
        com = [0.05, -0.02, 0.2],
        inertia = [[0.03, 0.001, -0.002], [0.001, 0.04, 0.003], [-0.002, 0.003, 0.05]]
            .rotated(z(1.1), y(0.2), x(-0.3))
    )]
    arm: Body,
    #[body(mass = 0.6, com = 0.1 * x, inertia = diagonal(0.01, 0.01, 0.01))]
    follower: Body,
    #[body(mass = 0.4, com = 0.1 * z, inertia = diagonal(0.01, 0.02, 0.025))]
    slider: Body,
    #[body(mass = 0.5, com = 0.1 * x, inertia = diagonal(0.003, 0.003, 0.005))]
    puck: Body,
    #[body(mass = 0.2, com = 0.2 * y, inertia = diagonal(0.001, 0.002, 0.0015))]
    plate: Body,

    #[joint(ground -> root)]
    base: Weld,
    #[joint(root.at(z).rotated(z(0.5)) -> drone)]
    a_fly: Free,
    #[joint(
        root.at([0.1, 0.2, 0.3]).rotated(z(0.6), y(-0.5), x(0.4)) -> arm,
        about = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]
    )]
    b_turn: Pin,
    #[joint(arm.at(0.3 * y).rotated(x(0.7)) -> follower, about = z)]
    c_follow: Pin,
    #[joint(arm.at(0.1 * x - 0.2 * z).rotated(y(0.3)) -> slider, along = -y)]
    z_slide: Sleeve,
    #[joint(root.at(y).rotated(x(0.2)) -> puck, about = z)]
    d_skate: Planar,
    #[joint(puck.at(0.1 * y + 0.1 * z).rotated(y(1.2)) -> plate)]
    e_fix: Weld,
}

/// The order of joints is depth first, with the joints of a link in alphabetical order, independent of the
/// order in the file.
#[test]
fn urdf_joints_are_ordered_depth_first() {
    assert_eq!(RobotOfAllUrdfElements::INPUTS, ["b_turn", "c_follow", "z_slide"]);
    assert_eq!(RobotOfAllUrdfElements::VELOCITIES, HandWrittenMechanism::VELOCITIES);
    assert_eq!(RobotOfAllUrdfElements::CONFIGURATION, HandWrittenMechanism::CONFIGURATION);
    assert_eq!(
        RobotOfAllUrdfElements::VELOCITIES[6..],
        ["b_turn", "c_follow", "z_slide", "d_skate.x", "d_skate.y", "d_skate.angle"]
    );
}

#[test]
fn urdf_file_and_struct_have_equal_dynamics() {
    assert_same_dynamics(&RobotOfAllUrdfElements, &HandWrittenMechanism {}, 20, TOLERANCE);
    let q = Random::new(18).random_configuration(&RobotOfAllUrdfElements);
    for (name, placement) in
        RobotOfAllUrdfElements::FRAMES.iter().zip(RobotOfAllUrdfElements.frame_placements(&q))
    {
        let k = HandWrittenMechanism::FRAMES.iter().position(|frame| frame == name).expect("the same names");
        let expected = HandWrittenMechanism {}.frame_placements(&q)[k].to_homogeneous();
        assert_close(name, placement.to_homogeneous().as_slice(), expected.as_slice(), TOLERANCE);
    }
}

/// Damping `c v` and friction `f tanh(v / friction_speed)` have the coefficients of the file.
#[test]
fn passive_forces_have_the_coefficients_of_the_file() {
    #[mechanism(
        urdf = "data/urdf/everything.urdf",
        mimic = independent,
        gravity = x - 9 * z,
        friction_speed = 0.02
    )]
    struct FileWithPassiveForces;

    let mut random = Random::new(19);
    for speed in [0.0, 0.01, 1.0] {
        let q = random.random_configuration(&FileWithPassiveForces);
        let v = random.random_vector(speed);
        let mut expected = RobotOfAllUrdfElements.bias_forces(&q, &v);
        expected[6] += 0.3 * v[6] + 0.1 * (v[6] / 0.02).tanh();
        expected[8] += 2.0 * v[8];
        assert_close(
            "bias forces",
            FileWithPassiveForces.bias_forces(&q, &v).as_slice(),
            expected.as_slice(),
            TOLERANCE,
        );
        let acceleration = FileWithPassiveForces.forward_dynamics(&q, &v, &expected);
        assert_close("at rest", acceleration.as_slice(), &[0.0; 12], 1e-11);
    }
}

/// Checks a mimic joint with factor and offset, `c_follow = 0.2 − 0.5 b_turn`. The equations are those of
/// independent joints reduced by that relation.
#[test]
fn mimic_joint_has_factor_and_offset() {
    #[mechanism(urdf = "data/urdf/everything.urdf", passive = ignore, gravity = x - 9 * z)]
    struct RobotWithMimicJoints;

    // The relation maps the remaining velocities to those of the independent joints.
    let relation = SMatrix::<f64, 12, 11>::from_fn(|i, j| match (i, j) {
        (7, 6) => -0.5,
        (i, j) if i < 7 && i == j || i > 7 && i == j + 1 => 1.0,
        _ => 0.0,
    });
    assert_eq!(RobotWithMimicJoints::INPUTS, ["b_turn", "z_slide"]);
    let mut random = Random::new(20);
    for _ in 0..10 {
        let q = random.random_configuration(&RobotWithMimicJoints);
        let (v, a) = (random.random_vector(1.0), random.random_vector(1.0));
        // The coordinates are seven of the free joint, then b_turn.
        let q_free = q.insert_row(8, 0.2 - 0.5 * q[7]);
        let (v_free, a_free) = (relation * v, relation * a);
        let mass_matrix = relation.transpose() * RobotOfAllUrdfElements.mass_matrix(&q_free) * relation;
        assert_close(
            "mass matrix",
            RobotWithMimicJoints.mass_matrix(&q).as_slice(),
            mass_matrix.as_slice(),
            TOLERANCE,
        );
        let forces =
            relation.transpose() * RobotOfAllUrdfElements.inverse_dynamics(&q_free, &v_free, &a_free);
        assert_close(
            "forces",
            RobotWithMimicJoints.inverse_dynamics(&q, &v, &a).as_slice(),
            forces.as_slice(),
            TOLERANCE,
        );
        let acceleration = RobotWithMimicJoints.forward_dynamics(&q, &v, &forces);
        assert_close("forward dynamics", acceleration.as_slice(), a.as_slice(), 1e-11);
        let energies =
            [RobotWithMimicJoints.kinetic_energy(&q, &v), RobotWithMimicJoints.potential_energy(&q)];
        let expected = [
            RobotOfAllUrdfElements.kinetic_energy(&q_free, &v_free),
            RobotOfAllUrdfElements.potential_energy(&q_free),
        ];
        assert_close("energies", &energies, &expected, TOLERANCE);
        let momentum = relation.transpose() * RobotOfAllUrdfElements.generalized_momentum(&q_free, &v_free);
        assert_close(
            "p",
            RobotWithMimicJoints.generalized_momentum(&q, &v).as_slice(),
            momentum.as_slice(),
            TOLERANCE,
        );

        let (link, link_free) =
            (frame!(RobotWithMimicJoints, "follower"), frame!(RobotOfAllUrdfElements, "follower"));
        let jacobian = RobotWithMimicJoints.frame_jacobian(link, &q);
        let expected = RobotOfAllUrdfElements.frame_jacobian(link_free, &q_free) * relation;
        assert_close("Jacobian", jacobian.as_slice(), expected.as_slice(), TOLERANCE);
        let acceleration = RobotWithMimicJoints.frame_acceleration(link, &q, &v, &a);
        let expected = RobotOfAllUrdfElements.frame_acceleration(link_free, &q_free, &v_free, &a_free);
        assert_close("acceleration", acceleration.as_slice(), expected.as_slice(), TOLERANCE);
        let push = RobotWithMimicJoints.generalized_forces(&q, &SVector::from([2.0, 3.0]));
        let expected = relation.transpose()
            * RobotOfAllUrdfElements.generalized_forces(&q_free, &SVector::from([2.0, 0.0, 3.0]));
        assert_close("inputs", push.as_slice(), expected.as_slice(), TOLERANCE);
    }
}

#[test]
fn locked_joints_of_a_free_base_leave_the_coordinates() {
    #[mechanism(
        urdf = "data/urdf/everything.urdf",
        base = free,
        inputs = none,
        lock = ["b_turn", "z_slide"]
    )]
    struct RobotOnFreeBase;

    // The follower is locked at its offset, together with its leader.
    assert_eq!((RobotOnFreeBase::NQ, RobotOnFreeBase::NV, RobotOnFreeBase::NU), (7 + 7 + 3, 6 + 6 + 3, 0));
    assert_close(
        "mass",
        &[RobotOnFreeBase.total_mass()],
        &[7.0 + 0.9 + 1.5 + 0.6 + 0.4 + 0.5 + 0.2],
        TOLERANCE,
    );
    let q = RobotOnFreeBase.neutral();
    let mut q_free = RobotOfAllUrdfElements.neutral();
    q_free[8] = 0.2;
    let follower = RobotOnFreeBase.frame_placement(frame!(RobotOnFreeBase, "follower"), &q).to_homogeneous();
    let expected = RobotOfAllUrdfElements
        .frame_placement(frame!(RobotOfAllUrdfElements, "follower"), &q_free)
        .to_homogeneous();
    assert_close("follower", follower.as_slice(), expected.as_slice(), TOLERANCE);
}

#[test]
fn impossible_inertia_is_accepted_with_trust() {
    #[mechanism(urdf = "data/urdf/impossible.urdf", inertia = trust)]
    struct RobotWithImpossibleInertia;

    assert_eq!(RobotWithImpossibleInertia.mass_matrix(&RobotWithImpossibleInertia.neutral())[0], 3.0);
}

#[test]
fn urdf_mechanism_supports_single_precision() {
    #[mechanism(
        urdf = "data/urdf/everything.urdf", mimic = independent, passive = ignore, gravity = x - 9 * z,
        scalar = f32
    )]
    struct SinglePrecisionRobot;

    let q = Random::new(21).random_configuration(&RobotOfAllUrdfElements);
    let v = SVector::<f64, 12>::repeat(0.5);
    let forces = SinglePrecisionRobot.inverse_dynamics(&q.cast::<f32>(), &v.cast::<f32>(), &v.cast::<f32>());
    let expected = RobotOfAllUrdfElements.inverse_dynamics(&q, &v, &v);
    assert_close("forces", forces.cast::<f64>().as_slice(), expected.as_slice(), 1e-5);
}

/// Arm whose right angles are written with five digits: as written, and with exact right angles.
#[test]
fn nearly_right_angles_are_rounded_to_exact_ones() {
    #[mechanism(urdf = "../models/urdf/gen3.urdf")]
    struct Written;
    #[mechanism(urdf = "../models/urdf/gen3.urdf", snap = 1e-4)]
    struct ArmWithExactRightAngles;

    let mut random = Random::new(23);
    for _ in 0..10 {
        let (q, v, a) = (random.random_vector(3.0), random.random_vector(1.0), random.random_vector(1.0));
        let (written, meant) =
            (Written.inverse_dynamics(&q, &v, &a), ArmWithExactRightAngles.inverse_dynamics(&q, &v, &a));
        let difference = (written - meant).norm() / written.norm();
        assert!(difference > 1e-9 && difference < 1e-4, "{difference}");
    }
    // Stretched out upwards, the arm deviates to the side only by its small offsets; the rounded digits of
    // the file add to that.
    let up = SVector::zeros();
    let aside = 0.005375 + 3.0 * 0.006375 + 2.0 * 0.00017505;
    let meant = ArmWithExactRightAngles
        .frame_placement(frame!(ArmWithExactRightAngles, "EndEffector_Link"), &up)
        .translation;
    assert!((meant.y + aside).abs() < 1e-15 && meant.x.abs() < 1e-15, "{meant}");
    let written = Written.frame_placement(frame!(Written, "EndEffector_Link"), &up).translation;
    assert!((written.y + aside).abs() > 1e-7, "{written}");
}

/// The documentation of the struct states the rounded numbers.
#[test]
fn rounded_numbers_are_documented() {
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let arguments_with_options =
        |more: &str| parse_tokens(&format!("urdf = \"../models/urdf/gen3.urdf\"{more}"));
    let docs = linkwork_compiler::expand(
        arguments_with_options(", snap = 1e-4"),
        parse_tokens("struct Robot;"),
        folder,
    )
    .tokens
    .to_string();
    assert!(
        docs.contains("Rounded numbers") && docs.contains("`Actuator1`: roll 3.1416 → 3.141592653589793")
    );
    let docs = linkwork_compiler::expand(arguments_with_options(""), parse_tokens("struct Robot;"), folder)
        .tokens
        .to_string();
    assert!(!docs.contains("Rounded numbers"));
}

/// A file without inertia has frames, their Jacobians, the configuration space and the effect of inputs. The
/// example has polar coordinates, and a ball joint at the end.
#[test]
fn urdf_kinematics_need_no_inertia() {
    #[mechanism(urdf = "data/urdf/bare.urdf", inertia = none)]
    struct Bare;

    assert_eq!(Bare::FRAMES, ["world", "arm", "wrist", "hand"]);
    assert_eq!(Bare::VELOCITIES, ["shoulder", "reach", "grip.wx", "grip.wy", "grip.wz"]);
    assert_eq!(Bare::INPUTS, ["shoulder", "reach"]);
    assert_eq!(Bare::EQUATIONS, "");
    let (angle, length) = (0.7_f64, 0.3);
    let q = Bare.integrate(&Bare.neutral(), &[angle, length, 0.1, -0.2, 0.3].into());
    let hand = frame!(Bare, "hand");
    let radius = length + 0.5;
    let place = [radius * angle.cos(), radius * angle.sin(), 1.0];
    let found = Bare.frame_placement(hand, &q);
    assert_close("place", found.translation.vector.as_slice(), &place, TOLERANCE);
    let (turn, stretch) = (1.1, -0.4);
    let v = [turn, stretch, 0.0, 0.0, 0.0].into();
    let velocity = [
        stretch * angle.cos() - turn * radius * angle.sin(),
        stretch * angle.sin() + turn * radius * angle.cos(),
        0.0,
        0.0,
        0.0,
        turn,
    ];
    assert_close("velocity", Bare.frame_velocity(hand, &q, &v).as_slice(), &velocity, TOLERANCE);
    assert_close("Jacobian", (Bare.frame_jacobian(hand, &q) * v).as_slice(), &velocity, TOLERANCE);
    let forces = Bare.generalized_forces(&q, &[2.0, 3.0].into());
    assert_close("inputs", forces.as_slice(), &[2.0, 3.0, 0.0, 0.0, 0.0], 0.0);
    assert_close("difference", Bare.difference(&q, &q).as_slice(), &[0.0; 5], TOLERANCE);
}

/// Checks that with `inertia = none` the kinematics of a file with inertia do not change.
#[test]
fn kinematics_without_inertia_equal_those_of_the_robot() {
    #[mechanism(urdf = "data/urdf/everything.urdf", mimic = independent, inertia = none)]
    struct EverythingWithoutInertia;

    assert_eq!(EverythingWithoutInertia::FRAMES, RobotOfAllUrdfElements::FRAMES);
    let mut random = Random::new(24);
    for _ in 0..10 {
        let q = random.random_configuration(&RobotOfAllUrdfElements);
        let (v, a) = (random.random_vector(1.0), random.random_vector(1.0));
        for (one, other) in EverythingWithoutInertia
            .frame_placements(&q)
            .iter()
            .zip(RobotOfAllUrdfElements.frame_placements(&q))
        {
            let expected = other.to_homogeneous();
            assert_close("placement", one.to_homogeneous().as_slice(), expected.as_slice(), TOLERANCE);
        }
        let (one, other) =
            (frame!(EverythingWithoutInertia, "plate"), frame!(RobotOfAllUrdfElements, "plate"));
        let (jacobian, expected) = (
            EverythingWithoutInertia.frame_jacobian(one, &q),
            RobotOfAllUrdfElements.frame_jacobian(other, &q),
        );
        assert_close("Jacobian", jacobian.as_slice(), expected.as_slice(), TOLERANCE);
        let acceleration = EverythingWithoutInertia.frame_acceleration(one, &q, &v, &a);
        let expected = RobotOfAllUrdfElements.frame_acceleration(other, &q, &v, &a);
        assert_close("acceleration", acceleration.as_slice(), expected.as_slice(), TOLERANCE);
        assert_eq!(EverythingWithoutInertia.integrate(&q, &v), RobotOfAllUrdfElements.integrate(&q, &v));
    }
}

/// Linkage that is defined by its lengths: constraints and outputs need no inertia either.
#[test]
fn linkage_without_inertia_has_constraints_and_outputs() {
    #[mechanism(inertia = none)]
    struct Linkage {
        pub crank: f64,
        pub rod: f64,
        #[body]
        wheel: Body,
        #[body]
        coupler: Body,
        #[body]
        piston: Body,
        #[joint(ground -> wheel, about = z)]
        main: Pin,
        #[joint(wheel.at(crank * x) -> coupler, about = z)]
        big_end: Pin,
        #[joint(ground -> piston, along = x)]
        cylinder: Sleeve,
        #[joint(coupler.at(rod * x) -> piston, about = z)]
        small_end: Pin,
        #[output(dot(v(coupler.at(rod / 2 * x) / ground / ground), ground.y))]
        rise: Scalar,
    }

    let linkage = Linkage { crank: 0.3, rod: 0.5 };
    // Crank, rod and the line of the piston form a right triangle with the sides 0.3, 0.4, 0.5.
    let upright = std::f64::consts::FRAC_PI_2;
    let q = [upright, -upright - (0.3_f64).atan2(0.4), 0.4].into();
    assert_eq!((Linkage::NC, Linkage::NH, Linkage::NS), (2, 2, 1));
    assert_close("closed", linkage.constraint_residuals(&q).as_slice(), &[0.0; 2], TOLERANCE);
    // The end of the crank moves along x, and so do all points of the rod.
    let v: SVector<f64, 3> = [1.0, -1.0, -0.3].into();
    assert_close("rates", (linkage.constraint_jacobian(&q) * v).as_slice(), &[0.0; 2], TOLERANCE);
    assert_close("rise", &[linkage.rise(&q, &v)], &[0.0], TOLERANCE);
}

/// A fixed root named `ground` is the ground, and a frame like other links.
#[test]
fn link_named_ground_is_the_fixed_root() {
    #[mechanism(urdf = "data/urdf/grounded.urdf")]
    struct RobotRootedAtGround;

    assert_eq!(RobotRootedAtGround::FRAMES, ["ground", "hand"]);
    let q = [0.4].into();
    let placement = RobotRootedAtGround.frame_placement(frame!(RobotRootedAtGround, "ground"), &q);
    assert_eq!(placement.to_homogeneous(), SMatrix::<f64, 4, 4>::identity());
    assert_close(
        "hand",
        RobotRootedAtGround.frame_placements(&q)[1].translation.vector.as_slice(),
        &[0.4, 0.0, 0.0],
        0.0,
    );
    // Bodies that are fixed to the ground have no effect on the motion.
    assert_eq!((RobotRootedAtGround.total_mass(), RobotRootedAtGround.mass_matrix(&q)[0]), (2.0, 2.0));
}

/// Parallelogram linkage of two parallel cranks and a coupler, whose loop is closed by one of its joints.
#[mechanism(urdf = "data/urdf/parallelogram.urdf", loops = close)]
struct Parallelogram;

/// Parallelogram linkage whose loop is closed by an element of Isaac Sim.
#[mechanism(urdf = "data/urdf/parallelogram_loop_joint.urdf", loops = close)]
struct ParallelogramWithLoopJoint;

/// Parallelogram linkage whose loop is closed by a joint in a `<gazebo>` element.
#[mechanism(urdf = "data/urdf/parallelogram_gazebo.urdf", loops = close)]
struct ParallelogramWithGazeboJoint;

/// Parallelogram linkage whose loop is closed by a ball constraint of Drake.
#[mechanism(urdf = "data/urdf/parallelogram_drake.urdf", loops = close)]
struct ParallelogramWithBallConstraint;

/// Checks a linkage against the motion of a parallelogram, whose coupler moves in translation. By the
/// principle of virtual work its inertia about the cranks is `2 (I + m c²) + M l²`, and gravity acts on it
/// with `2 m g c + M g l`.
macro_rules! check_parallelogram {
    ($name:ident) => {
        let (inertia, weight) =
            (2.0 * (0.02 + 1.5 * 0.04) + 2.0 * 0.16, 9.81 * (2.0 * 1.5 * 0.2 + 2.0 * 0.4));
        assert_eq!($name::INPUTS, ["shoulder", "elbow", "support"]);
        for (angle, rate, torque) in [(0.7_f64, 0.0, 0.0), (2.0, -1.5, 3.0), (-1.2, 4.0, -2.0)] {
            let (q, v) = ([angle, -angle, angle].into(), [rate, -rate, rate].into());
            let residuals = $name.constraint_residuals(&q);
            assert!(residuals.amax() < 1e-15, "closed: {residuals}");
            let a = $name.forward_dynamics(&q, &v, &[torque, 0.0, 0.0].into());
            let expected = (torque - weight * angle.cos()) / inertia;
            assert_close("accelerations", a.as_slice(), &[expected, -expected, expected], 1e-12);
        }
    };
}

#[test]
fn urdf_joint_closes_a_loop() {
    check_parallelogram!(Parallelogram);
}

#[test]
fn extensions_of_other_tools_close_loops() {
    check_parallelogram!(ParallelogramWithLoopJoint);
    check_parallelogram!(ParallelogramWithGazeboJoint);
    check_parallelogram!(ParallelogramWithBallConstraint);
}
