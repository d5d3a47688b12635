//! Checks of published robots against the reference values in `data/robots` (Pinocchio 4.1.0), and of the
//! consistency of their functions.

use linkwork::nalgebra::SVector;
use linkwork::{Mechanism, frame};
use support::compare::assert_close;
use support::robots::*;
use support::table::Record;

/// Tolerance of mass matrix, bias forces, inverse dynamics and energies.
const DYNAMICS: f64 = 1e-11;
/// Tolerance of forward dynamics, which includes the condition of the mass matrix.
const FORWARD: f64 = 1e-9;
/// Tolerance of frame placements, Jacobians and velocities against the reference values.
const KINEMATICS: f64 = 1e-12;

fn load_robot_reference_record(robot: &str) -> Record {
    Record::load(&format!("robots/{robot}.json"))
}

/// Checks all functions of the trait `Mechanism` for which the tables have reference values.
fn compare_dynamics_with_reference<M, const NQ: usize, const NV: usize, const NU: usize>(
    robot: &M,
    name: &str,
) where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    for (i, case) in load_robot_reference_record(name).records_with_key("cases").iter().enumerate() {
        let label_of_case = |what: &str| format!("{name}, case {i}: {what}");
        let (q, v, a, tau) = (
            &case.vector_with_key("q"),
            &case.vector_with_key("v"),
            &case.vector_with_key("a"),
            &case.vector_with_key("tau"),
        );
        let mass_matrix = case.symmetric_matrix_with_key::<NV>("M");

        assert_close(
            label_of_case("mass matrix"),
            robot.mass_matrix(0.0, q).as_slice(),
            mass_matrix.as_slice(),
            DYNAMICS,
        );
        let bias = robot.bias_forces(0.0, q, v);
        assert_close(label_of_case("bias forces"), bias.as_slice(), &case.numbers_with_key("nle"), DYNAMICS);
        let inverse = robot.inverse_dynamics(0.0, q, v, a);
        assert_close(
            label_of_case("inverse dynamics"),
            inverse.as_slice(),
            &case.numbers_with_key("rnea"),
            DYNAMICS,
        );
        let forward = robot.forward_dynamics(0.0, q, v, tau);
        assert_close(
            label_of_case("forward dynamics"),
            forward.as_slice(),
            &case.numbers_with_key("aba"),
            FORWARD,
        );
        let energies = [robot.kinetic_energy(0.0, q, v), robot.potential_energy(0.0, q)];
        let expected = [case.number_with_key("kinetic_energy"), case.number_with_key("potential_energy")];
        assert_close(label_of_case("energies"), &energies, &expected, DYNAMICS);
        let momentum = robot.generalized_momentum(0.0, q, v);
        assert_close(label_of_case("p = M v"), momentum.as_slice(), (mass_matrix * v).as_slice(), DYNAMICS);
    }
}

/// Checks the inputs of a robot: one for each moving joint, with the names and the order of the reference,
/// and each with its force on that joint.
fn check_inputs<M, const NQ: usize, const NV: usize, const NU: usize>(robot: &M, name: &str)
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let joints = load_robot_reference_record(name).strings_with_key("velocities");
    let joints = &joints[joints.len() - NU..];
    assert_eq!(M::INPUTS[..], *joints);
    assert_eq!(M::VELOCITIES[NV - NU..], *joints);
    assert_eq!(M::CONFIGURATION[NQ - NU..], *joints);

    let u = SVector::from_fn(|i, _| i as f64 + 0.5);
    let forces = robot.generalized_forces(0.0, &robot.neutral(), &SVector::zeros(), &u);
    for (i, force) in forces.iter().enumerate() {
        let expected = if i < NV - NU { 0.0 } else { u[i - (NV - NU)] };
        assert_eq!(*force, expected, "{name}: force on velocity {i}");
    }
}

