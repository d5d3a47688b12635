//! Checks of robots from files whose inertial and geometric values are parameters. With the values of the
//! file they equal the robot of the file; with other values they equal the robot of another file.

use linkwork::identification::{PutBackError, approach};
use linkwork::lanes::f64x4;
use linkwork::nalgebra::SVector;
use linkwork::{Fault, Inertial, Lanes, Placement, frame, mechanism};
use support::compare::{assert_close, assert_close_relative_to_largest, assert_same_dynamics};
use support::random::Random;

const TOLERANCE: f64 = 1e-11;

/// Robot with links and joints of all kinds and constant values.
#[mechanism(urdf = "data/urdf/everything.urdf", mimic = independent, derivatives, regressor)]
struct RobotOfAllJoints;

/// Robot with links and joints of all kinds whose values are all parameters.
#[mechanism(
    urdf = "data/urdf/everything.urdf", mimic = independent, derivatives, regressor, prepare,
    parameters = [inertial, placement, damping, friction]
)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct RobotWithAllParameters;

/// Quadruped robot whose inertial parameters are fields of the struct.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, parameters = inertial, prepare)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadruped;

#[test]
fn parametric_robot_with_file_values_equals_the_file_robot() {
    let (plain, robot) = (RobotOfAllJoints, RobotWithAllParameters::FILE);
    assert_eq!(robot.validate(), Ok(()));
    assert_eq!(RobotWithAllParameters::from_file(), robot);
    assert_same_dynamics(&robot, &plain, 20, TOLERANCE);
    assert_same_dynamics(&robot.prepare(), &plain, 20, TOLERANCE);
    let mut random = Random::new(3);
    let q = random.random_configuration(&plain);
    let [v, a] = [random.random_vector(2.0), random.random_vector(2.0)];
    let assert_similar_values =
        |what: &str, a: &[f64], b: &[f64]| assert_close_relative_to_largest(what, a, b, TOLERANCE);
    let (one, other) =
        (robot.inverse_dynamics_derivatives(&q, &v, &a), plain.inverse_dynamics_derivatives(&q, &v, &a));
    assert_similar_values("by q", one.0.as_slice(), other.0.as_slice());
    assert_similar_values("by v", one.1.as_slice(), other.1.as_slice());
    let (one, other) = (robot.joint_torque_regressor(&q, &v, &a), plain.joint_torque_regressor(&q, &v, &a));
    assert_similar_values("regressor", one.as_slice(), other.as_slice());
    assert_similar_values(
        "standard",
        robot.standard_parameters().as_slice(),
        plain.standard_parameters().as_slice(),
    );
    assert_similar_values("momentum", robot.momentum(&q, &v).as_slice(), plain.momentum(&q, &v).as_slice());
    for (one, other) in robot.frame_placements(&q).iter().zip(plain.frame_placements(&q)) {
        assert_similar_values(
            "placements",
            one.to_homogeneous().as_slice(),
            other.to_homogeneous().as_slice(),
        );
    }
    let quadruped = Quadruped::FILE;
    assert_eq!(quadruped.validate(), Ok(()));
    assert_same_dynamics(&quadruped, &linkwork_models::Solo12, 10, TOLERANCE);
    assert_same_dynamics(&quadruped.prepare(), &linkwork_models::Solo12, 10, TOLERANCE);
}

/// Arm with the constant values of the file before its numbers are changed.
#[mechanism(urdf = "data/urdf/arm_before.urdf")]
struct ArmBeforeChange;
#[mechanism(urdf = "data/urdf/arm_after.urdf")]
struct ArmAfterChange;

/// Arm from a file in which all values are parameters, with a load as an additional parameter.
#[mechanism(
    urdf = "data/urdf/arm_before.urdf", regressor, sensitivities,
    parameters = [inertial, placement, damping, friction]
)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Arm<T> {
    load: T,
    #[particle(mass = load, at = fore.at(0.1 * x))]
    tool: Particle,
}

/// Parameters of the arm with the default values of another file.
#[mechanism(urdf = "data/urdf/arm_after.urdf", parameters = [inertial, placement, damping, friction])]
#[derive(Clone, Copy)]
struct ParametersOfOtherFile;

