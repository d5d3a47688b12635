//! Properties of joints: names, order, and equivalence to chains of simpler joints.

use super::{IDENTITY, check_bias_quadratic_in_velocity};
use linkwork::nalgebra::{SMatrix, SVector, Vector3};
use linkwork::{frame, mechanism};
use support::compare::{assert_close, assert_same_dynamics};
use support::mechanisms::*;
use support::random::Random;

#[test]
fn coordinate_names_follow_their_joints() {
    assert_eq!(OnPin::CONFIGURATION, ["pivot", "joint"]);
    assert_eq!(OnSlot::CONFIGURATION, ["pivot", "joint.slide", "joint.turn"]);
    assert_eq!(OnCollar::VELOCITIES, ["pivot", "joint.slide", "joint.turn"]);
    assert_eq!(OnUniversal::CONFIGURATION, ["pivot", "joint.first", "joint.second"]);
    assert_eq!(OnPlanar::CONFIGURATION, ["pivot", "joint.x", "joint.y", "joint.angle"]);
    assert_eq!(OnStage::CONFIGURATION, ["pivot", "joint.x", "joint.y"]);
    assert_eq!(OnStage3::VELOCITIES, ["pivot", "joint.x", "joint.y", "joint.z"]);
    assert_eq!(OnBall::CONFIGURATION, ["pivot", "joint.qx", "joint.qy", "joint.qz", "joint.qw"]);
    assert_eq!(OnBall::VELOCITIES, ["pivot", "joint.wx", "joint.wy", "joint.wz"]);
    assert_eq!(
        OnFree::CONFIGURATION,
        ["pivot", "joint.x", "joint.y", "joint.z", "joint.qx", "joint.qy", "joint.qz", "joint.qw"]
    );
    assert_eq!(
        OnFree::VELOCITIES,
        ["pivot", "joint.vx", "joint.vy", "joint.vz", "joint.wx", "joint.wy", "joint.wz"]
    );
    assert_eq!(OnWeld::CONFIGURATION, ["pivot"]);
}

/// Coordinates are in the order in which joints are declared, for any order along the tree.
#[test]
fn joints_may_be_declared_in_any_order() {
    macro_rules! arm {
        ($name:ident: $($joints:tt)*) => {
            #[mechanism(gravity = -9.81 * y)]
            struct $name {
                $($joints)*
                #[body(mass = 1, com = 0.1 * x, inertia = diagonal(0.1, 0.2, 0.25))]
                hand: Body,
                #[body(mass = 3, com = 0.2 * x, inertia = diagonal(0.2, 0.3, 0.4))]
                arm: Body,
                #[body(mass = 2, com = 0.3 * y, inertia = diagonal(0.3, 0.1, 0.3))]
                sail: Body,
                #[acts(on = wrist)]
                motor: Torque,
                #[acts(on = shoulder, stiffness = 3)]
                spring: Spring,
            }
        };
    }
    arm! { FromTheGround:
        #[joint(ground -> arm, about = z)]
        shoulder: Pin,
        #[joint(arm.at(0.4 * x) -> hand, about = y)]
        wrist: Pin,
        #[joint(arm.at(0.1 * y) -> sail)]
        mast: Ball,
    }
    arm! { FromTheHand:
        #[joint(arm.at(0.1 * y) -> sail)]
        mast: Ball,
        #[joint(arm.at(0.4 * x) -> hand, about = y)]
        wrist: Pin,
        #[joint(ground -> arm, about = z)]
        shoulder: Pin,
    }
    assert_eq!(FromTheHand::CONFIGURATION, ["mast.qx", "mast.qy", "mast.qz", "mast.qw", "wrist", "shoulder"]);
    assert_eq!(FromTheHand::VELOCITIES, ["mast.wx", "mast.wy", "mast.wz", "wrist", "shoulder"]);
    check_bias_quadratic_in_velocity(&FromTheHand {});

    let (usual, turned) = (FromTheGround {}, FromTheHand {});
    let reordered_velocity = |v: &SVector<f64, 5>| SVector::from([v[2], v[3], v[4], v[1], v[0]]);
    let mut random = Random::new(15);
    let q = random.random_configuration(&usual);
    let (v, a) = (random.random_vector(1.0), random.random_vector(1.0));
    let turned_q = SVector::from([q[2], q[3], q[4], q[5], q[1], q[0]]);
    let forces = reordered_velocity(&usual.inverse_dynamics(&q, &v, &a));
    let turned_forces = turned.inverse_dynamics(&turned_q, &reordered_velocity(&v), &reordered_velocity(&a));
    assert_close("forces", turned_forces.as_slice(), forces.as_slice(), IDENTITY);
    let motor = reordered_velocity(&usual.generalized_forces(&q, &SVector::from([2.0])));
    let turned_motor = turned.generalized_forces(&turned_q, &SVector::from([2.0]));
    assert_close("motor", turned_motor.as_slice(), motor.as_slice(), IDENTITY);
}