/// Checks the placements of all links, in any order.
macro_rules! check_frames {
    ($robot:ident, $name:literal) => {
        for (i, case) in load_robot_reference_record($name).records_with_key("cases").iter().enumerate() {
            let placements = $robot.frame_placements(&case.vector_with_key("q"));
            for (link, expected) in case.number_lists_with_names("frames") {
                let index = $robot::FRAMES.iter().position(|frame| *frame == link);
                let placement = placements[index.unwrap_or_else(|| panic!("no frame `{link}`"))];
                let rotation = placement.rotation.matrix().transpose();
                let actual = [rotation.as_slice(), placement.translation.vector.as_slice()].concat();
                assert_close(format!("{}, case {i}: {link}", $name), &actual, &expected, KINEMATICS);
            }
        }
    };
}

/// Checks the motion of the last link, and of the robot as a whole.
macro_rules! check_kinematics {
    ($robot:ident, $name:literal, $last:literal) => {
        assert_eq!(load_robot_reference_record($name).string_with_key("last_link"), $last);
        let last = frame!($robot, $last);
        for (i, case) in load_robot_reference_record($name).records_with_key("cases").iter().enumerate() {
            let label_of_case = |what: &str| format!("{}, case {i}: {what}", $name);
            let (q, v, a) =
                (&case.vector_with_key("q"), &case.vector_with_key("v"), &case.vector_with_key("a"));

            let velocity = $robot.frame_velocity(last, q, v);
            assert_close(
                label_of_case("velocity"),
                velocity.as_slice(),
                &case.numbers_with_key("v_last"),
                KINEMATICS,
            );
            let acceleration = $robot.frame_acceleration(last, q, v, a);
            assert_close(
                label_of_case("acceleration"),
                acceleration.as_slice(),
                &case.numbers_with_key("a_last_classical"),
                KINEMATICS,
            );
            let jacobian = $robot.frame_jacobian(last, q);
            let expected = case.matrix_with_key::<6, { $robot::NV }>("J_last");
            assert_close(label_of_case("Jacobian"), jacobian.as_slice(), expected.as_slice(), KINEMATICS);

            let center = $robot.center_of_mass(q);
            assert_close(
                label_of_case("centre of mass"),
                center.as_slice(),
                &case.numbers_with_key("com"),
                DYNAMICS,
            );
            let momentum = $robot.momentum(q, v);
            assert_close(
                label_of_case("momentum"),
                momentum.as_slice(),
                &case.numbers_with_key("centroidal_momentum"),
                DYNAMICS,
            );
        }
    };
}

macro_rules! robot {
    ($module:ident, $robot:ident, $name:literal, $last:literal) => {
        mod $module {
            use super::*;

            #[test]
            fn robot_dynamics_agree_with_pinocchio() {
                compare_dynamics_with_reference(&$robot, $name);
            }

            #[test]
            fn robot_inputs_agree_with_pinocchio() {
                check_inputs(&$robot, $name);
            }

            #[test]
            fn robot_frames_agree_with_pinocchio() {
                check_frames!($robot, $name);
            }

            #[test]
            fn robot_kinematics_agree_with_pinocchio() {
                check_kinematics!($robot, $name, $last);
            }
        }
    };
}

robot!(cartpole, CartPole, "cartpole", "pole");
robot!(double_pendulum, DoublePendulum, "double_pendulum", "link3");
robot!(ur5, Ur5, "ur5", "tool0");
robot!(kinova, Kinova, "kinova", "j2s6s200_link_finger_tip_2");
robot!(gen3, Gen3, "gen3", "EndEffector_Link");
robot!(panda, Panda, "panda", "panda_rightfinger");
robot!(solo12, Solo12, "solo12", "HR_FOOT");
robot!(anymal_b, AnymalB, "anymal_b", "RH_FOOT");
robot!(simple_humanoid, Humanoid, "simple_humanoid", "r_wrist");
robot!(g1, G1, "g1", "right_rubber_hand");

/// Checks of the Panda arm whose second finger follows the first one, so that it has one coordinate less.
mod panda_mimic {
    use super::*;

