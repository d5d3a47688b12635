//! Checks of inverse kinematics: random reachable placements are reached within joint limits, and unreachable
//! ones return typed errors.

use linkwork::inverse_kinematics::{InverseKinematics, Target, Unreached};
use linkwork::prelude::*;
use linkwork::{Frames, index_of};
use support::random::Random;

#[mechanism(urdf = "../models/urdf/ur5.urdf")]
struct Ur5;

#[mechanism(urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"])]
struct Panda;

#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free)]
struct Solo;

fn frame_index(frames: &[&str], name: &str) -> usize {
    index_of(frames, name).unwrap_or_else(|| panic!("no {name} among {frames:?}"))
}

/// Returns a random configuration within the limits, a tenth of the range away from them.
fn random_configuration_within_limits<const NV: usize>(
    random: &mut Random,
    m: &impl Limits<NV, NV, Scalar = f64>,
) -> SVector<f64, NV> {
    let (lower, upper) = (m.lower_limits(), m.upper_limits());
    SVector::from_fn(|k, _| {
        let (low, high) = (lower[k].max(-3.0), upper[k].min(3.0));
        0.5 * (low + high) + 0.4 * (high - low) * random.uniform_number(1.0)
    })
}

/// Starts the search near known solutions and checks that it ends there, within the limits. Returns the
/// number of successes out of `tries`.
fn count_reached_targets<M, const N: usize, const NU: usize>(
    m: &M,
    tool: usize,
    off: f64,
    tries: u64,
) -> usize
where
    M: Mechanism<N, N, NU, Scalar = f64> + Frames<N, N, Scalar = f64> + Limits<N, N, Scalar = f64>,
{
    let mut count = 0;
    for seed in 0..tries {
        let mut random = Random::new(seed);
        let there = random_configuration_within_limits(&mut random, m);
        let start = there + random.random_vector::<N>(off);
        let placement = m.placement_of(tool, 0.0, &there).expect("it is a frame");
        let found = InverseKinematics::new().reach(m, 0.0, &[Target::pose(tool, placement)], &start);
        let Ok(found) = found else { continue };
        count += 1;
        let now = m.placement_of(tool, 0.0, &found.q).expect("it is a frame");
        assert!((now.translation.vector - placement.translation.vector).norm() <= 1e-6);
        assert!((now.rotation.matrix() - placement.rotation.matrix()).amax() <= 1e-6);
        let (lower, upper) = (m.lower_limits(), m.upper_limits());
        assert!((0..N).all(|k| lower[k] <= found.q[k] && found.q[k] <= upper[k]), "{}", found.q);
        assert!(found.iterations <= 100);
    }
    count
}

#[test]
fn reachable_targets_are_reached() {
    let tool = frame_index(<Ur5 as Frames<6, 6>>::FRAMES, "tool0");
    let hand = frame_index(<Panda as Frames<7, 7>>::FRAMES, "panda_hand");
    let found = [
        count_reached_targets(&Ur5, tool, 0.3, 100),
        count_reached_targets(&Panda, hand, 0.3, 100),
        count_reached_targets(&Ur5, tool, 1.0, 100),
        count_reached_targets(&Panda, hand, 1.0, 100),
    ];
    println!("{found:?}");
    assert!(found[0] >= 99 && found[1] >= 99 && found[2] >= 95 && found[3] >= 90, "{found:?}");
}

/// Four feet with a free base are reached at once. Directions that the targets do not determine stay near the
/// start.
#[test]
fn several_frame_targets_are_reached_together() {
    let mut random = Random::new(4);
    let frames = <Solo as Frames<19, 18>>::FRAMES;
    let feet = ["FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT"].map(|name| frame_index(frames, name));
    let mut bent = Solo.neutral();
    for (k, angle) in [0.0, 0.7, -1.4].iter().cycle().take(12).enumerate() {
        bent[7 + k] = *angle;
    }
    let moved = Solo.integrate(&bent, &random.random_vector(0.1));
    let targets = feet.map(|foot| {
        let there = Solo.placement_of(foot, 0.0, &moved).expect("it is a frame");
        Target::position(foot, there.translation.vector)
    });
    let found = InverseKinematics::new().reach(&Solo, 0.0, &targets, &bent).expect("it is in reach");
    for target in &targets {
        let now = Solo.placement_of(target.frame, 0.0, &found.q).expect("it is a frame");
        assert!((now.translation.vector - target.placement.translation.vector).norm() <= 1e-6);
    }
    // Six of eighteen degrees of freedom are undetermined: the robot moves no farther than to the
    // configuration that defined the targets.
    let distance_from_bent = |q| Solo.difference(&bent, q).norm();
    assert!(
        distance_from_bent(&found.q) <= distance_from_bent(&moved) * 1.01,
        "{} {}",
        distance_from_bent(&found.q),
        distance_from_bent(&moved)
    );
    assert!((found.q.fixed_rows::<4>(3).norm() - 1.0).abs() < 1e-12);
}

#[test]
fn invalid_targets_are_errors() {
    let (tool, start) = (frame_index(<Ur5 as Frames<6, 6>>::FRAMES, "tool0"), SVector::from([0.3; 6]));
    let search_for_target = |target| InverseKinematics::new().reach(&Ur5, 0.0, &[target], &start);
    // Three metres are more than the length of the arm.
    let Err(Unreached::OutOfReach { q, position, iterations, .. }) =
        search_for_target(Target::position(tool, [3.0, 0.0, 0.0].into()))
    else {
        panic!("it is out of reach")
    };
    assert!(iterations == 100 && q.iter().all(|x| x.is_finite()));
    assert!((1.9..2.2).contains(&position), "the arm points there: {position}");
    let far = search_for_target(Target::position(10_000, [0.3, 0.0, 0.0].into()));
    assert_eq!(far, Err(Unreached::UnknownFrame { target: 0 }));
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(
            search_for_target(Target::position(tool, [bad, 0.0, 0.0].into())),
            Err(Unreached::NotFinite { target: 0 })
        );
    }
    let negative = Target { position: -1.0, ..Target::position(tool, [0.3, 0.0, 0.0].into()) };
    assert_eq!(search_for_target(negative), Err(Unreached::NotFinite { target: 0 }));
    // An empty list of targets is reached without iterations.
    assert_eq!(InverseKinematics::new().reach(&Ur5, 0.0, &[], &start).map(|found| found.iterations), Ok(0));
}