/// A free joint moves by the exponential map of SE(3), for small and for large motions.
#[test]
fn free_joint_moves_by_the_se3_exponential() {
    let mut random = Random::new(16);
    let frame = frame!(Spacecraft, "hub");
    for size in [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.4, 0.6, 3.0, 10.0] {
        let q = random.random_configuration(&Spacecraft {});
        let mut dv: SVector<f64, 12> = random.random_vector(size);
        dv.fixed_rows_mut::<6>(6).fill(0.0);
        let (linear, angular) = (Vector3::new(dv[0], dv[1], dv[2]), Vector3::new(dv[3], dv[4], dv[5]));
        let mut twist = SMatrix::<f64, 4, 4>::zeros();
        twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&angular.cross_matrix());
        twist.fixed_view_mut::<3, 1>(0, 3).copy_from(&linear);
        let expected = Spacecraft {}.frame_placement(frame, &q).to_homogeneous() * twist.exp();
        let moved = Spacecraft {}.integrate(&q, &dv);
        let actual = Spacecraft {}.frame_placement(frame, &moved).to_homogeneous();
        assert_close(
            format!("motion of size {size}"),
            actual.as_slice(),
            expected.as_slice(),
            1e-14 * (10.0 + size),
        );
        assert_close("unit quaternion", &[moved.fixed_rows::<4>(3).norm()], &[1.0], 1e-15);
    }
}

/// Joints with several coordinates are equivalent to chains of pins and sleeves with massless bodies between
/// them.
#[test]
fn composite_joints_equal_chains_of_pins_and_sleeves() {
    assert_same_dynamics(&OnCollar {}, &ChainedCollar {}, 10, IDENTITY);
    assert_same_dynamics(&OnSlot {}, &ChainedSlot {}, 10, IDENTITY);
    assert_same_dynamics(&OnUniversal {}, &ChainedUniversal {}, 10, IDENTITY);
    assert_same_dynamics(&OnPlanar {}, &ChainedPlanar {}, 10, IDENTITY);
    assert_same_dynamics(&OnPlanarAlong {}, &ChainedPlanar {}, 10, IDENTITY);
    assert_same_dynamics(&OnStage {}, &ChainedStage {}, 10, IDENTITY);
    assert_same_dynamics(&OnStage3 {}, &ChainedStage3 {}, 10, IDENTITY);
}

/// Checks that a screw is equivalent to a collar whose displacement is the pitch times the angle.
macro_rules! check_screw {
    ($screw:expr, $pitch:expr) => {
        let (screw, collar, pitch): (_, _, f64) = ($screw, OnCollar {}, $pitch);
        let coupling = SMatrix::<f64, 3, 2>::new(1.0, 0.0, 0.0, pitch, 0.0, 1.0);
        let mut random = Random::new(8);
        for _ in 0..10 {
            let (q, v, a) = (random.random_vector(2.0), random.random_vector(2.0), random.random_vector(2.0));
            let (cq, cv, ca) = (coupling * q, coupling * v, coupling * a);
            let mass_matrix = coupling.transpose() * collar.mass_matrix(&cq) * coupling;
            assert_close("mass matrix", screw.mass_matrix(&q).as_slice(), mass_matrix.as_slice(), IDENTITY);
            let forces = coupling.transpose() * collar.inverse_dynamics(&cq, &cv, &ca);
            assert_close(
                "forces",
                screw.inverse_dynamics(&q, &v, &a).as_slice(),
                forces.as_slice(),
                IDENTITY,
            );
            let acceleration = screw.forward_dynamics(&q, &v, &forces);
            assert_close("forward dynamics", acceleration.as_slice(), a.as_slice(), IDENTITY);
            let energies = [screw.kinetic_energy(&q, &v), screw.potential_energy(&q)];
            let expected = [collar.kinetic_energy(&cq, &cv), collar.potential_energy(&cq)];
            assert_close("energies", &energies, &expected, IDENTITY);
        }
    };
}

#[test]
fn screw_joint_is_a_collar_with_a_pitch() {
    check_screw!(OnScrew {}, 0.05);
    check_screw!(OnScrewWithLead {}, 0.3 / std::f64::consts::TAU);
}