fn arm_with_parameters(f: &ParametersOfOtherFile) -> Arm<f64> {
    Arm {
        load: 0.0,
        upper_arm: f.upper_arm,
        fore: f.fore,
        type_link: f.type_link,
        shoulder_placement: f.shoulder_placement,
        elbow_placement: f.elbow_placement,
        slide_placement: f.slide_placement,
        shoulder_damping: f.shoulder_damping,
        elbow_damping: f.elbow_damping,
        slide_damping: f.slide_damping,
        shoulder_friction: f.shoulder_friction,
        elbow_friction: f.elbow_friction,
        slide_friction: f.slide_friction,
    }
}

#[test]
fn parametric_robot_with_new_values_equals_the_new_file_robot() {
    let before = Arm::<f64>::from_file(0.0);
    assert_same_dynamics(&before, &ArmBeforeChange, 20, TOLERANCE);
    let after = arm_with_parameters(&ParametersOfOtherFile::FILE);
    assert_same_dynamics(&after, &ArmAfterChange, 20, TOLERANCE);
    assert_ne!(before, after);
    // The parameters have the values that the file states; the inertia of the file is in other axes.
    assert_eq!(
        before.fore,
        Inertial {
            mass: 2.0,
            com: [0.15, 0.0, 0.01],
            ixx: 0.01,
            ixy: 0.0,
            ixz: 0.0,
            iyy: 0.02,
            iyz: 0.0,
            izz: 0.022
        }
    );
    assert_eq!(
        before.elbow_placement,
        Placement { xyz: [0.4, 0.0, 0.1], rpy: [std::f64::consts::FRAC_PI_2, 0.0, 0.0] }
    );
    assert_eq!([before.slide_damping, before.slide_friction, before.shoulder_friction], [2.0, 0.0, 0.1]);
    let i = before.upper_arm;
    assert!((i.ixx + i.iyy + i.izz - 0.09).abs() < 1e-15 && i.ixx != 0.03);
}

#[test]
fn mass_parameters_have_readable_names() {
    assert_eq!(Arm::<f64>::LINKS, ["upper-arm", "fore", "type"]);
    let parameter_index = |name| linkwork::index_of(&Arm::<f64>::PARAMETERS, name).unwrap();
    assert_eq!(parameter_index("load"), 0);
    // The derivative of a joint's torque with respect to its damping is its velocity.
    let arm = Arm::<f64>::from_file(0.3);
    let (q, v, a) = ([0.3, 0.2, 0.1].into(), [0.5, -0.7, 0.9].into(), [0.1, 0.2, 0.3].into());
    let by = arm.inverse_dynamics_by_parameters(&q, &v, &a);
    assert_close("damping", by.column(parameter_index("elbow_damping")).as_slice(), &[0.0, -0.7, 0.0], 1e-15);
    let torques_with_mass_change = |mass: f64| {
        let mut other = arm;
        other.type_link.mass += mass;
        other.inverse_dynamics(&q, &v, &a)
    };
    let differences = (torques_with_mass_change(1e-4) - torques_with_mass_change(-1e-4)) / 2e-4;
    assert_close(
        "mass",
        by.column(parameter_index("type_link.mass")).as_slice(),
        differences.as_slice(),
        1e-8,
    );
}

#[test]
fn lanes_may_have_different_parameters() {
    let mut robots = Arm::<f64x4>::from_file(Lanes([0.0, 0.1, 0.2, 0.3]));
    robots.fore.mass = Lanes([2.0, 2.5, 3.0, 3.5]);
    robots.elbow_friction = Lanes([0.0, 0.1, 0.2, 0.3]);
    assert_eq!(robots.validate(), Ok(()));
    let (q, v, a) = ([0.3, 0.2, 0.1], [0.5, -0.7, 0.9], [0.1, 0.2, 0.3]);
    let splat_lanes = |x: [f64; 3]| SVector::from(x.map(f64x4::splat));
    let tau = robots.inverse_dynamics(&splat_lanes(q), &splat_lanes(v), &splat_lanes(a));
    for k in 0..4 {
        let mut one = Arm::<f64>::from_file(0.1 * k as f64);
        (one.fore.mass, one.elbow_friction) = (2.0 + 0.5 * k as f64, 0.1 * k as f64);
        let expected = one.inverse_dynamics(&q.into(), &v.into(), &a.into());
        assert_close(format!("lane {k}"), tau.map(|x| x[k]).as_slice(), expected.as_slice(), 1e-14);
    }
    robots.fore.mass = Lanes([2.0, 2.0, -2.0, 2.0]);
    assert_eq!(robots.validate().unwrap_err().parameters, ["fore.mass"]);
}

