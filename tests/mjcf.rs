//! MJCF files of `data/mjcf` against reference values of MuJoCo in `data/mujoco`.

use linkwork::prelude::*;
use linkwork::{Limits, Mechanism};
use support::compare::assert_close;
use support::table::Record;

/// Tolerance of results: MuJoCo computes principal axes only to about 1e-11.
const TOLERANCE: f64 = 1e-10;
/// Tolerance of forward dynamics, which includes the condition of the mass matrix.
const FORWARD: f64 = 1e-9;

#[mechanism(mjcf = "data/mjcf/everything.xml")]
struct RobotOfAllMjcfElements;

#[mechanism(mjcf = "data/mjcf/free_bodies.xml")]
struct FreeBodies;

#[mechanism(mjcf = "data/mjcf/coupled.xml")]
struct FileWithCoupledJoints;

fn compare_robot_with_reference<M, const NQ: usize, const NV: usize, const NU: usize>(robot: &M, name: &str)
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let cases = Record::load(&format!("mujoco/{name}.json")).records_with_key("cases");
    assert!(cases.len() >= 4);
    for (i, case) in cases.iter().enumerate() {
        let label_of_case = |what: &str| format!("{name}, case {i}: {what}");
        let (q, v, u) = (&case.vector_with_key("q"), &case.vector_with_key("v"), &case.vector_with_key("u"));
        let mass_matrix = case.symmetric_matrix_with_key::<NV>("M");
        assert_close(
            label_of_case("mass matrix"),
            robot.mass_matrix(0.0, q).as_slice(),
            mass_matrix.as_slice(),
            TOLERANCE,
        );
        let bias = robot.bias_forces(0.0, q, v);
        assert_close(
            label_of_case("bias forces"),
            bias.as_slice(),
            &case.numbers_with_key("bias"),
            TOLERANCE,
        );
        let forces = robot.generalized_forces(0.0, q, v, u);
        assert_close(label_of_case("forces"), forces.as_slice(), &case.numbers_with_key("forces"), TOLERANCE);
        // MuJoCo's friction is a constraint and is not part of these reference values; here it is a force.
        let tau = forces + case.vector_with_key("friction");
        let a = robot.forward_dynamics(0.0, q, v, &tau);
        assert_close(label_of_case("accelerations"), a.as_slice(), &case.numbers_with_key("a"), FORWARD);
    }
}

/// Checks the placements of bodies and sites against reference values of MuJoCo.
macro_rules! check_frames {
    ($robot:ident, $name:literal) => {
        for (i, case) in
            Record::load(concat!("mujoco/", $name, ".json")).records_with_key("cases").iter().enumerate()
        {
            let placements = $robot.frame_placements(&case.vector_with_key("q"));
            for (frame, expected) in case.number_lists_with_names("frames") {
                let index = $robot::FRAMES.iter().position(|known| *known == frame);
                let placement = placements[index.unwrap_or_else(|| panic!("no frame `{frame}`"))];
                let rotation = placement.rotation.matrix().transpose();
                let found = [rotation.as_slice(), placement.translation.vector.as_slice()].concat();
                assert_close(format!("{}, case {i}: {frame}", $name), &found, &expected, TOLERANCE);
            }
        }
    };
}

#[test]
fn mjcf_joints_shapes_classes_and_servos_agree_with_mujoco() {
    assert_eq!(
        RobotOfAllMjcfElements::VELOCITIES,
        ["yaw", "pitch", "reach", "roll.wx", "roll.wy", "roll.wz", "body4_slide", "spin", "tilt"]
    );
    assert_eq!(
        RobotOfAllMjcfElements::INPUTS,
        ["yaw", "pitch_servo", "reach_velocity", "tilt", "belt", "cord"]
    );
    compare_robot_with_reference(&RobotOfAllMjcfElements, "everything");
    check_frames!(RobotOfAllMjcfElements, "everything");
}