/// Checks a ball or free joint against an equivalent chain of simple joints, whose frames give state and
/// acceleration of the joint.
macro_rules! check_against_chain {
    ($joint:ident, $chain:ident, $first:literal) => {
        let (joint, chain) = ($joint {}, $chain {});
        let (socket, last) = (frame!($chain, "socket"), frame!($chain, "last"));
        let mut random = Random::new(9);
        for _ in 0..10 {
            let (q, v, a) = (random.random_vector(1.0), random.random_vector(1.0), random.random_vector(1.0));
            let relative = chain.frame_placement(socket, &q).inv_mul(&chain.frame_placement(last, &q));
            // Motion relative to the socket: that of the chain with a fixed pivot, in axes of the last body.
            let (mut v_only, mut a_only) = (v, a);
            (v_only[0], a_only[0]) = (0.0, 0.0);
            let back = chain.frame_placement(last, &q).rotation.inverse();
            let rotated_back_part =
                |x: &SVector<f64, 6>, k: usize| back * Vector3::new(x[k], x[k + 1], x[k + 2]);
            let velocity = chain.frame_velocity(last, &q, &v_only);
            let (v_linear, v_angular) = (rotated_back_part(&velocity, 0), rotated_back_part(&velocity, 3));
            let acceleration = chain.frame_acceleration(last, &q, &v_only, &a_only);
            let (a_linear, a_angular) = (
                rotated_back_part(&acceleration, 0) - v_angular.cross(&v_linear),
                rotated_back_part(&acceleration, 3),
            );

            let quaternion = linkwork::nalgebra::UnitQuaternion::from_rotation_matrix(&relative.rotation);
            let position = [q[0]].into_iter().chain(relative.translation.vector.iter().copied());
            let first = $first;
            let mut positions: Vec<f64> = position.take(first).collect();
            positions.extend(quaternion.coords.iter());
            let jq = SVector::from_column_slice(&positions);
            let pivot_and_twist_entries = |pivot: f64, linear: Vector3<f64>, angular: Vector3<f64>| {
                let all: Vec<f64> =
                    [pivot].iter().chain(&linear).take(first).chain(&angular).copied().collect();
                SVector::from_column_slice(&all)
            };
            let (jv, ja) = (
                pivot_and_twist_entries(v[0], v_linear, v_angular),
                pivot_and_twist_entries(a[0], a_linear, a_angular),
            );

            let energies = [joint.kinetic_energy(&jq, &jv), joint.potential_energy(&jq)];
            let expected = [chain.kinetic_energy(&q, &v), chain.potential_energy(&q)];
            assert_close("energies", &energies, &expected, IDENTITY);
            let placement = joint.frame_placement(frame!($joint, "carried"), &jq);
            let expected = chain.frame_placement(frame!($chain, "carried"), &q);
            let error = (placement.to_homogeneous() - expected.to_homogeneous()).amax();
            assert!(error < IDENTITY, "placement: {error:e}");
            let pivot = joint.inverse_dynamics(&jq, &jv, &ja)[0];
            assert_close("torque at the pivot", &[pivot], &[chain.inverse_dynamics(&q, &v, &a)[0]], IDENTITY);
            let power = joint.inverse_dynamics(&jq, &jv, &ja).dot(&jv);
            assert_close("power", &[power], &[chain.inverse_dynamics(&q, &v, &a).dot(&v)], IDENTITY);
        }
    };
}

#[test]
fn ball_joint_equals_three_pins() {
    check_against_chain!(OnBall, ChainedBall, 1);
}

#[test]
fn free_joint_equals_a_stage_and_three_pins() {
    check_against_chain!(OnFree, ChainedFree, 4);
}

/// Checks that bodies welded together equal one rigid body, with its mass in three particles at the corners
/// of a triangle.
#[test]
fn welded_bodies_equal_one_rigid_body() {
    #[mechanism(gravity = -9.81 * y)]
    struct WeldedBodies {
        #[body(mass = 2, com = 0.1 * x, inertia = diagonal(0.02, 0.03, 0.04))]
        first: Body,
        #[body(mass = 3, com = 0.2 * y, inertia = diagonal(0.05, 0.06, 0.07))]
        second: Body,
        #[joint(ground -> first, about = z)]
        pin: Pin,
        #[joint(first.at(0.5 * x).rotated(z(0.5)) -> second.rotated(z(0.5)))]
        weld: Weld,
    }
    // The second body has the axes of the first; its centre is at (0.5, 0.2).
    let inertia = 0.04 + 2.0 * 0.1 * 0.1 + 0.07 + 3.0 * (0.5 * 0.5 + 0.2 * 0.2);
    let (q, v) = (SVector::from([0.3]), SVector::from([1.0]));
    assert_close("inertia about the pin", WeldedBodies {}.mass_matrix(&q).as_slice(), &[inertia], IDENTITY);
    let (x, y) = (2.0 * 0.1 + 3.0 * 0.5, 3.0 * 0.2);
    let height = 0.3_f64.sin() * x + 0.3_f64.cos() * y;
    assert_close("potential energy", &[WeldedBodies {}.potential_energy(&q)], &[9.81 * height], IDENTITY);
    let lever = 0.3_f64.cos() * x - 0.3_f64.sin() * y;
    assert_close("gravity", WeldedBodies {}.bias_forces(&q, &v).as_slice(), &[9.81 * lever], IDENTITY);
}