#[test]
fn physically_impossible_parameters_are_reported() {
    let sound = Arm::<f64>::from_file(1.0);
    assert_eq!(sound.validate(), Ok(()));
    let fault_after_change = |change: fn(&mut Arm<f64>)| {
        let mut arm = sound;
        change(&mut arm);
        let error = arm.validate().unwrap_err();
        (error.fault, error.figure, error.parameters.first().copied())
    };
    assert_eq!(
        fault_after_change(|arm| arm.fore.mass = -1.0),
        (Fault::Negative, "the mass of `fore`", Some("fore.mass"))
    );
    let (fault, figure, _) = fault_after_change(|arm| arm.fore.izz = 0.04);
    assert_eq!((fault, figure), (Fault::Inertia, "the inertia of `fore`"));
    assert_eq!(fault_after_change(|arm| arm.fore.com[1] = f64::NAN).2, Some("fore.com[1]"));
    assert_eq!(
        fault_after_change(|arm| arm.elbow_damping = -0.1),
        (Fault::Negative, "the damping of `elbow`", Some("elbow_damping"))
    );
    assert_eq!(fault_after_change(|arm| arm.slide_placement.rpy[2] = f64::INFINITY).0, Fault::NotFinite);
    assert_eq!(fault_after_change(|arm| arm.slide_placement.xyz[2] = 1e90).0, Fault::TooLarge);
}

/// Panda arm in which the mass properties of all links are parameters. A second variant has only one such
/// link.
#[mechanism(
    urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"],
    regressor, prepare, parameters = inertial
)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Panda;
#[mechanism(
    urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"],
    regressor, parameters = inertial("panda_link7")
)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct PandaWithWristParameters;
#[mechanism(
    urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"],
    regressor, scalar = f32, parameters = inertial("panda_link7")
)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct SinglePrecisionPandaWithWristParameters;

/// Returns other inertial parameters of a physically consistent body: part of the known body's density, and
/// two point masses.
fn physically_consistent_inertial(random: &mut Random, link: &Inertial<f64>) -> Inertial<f64> {
    let mut random_point_mass = || {
        Inertial::point(
            link.mass * (0.06 + random.uniform_number(0.05)),
            random.random_vector::<3>(0.06).into(),
        )
    };
    let (a, b) = (random_point_mass(), random_point_mass());
    let [x, y, z] = link.com;
    let shifted_inertial =
        |p: Inertial<f64>| Inertial { com: [x + p.com[0], y + p.com[1], z + p.com[2]], ..p };
    link.scaled(0.95).plus(&shifted_inertial(a)).plus(&shifted_inertial(b))
}

/// Checks that two robots have the same inverse dynamics in random motions. They may differ only in
/// parameters without effect.
fn check_same_torques(one: &Panda, other: &Panda) {
    let mut random = Random::new(2);
    for _ in 0..20 {
        let [q, v, a] = [random.random_vector(2.0), random.random_vector(2.0), random.random_vector(3.0)];
        let (one, other) = (one.inverse_dynamics(&q, &v, &a), other.inverse_dynamics(&q, &v, &a));
        assert_close_relative_to_largest("torques", one.as_slice(), other.as_slice(), 1e-8);
    }
}

#[test]
fn identified_base_parameters_convert_to_mass_parameters() {
    let mut random = Random::new(17);
    for _ in 0..3 {
        let mut truth = Panda::FILE;
        truth
            .set_inertials(&truth.inertials().map(|link| physically_consistent_inertial(&mut random, &link)));
        assert_eq!(truth.validate(), Ok(()));
        let base = truth.base_parameters(&truth.standard_parameters());
        let mut found = Panda::FILE;
        found.set_base_parameters(&base).unwrap();
        assert_eq!(found.validate(), Ok(()));
        let again = found.base_parameters(&found.standard_parameters());
        assert_close_relative_to_largest("base parameters", again.as_slice(), base.as_slice(), 1e-9);
        check_same_torques(&found, &truth);
        // The bodies differ: combinations of parameters without effect on the torques cannot be identified.
        assert_ne!(found, truth);
        // Setting the same base parameters again does not change the result.
        let before = found;
        found.set_base_parameters(&base).unwrap();
        for (one, other) in found.inertials().iter().zip(before.inertials()) {
            assert_close("kept", &one.to_standard(), &other.to_standard(), 1e-7);
        }
    }
    // The base parameters of the file are reproduced by its own links, except by links at the bound of
    // physical consistency.
    let mut same = Panda::FILE;
    same.set_base_parameters(&same.base_parameters(&same.standard_parameters())).unwrap();
    check_same_torques(&same, &Panda::FILE);
}