#[test]
fn mjcf_flying_bodies_and_scaled_masses_agree_with_mujoco() {
    assert_eq!(FreeBodies::NU, 0);
    assert!((FreeBodies.total_mass() - 7.5).abs() > 1.0, "what stands on the ground moves nothing");
    compare_robot_with_reference(&FreeBodies, "free_bodies");
    check_frames!(FreeBodies, "free_bodies");
}

#[test]
fn mjcf_coupled_and_fixed_joints_agree_with_mujoco() {
    assert_eq!(FileWithCoupledJoints::VELOCITIES, ["turn", "left"]);
    assert_eq!(FileWithCoupledJoints::INPUTS, ["squeeze"]);
    compare_robot_with_reference(&FileWithCoupledJoints, "coupled");
    check_frames!(FileWithCoupledJoints, "coupled");
}

/// Checks tendons in space against MuJoCo: straight, around a ball, around a given side of a cylinder, around
/// the shorter side of one, and over pulleys. Actuators act on the tendons and on sites. Each surface
/// deflects its tendon in some cases only.
#[test]
fn mjcf_spatial_tendons_agree_with_mujoco() {
    #[mechanism(mjcf = "data/mjcf/cables.xml")]
    struct Cables;

    assert_eq!(Cables::INPUTS, ["pull", "elbow", "winch", "thrust", "spin", "reach", "twist"]);
    compare_robot_with_reference(&Cables, "cables");
}

/// Motors, filters, integrals, cylinders and muscles with their states, and polynomial springs and dampers.
/// The script `peers/drives.py` computed the reference values.
#[test]
fn mjcf_actuators_with_states_agree_with_mujoco() {
    #[mechanism(mjcf = "data/mjcf/drives.xml", derivatives)]
    #[derive(Clone, Copy)]
    struct RobotWithStatefulActuators;

    assert_eq!(
        RobotWithStatefulActuators::INPUTS[6..11],
        ["triceps", "servo_pos", "servo_vel", "servo_ff", "holding"]
    );
    assert_eq!(
        RobotWithStatefulActuators::INPUTS[14..],
        ["wound_pos", "wound_vel", "wound_ff", "wound_voltage"]
    );
    let drives = RobotWithStatefulActuators::FILE;
    let whole = drives.extended();
    let state_rates = |q: &SVector<f64, 6>, v: &SVector<f64, 18>, u: &SVector<f64, 18>| {
        whole.forward_dynamics(0.0, q, v, &whole.generalized_forces(0.0, q, v, u))
    };
    for case in Record::load("mujoco/drives.json").records_with_key("cases") {
        let (q, u) = (case.vector_with_key("q"), case.vector_with_key("u"));
        let v =
            SVector::from_column_slice(&[case.numbers_with_key("v"), case.numbers_with_key("x")].concat());
        let expected = [case.numbers_with_key("a"), case.numbers_with_key("rates")].concat();
        assert_close("rates", state_rates(&q, &v, &u).as_slice(), &expected, FORWARD);

        let linear = at(&whole, 0.0).linear_motion(&q, &v, &u);
        let step = SVector::<f64, 18>::from_fn(|k, _| (1.3 * k as f64).cos());
        let displaced_rates = |h: f64| {
            let q = whole.integrate(&q, &(step * h));
            state_rates(&q, &(v + step * h), &(u + step * h))
        };
        let slope = (displaced_rates(1e-6) - displaced_rates(-1e-6)) / 2e-6;
        let found = (linear.by_q + linear.by_v + linear.by_u) * step;
        assert_close("derivatives", found.as_slice(), slope.as_slice(), 1e-6);
    }
}

/// The drag of a medium acts on each body as on the box with the same inertia.
#[test]
fn mjcf_fluid_drag_agrees_with_mujoco() {
    #[mechanism(mjcf = "data/mjcf/medium.xml")]
    struct RobotInMedium;

    compare_robot_with_reference(&RobotInMedium, "medium");
}