    #[test]
    fn mimic_panda_dynamics_agree_with_pinocchio() {
        let robot = PandaMimic;
        for (i, case) in
            load_robot_reference_record("panda_mimic").records_with_key("cases").iter().enumerate()
        {
            let label_of_case = |what: &str| format!("panda with mimic, case {i}: {what}");
            let (q, v, a) =
                (&case.vector_with_key("q"), &case.vector_with_key("v"), &case.vector_with_key("a"));
            let mass_matrix = case.symmetric_matrix_with_key::<{ PandaMimic::NV }>("M");
            assert_close(
                label_of_case("mass matrix"),
                robot.mass_matrix(q).as_slice(),
                mass_matrix.as_slice(),
                DYNAMICS,
            );
            assert_close(
                label_of_case("bias forces"),
                robot.bias_forces(q, v).as_slice(),
                &case.numbers_with_key("nle"),
                DYNAMICS,
            );
            let forces = robot.inverse_dynamics(q, v, a);
            assert_close(
                label_of_case("inverse dynamics"),
                forces.as_slice(),
                &case.numbers_with_key("rnea"),
                DYNAMICS,
            );
            let acceleration = robot.forward_dynamics(q, v, &case.vector_with_key("rnea"));
            assert_close(label_of_case("forward dynamics"), acceleration.as_slice(), a.as_slice(), FORWARD);
        }
    }

    #[test]
    fn mimic_panda_inputs_agree_with_pinocchio() {
        check_inputs(&PandaMimic, "panda_mimic");
    }

    #[test]
    fn mimic_panda_frames_agree_with_pinocchio() {
        check_frames!(PandaMimic, "panda_mimic");
    }

    /// The mimic joint gives the dynamics of an independent second finger that moves identically to the
    /// first.
    #[test]
    fn mimic_joint_equals_an_independent_identical_finger() {
        for case in load_robot_reference_record("panda_mimic").records_with_key("cases") {
            let (q, v) = (case.vector_with_key::<8>("q"), case.vector_with_key::<8>("v"));
            let (q_free, v_free) = (q.insert_row(8, q[7]), v.insert_row(8, v[7]));
            let energies = [PandaMimic.kinetic_energy(&q, &v), PandaMimic.potential_energy(&q)];
            let expected = [Panda.kinetic_energy(&q_free, &v_free), Panda.potential_energy(&q_free)];
            assert_close("energies", &energies, &expected, DYNAMICS);
            let momentum = PandaMimic.momentum(&q, &v);
            assert_close(
                "momentum",
                momentum.as_slice(),
                Panda.momentum(&q_free, &v_free).as_slice(),
                DYNAMICS,
            );
        }
    }
}

/// Locked joints stay at zero: rows and columns of the other joints remain.
#[test]
fn locked_joints_stay_at_zero() {
    for case in load_robot_reference_record("panda").records_with_key("cases") {
        let [q, v, a] =
            ["q", "v", "a"].map(|key| case.vector_with_key::<9>(key).fixed_rows::<7>(0).into_owned());
        let insert_zero_finger_entries = |x: SVector<f64, 7>| x.insert_rows(7, 2, 0.0);
        let [q_free, v_free, a_free] =
            [q, v, a].map(|x| SVector::from_fn(|i, _| insert_zero_finger_entries(x)[i]));

        let mass_matrix = Panda.mass_matrix(&q_free).fixed_view::<7, 7>(0, 0).into_owned();
        assert_close("mass matrix", PandaArm.mass_matrix(&q).as_slice(), mass_matrix.as_slice(), DYNAMICS);
        let forces = Panda.inverse_dynamics(&q_free, &v_free, &a_free).fixed_rows::<7>(0).into_owned();
        assert_close("forces", PandaArm.inverse_dynamics(&q, &v, &a).as_slice(), forces.as_slice(), DYNAMICS);
        let hand = PandaArm.frame_placement(frame!(PandaArm, "panda_rightfinger"), &q);
        let expected = Panda.frame_placement(frame!(Panda, "panda_rightfinger"), &q_free);
        let error = hand.to_homogeneous() - expected.to_homogeneous();
        assert!(error.amax() <= KINEMATICS, "{error}");
    }
}