#[test]
fn noisy_identification_yields_physical_bodies() {
    let mut random = Random::new(23);
    let file = Panda::FILE;
    let base = file.base_parameters(&file.standard_parameters());
    for (noise, most) in [(0.02, 0.05), (0.3, 0.5)] {
        let noisy = base.map(|x| x * (1.0 + random.uniform_number(noise)));
        let mut found = file;
        approach(&mut found, &noisy, 1e-6).unwrap();
        assert_eq!(found.validate(), Ok(()));
        let again = found.base_parameters(&found.standard_parameters());
        assert!((again - noisy).amax() < most * base.amax(), "{}", (again - noisy).amax());
    }
    // Without noise the result deviates only by the softness of the approximation.
    let mut found = file;
    approach(&mut found, &base, 1e-6).unwrap();
    let again = found.base_parameters(&found.standard_parameters());
    assert_close_relative_to_largest("base parameters", again.as_slice(), base.as_slice(), 1e-4);
    assert!(approach(&mut found, &base, -1.0).is_err());
}

#[test]
fn infeasible_identification_is_an_error_without_changes() {
    let file = Panda::FILE;
    let base = file.base_parameters(&file.standard_parameters());
    let mut found = file;
    assert!(
        matches!(found.set_base_parameters(&-base), Err(PutBackError::NotPhysical { residual }) if residual > 0.0)
    );
    assert_eq!(found, file);
    assert_eq!(found.set_base_parameters(&base.map(|_| f64::NAN)), Err(PutBackError::NotFinite));
    assert_eq!(found, file);
    found.panda_link3.mass = 0.0;
    let before = found;
    let k = linkwork::index_of(&Panda::LINKS, "panda_link3").unwrap();
    assert_eq!(found.set_base_parameters(&base), Err(PutBackError::Prior { link: k }));
    assert_eq!(found, before);
}

/// Checks that base parameters of an arm with a load can be written back to the only link whose mass
/// properties are parameters, also in single precision.
macro_rules! one_link {
    ($robot:ident, $scalar:ty, $tolerance:literal) => {{
        let mut truth = $robot::FILE;
        truth.panda_link7 = truth.panda_link7.plus(&Inertial::point(0.8, [0.0, 0.05, 0.1]));
        let base = truth.base_parameters(&truth.standard_parameters());
        let mut found = $robot::FILE;
        found.set_base_parameters(&base).unwrap();
        assert_eq!(found.validate(), Ok(()));
        let again = found.base_parameters(&found.standard_parameters());
        let off = (again - base).amax();
        assert!(off < $tolerance * base.amax(), "{off}");
        let q = SVector::repeat(0.4 as $scalar);
        let (one, other) = (found.bias_forces(&q, &q), truth.bias_forces(&q, &q));
        assert!((one - other).amax() < $tolerance * other.amax());
        assert!((found.panda_link7.mass - $robot::FILE.panda_link7.mass).abs() > 0.1);
    }};
}

#[test]
fn base_parameters_of_a_load_are_written_to_one_link() {
    one_link!(PandaWithWristParameters, f64, 1e-6);
    one_link!(SinglePrecisionPandaWithWristParameters, f32, 2e-2);
}

/// Frames of links whose placement is a parameter are at the placement that the parameter states.
#[test]
fn calibrated_placements_move_frames() {
    let mut arm = Arm::<f64>::from_file(0.0);
    let q = [0.0; 3].into();
    let position_of_fore =
        |arm: &Arm<f64>| arm.frame_placement(frame!(Arm<f64>, "fore"), &q).translation.vector;
    let before = position_of_fore(&arm);
    arm.elbow_placement.xyz[0] += 0.01;
    assert_close("moved", (position_of_fore(&arm) - before).as_slice(), &[0.01, 0.0, 0.0], 1e-15);
}