/// A connection constrains two points to coincide, a weld constrains two bodies. The out-of-plane conditions
/// of a plane loop are redundant.
#[test]
fn mjcf_loops_agree_with_mujoco() {
    #[mechanism(mjcf = "data/mjcf/loops.xml")]
    struct Loops;

    assert_eq!((Loops::NV, Loops::NC, Loops::NS), (16, 2 + 6 + 3, 5));
    for (i, case) in Record::load("mujoco/loops.json").records_with_key("cases").iter().enumerate() {
        let (q, v) = (case.vector_with_key("q"), case.vector_with_key("v"));
        assert!(Loops.constraint_residuals(&q).amax() < 1e-12, "case {i}");
        assert!(Loops.constraint_rates(&q, &v).amax() < 1e-12, "case {i}");
        let (a, _) = Loops.constrained_dynamics(&q, &v, &SVector::zeros());
        assert_close(format!("loops, case {i}"), a.as_slice(), &case.numbers_with_key("a"), 1e-7);
    }
}

/// Equality constraints between coordinates, linear and polynomial, are satisfied. Actuators take their
/// parameters from a default class that several actuator shortcuts define.
#[test]
fn mjcf_coordinate_couplings_agree_with_mujoco() {
    #[mechanism(mjcf = "data/mjcf/conditions.xml")]
    struct RobotWithJointEqualities;

    // `right` is a function of `left`, since their sum is constrained.
    assert_eq!(
        (RobotWithJointEqualities::NV, RobotWithJointEqualities::NC, RobotWithJointEqualities::NU),
        (7, 3, 4)
    );
    for (i, case) in Record::load("mujoco/conditions.json").records_with_key("cases").iter().enumerate() {
        let all_numbers_and_first_seven = |what: &str| {
            let all = case.numbers_with_key(what);
            let kept: Vec<f64> = all.iter().copied().take(7).collect();
            (all, kept)
        };
        let ((q, own_q), (v, own_v), (a, own_a)) = (
            all_numbers_and_first_seven("q"),
            all_numbers_and_first_seven("v"),
            all_numbers_and_first_seven("a"),
        );
        assert!((q[7] - (-0.2 + 2.0 * q[6] - 0.4)).abs() < 1e-12 && (v[7] - 2.0 * v[6]).abs() < 1e-12);
        let (q, v) = (SVector::from_vec(own_q), SVector::from_vec(own_v));
        assert!(RobotWithJointEqualities.constraint_residuals(&q).amax() < 1e-12, "case {i}");
        assert!(RobotWithJointEqualities.constraint_rates(&q, &v).amax() < 1e-12, "case {i}");
        let (found, _) = RobotWithJointEqualities.constrained_dynamics(&q, &v, &SVector::zeros());
        assert_close(format!("conditions, case {i}"), found.as_slice(), &own_a, 1e-7);
        assert!((a[7] - 2.0 * a[6]).abs() < 1e-9);
    }
}

/// A contact can refer to shapes of the file: here a box stands on its corners next to a ball.
#[test]
fn contacts_refer_to_mjcf_shapes() {
    #[mechanism(mjcf = "data/mjcf/contacts.xml")]
    struct RobotShapeContacts {
        #[contact(collision(), ground.plane(z), friction = 0.5)]
        floor: Contact,
    }

    let mut q = RobotShapeContacts {}.neutral();
    (q[2], q[9]) = (0.5, 0.4);
    let gaps = RobotShapeContacts {}.contact_gaps(&q);
    // Eight corners of the box, the ends of the capsule, the ellipsoid.
    let expected = [0.4, 0.4, 0.4, 0.4, 0.6, 0.6, 0.6, 0.6, 0.7 - 0.05, 0.9 - 0.05, 0.4 - 0.2];
    let mut found: Vec<f64> = gaps.iter().copied().collect();
    found[..8].sort_by(f64::total_cmp);
    found[8..10].sort_by(f64::total_cmp);
    assert_close("gaps", &found, &expected, 1e-12);
}

/// Checks contacts that are read from the file: each shape collides with the plane of its world, with the
/// larger of the two coefficients of friction.
#[test]
fn mjcf_contacts_are_read_from_the_file() -> Result<(), linkwork::integrate::Error> {
    #[mechanism(mjcf = "data/mjcf/contacts.xml", contacts = file)]
    struct ContactsOfMjcfFile;

    assert_eq!(
        (ContactsOfMjcfFile::CONTACTS.len(), ContactsOfMjcfFile::CONTACTS[0]),
        (11, "box_geom0_contact.0")
    );
    let (mut q, mut v) = (ContactsOfMjcfFile.neutral(), SVector::zeros());
    (q[2], q[9], v[0]) = (0.1, 2.0, 1.0);
    let end =
        simulate(&ContactsOfMjcfFile).from(q, v).method(TimeStepping::step(1e-3)).duration(0.1).finish()?;
    assert!((end.v[0] - (1.0 - 0.4 * 9.81 * 0.1)).abs() < 1e-9, "{}", end.v[0]);
    assert!((end.v[8] + 0.981).abs() < 1e-9, "the egg falls beside it");
    Ok(())
}

/// Checks the options that change or omit parts of a file.
#[test]
fn mjcf_options_change_or_omit_elements() {
    #[mechanism(mjcf = "data/mjcf/coupled.xml", mimic = independent, inputs = joints, passive = ignore)]
    struct FileWithIndependentMimics;
    #[mechanism(mjcf = "data/mjcf/coupled.xml", inputs = none, lock = ["left"], gravity = -3.7 * z)]
    struct FileWithLockedJoints;

    assert_eq!(FileWithIndependentMimics::VELOCITIES, ["turn", "left", "right", "flap"]);
    assert_eq!(FileWithIndependentMimics::INPUTS, FileWithIndependentMimics::VELOCITIES);
    let (q, v) = ([0.3, 0.1, 0.2, -0.4].into(), [0.5, -1.0, 2.0, 0.7].into());
    assert_eq!(FileWithIndependentMimics.dissipated_power(&q, &v), 0.0);
    // The inertia of the rotor remains, since it is no passive force.
    let with_rotor = FileWithCoupledJoints.mass_matrix(&[0.0, 0.02].into())[3];
    assert!(with_rotor > 7.5 * 7.5 * 0.01);

    // A joint that follows a locked joint is locked, too.
    assert_eq!((FileWithLockedJoints::NV, FileWithLockedJoints::NU), (1, 0));
    let fall = FileWithLockedJoints.bias_forces(&[0.0].into(), &[0.0].into())[0];
    let there = FileWithCoupledJoints.bias_forces(&[0.0, 0.0].into(), &[0.0, 0.0].into())[0];
    assert!((fall / there - 3.7 / 9.81).abs() < 1e-12, "{fall} {there}");
}

/// Limits are in the file's units. The effort limit of a joint is the smaller of its motors' total and the
/// joint's own.
#[test]
fn mjcf_limits_have_the_units_of_the_file() {
    let (lower, upper) = (RobotOfAllMjcfElements.lower_limits(), RobotOfAllMjcfElements.upper_limits());
    assert_close("angles", &[lower[0], upper[0]], &[-90.0, 120.0].map(f64::to_radians), 1e-15);
    assert_eq!([lower[2], upper[2], lower[1]], [-0.1, 0.4, f64::NEG_INFINITY]);
    let efforts = RobotOfAllMjcfElements.effort_limits();
    // The servo of a tendon drives the first joint, too, and has no limit.
    assert_eq!([efforts[0], efforts[8]], [f64::INFINITY, 9.0]);
}
