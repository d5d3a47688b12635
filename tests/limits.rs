//! Joint limits of files and of structs, as generic code accesses them.

use linkwork::nalgebra::SVector;
use linkwork::{Limits, Mechanism, Real, at, mechanism};
use linkwork_models::{AnymalB, Panda, PandaArm, SimpleHumanoid, Solo12, Ur5};

const NONE: f64 = f64::INFINITY;

fn static_vector_from_array<T: Real, const N: usize>(entries: [T; N]) -> SVector<T, N> {
    SVector::from(entries)
}

/// Returns the value of an attribute in the `<limit>` of a joint, searched for as text.
fn limit_attribute_value(file: &str, joint: &str, attribute: &str) -> Option<f64> {
    let from = file.find(&format!("<joint name=\"{joint}\""))?;
    let text = &file[from..];
    let text = &text[..text.find("</joint>")?];
    let text = &text[text.find("<limit")?..];
    let text = &text[..text.find("/>")?];
    let value = text.split(&format!(" {attribute}=\"")).nth(1)?.split('"').next()?;
    Some(value.parse().unwrap())
}

/// Compares the limits of a robot without coupled joints with the text of its file. Returns the number of
/// bounds.
fn compare_limits_with_robot_file<M, const NQ: usize, const NV: usize, const NU: usize>(
    robot: &M,
    file: &str,
) -> usize
where
    M: Mechanism<NQ, NV, NU, Scalar = f64> + Limits<NQ, NV, Scalar = f64>,
{
    let mut found = 0;
    let all = [
        ("lower", robot.lower_limits(), -NONE),
        ("upper", robot.upper_limits(), NONE),
        ("velocity", robot.velocity_limits(), NONE),
        ("effort", robot.effort_limits(), NONE),
    ];
    for (attribute, limits, none) in all {
        for (name, limit) in M::VELOCITIES.iter().zip(&limits) {
            let expected = limit_attribute_value(file, name, attribute);
            assert_eq!(*limit, expected.unwrap_or(none), "{attribute} of {name}");
            found += usize::from(expected.is_some());
        }
    }
    found
}

#[test]
fn robots_have_the_joint_limits_of_their_files() {
    let text_of_urdf = |file: &str| {
        std::fs::read_to_string(format!("{}/../models/urdf/{file}.urdf", env!("CARGO_MANIFEST_DIR"))).unwrap()
    };
    assert_eq!(compare_limits_with_robot_file(&Ur5, &text_of_urdf("ur5")), 24);
    assert_eq!(compare_limits_with_robot_file(&PandaArm, &text_of_urdf("panda")), 28);
    assert_eq!(compare_limits_with_robot_file(&Solo12, &text_of_urdf("solo12")), 48);
    assert!(compare_limits_with_robot_file(&AnymalB, &text_of_urdf("anymal_b")) > 0);
    assert!(compare_limits_with_robot_file(&SimpleHumanoid, &text_of_urdf("simple_humanoid")) > 0);
}

/// Checks that the arm has the limits of Franka Emika's *Robot and interface specifications* (2021).
#[test]
fn panda_has_the_limits_of_its_data_sheet() {
    let lower = [-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973, 0.0];
    let speed = [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61, 0.2];
    assert_eq!(Panda.lower_limits(), static_vector_from_array(lower));
    assert_eq!(Panda.velocity_limits(), static_vector_from_array(speed));
    assert_eq!(Panda.effort_limits()[4], 12.0);
    // The second finger follows the first and has the same limits.
    assert_eq!((Panda.upper_limits()[7], Panda.effort_limits()[7]), (0.04, 100.0));
}

/// Robot with followers, joints without bounds, and infinite and absent values.
#[mechanism(urdf = "data/urdf/limits.urdf", lock = ["held"])]
struct RobotWithVariousLimits;

#[mechanism(urdf = "data/urdf/limits.urdf", lock = ["held"], limits = ignore)]
struct RobotWithIgnoredLimits;

#[test]
fn limits_are_read_in_every_file_format() {
    assert_eq!(RobotWithVariousLimits::VELOCITIES, ["leader", "wheel", "endless", "rail", "free"]);
    // −2 q + 0.5 from −2 to 1.5 is q from −0.5 to 1.25; the follower's maximum velocity of 4 is 2 of the
    // leader's. The effort limit of the leader is its own.
    assert_eq!(
        RobotWithVariousLimits.lower_limits(),
        static_vector_from_array([-0.5, -NONE, -NONE, -NONE, -NONE])
    );
    assert_eq!(
        RobotWithVariousLimits.upper_limits(),
        static_vector_from_array([1.25, NONE, NONE, 0.5, NONE])
    );
    assert_eq!(
        RobotWithVariousLimits.velocity_limits(),
        static_vector_from_array([2.0, 50.0, NONE, 0.0, NONE])
    );
    assert_eq!(RobotWithVariousLimits.effort_limits(), static_vector_from_array([10.0, 7.0, 5.0, 0.0, NONE]));
    assert_eq!(RobotWithIgnoredLimits.effort_limits(), static_vector_from_array([NONE; 5]));
    assert_eq!(
        RobotWithIgnoredLimits.clamp_configuration(&static_vector_from_array([9.0; 5])),
        static_vector_from_array([9.0; 5])
    );
}

#[test]
fn free_joints_have_no_limits() {
    let q = SVector::<f64, 19>::from_fn(|k, _| k as f64 - 9.0);
    let clamped = Solo12.clamp_configuration(&q);
    assert_eq!(clamped.rows(0, 7), q.rows(0, 7));
    for k in 0..12 {
        let (low, high) = (Solo12.lower_limits()[6 + k], Solo12.upper_limits()[6 + k]);
        assert_eq!(clamped[7 + k], q[7 + k].max(low).min(high));
        assert!(clamped[7 + k] != q[7 + k] || (low..=high).contains(&q[7 + k]));
    }
    assert_eq!(Solo12.velocity_limits().rows(0, 6), SVector::<f64, 6>::repeat(NONE));
}

/// Hand on a slide with a coordinate of its own. Its limits are parameters, given in several fields.
#[mechanism(gravity = -9.81 * z, prepare)]
struct Hand<T> {
    reach: T,
    strength: T,
    #[body(mass = 1, com = reach / 3 * x, inertia = sphere(1, 1))]
    palm: Body,
    #[joint(ground -> palm, along = x, about = z)]
    slot: Slot,
    height: Coordinate,
    #[particle(mass = 2, at = height * z)]
    weight: Particle,
    #[limit(on = slot.slide, from = -reach, to = 2 * reach, max_effort = strength)]
    ends: Limit,
    #[limit(on = slot.slide, to = 3, max_speed = 0.5)]
    table: Limit,
    #[limit(on = height, from = 0)]
    floor: Limit,
}

/// Returns a velocity and an effort with all entries `x`, clamped to the limits, in generic code.
fn clamped_velocity_and_effort<M: Limits<NQ, NV>, const NQ: usize, const NV: usize>(
    m: &M,
    x: f64,
) -> [SVector<M::Scalar, NV>; 2] {
    let x = linkwork::nalgebra::convert(x);
    [m.clamp_velocity(&SVector::repeat(x)), m.clamp_effort(&SVector::repeat(x))]
}

#[test]
fn structs_declare_joint_limits() {
    let hand = Hand { reach: 1.0, strength: 4.0 };
    assert_eq!(hand.lower_limits(), static_vector_from_array([-1.0, -NONE, 0.0]));
    assert_eq!(hand.upper_limits(), static_vector_from_array([2.0, NONE, NONE]));
    assert_eq!(hand.velocity_limits(), static_vector_from_array([0.5, NONE, NONE]));
    assert_eq!(hand.effort_limits(), static_vector_from_array([4.0, NONE, NONE]));
    // Both limits apply: the second is the narrower one for a longer hand.
    let long = Hand { reach: 8.0, strength: 4.0 };
    assert_eq!((long.lower_limits()[0], long.upper_limits()[0]), (-8.0, 3.0));
    assert_eq!(long.prepare().upper_limits(), long.upper_limits());
    assert_eq!(
        long.clamp_configuration(&static_vector_from_array([9.0, 9.0, -9.0])),
        static_vector_from_array([3.0, 9.0, 0.0])
    );
    let not_a_number = long.clamp_configuration(&static_vector_from_array([f64::NAN, 0.0, 0.0]))[0];
    assert!(not_a_number.is_nan());
    let single = Hand { reach: 8.0_f32, strength: 4.0 };
    assert_eq!(single.upper_limits(), static_vector_from_array([3.0, f32::INFINITY, f32::INFINITY]));
    assert_eq!(
        clamped_velocity_and_effort(&&single, -5.0),
        [static_vector_from_array([-0.5, -5.0, -5.0]), [-4.0, -5.0, -5.0].into()]
    );
}

/// Slide whose direction rotates as a function of time.
#[mechanism]
struct SlideWithRotatingAxis {
    rate: f64,
    bead_range: f64,
    s: Coordinate,
    #[frame(ground, z(rate * t))]
    arm: Frame,
    #[particle(mass = 1, at = s * arm.x)]
    bead: Particle,
    #[limit(on = s, from = -bead_range, to = bead_range)]
    ends: Limit,
}

#[test]
fn joint_limits_are_independent_of_time() {
    let turning = SlideWithRotatingAxis { rate: 2.0, bead_range: 0.25 };
    assert_eq!(turning.upper_limits()[0], 0.25);
    assert_eq!(at(&turning, 3.0).clamp_configuration(&static_vector_from_array([-1.0]))[0], -0.25);
    assert_eq!(Mechanism::neutral(&turning)[0], 0.0);
}

/// Robot without inertia, for which only kinematics are generated.
#[mechanism(urdf = "data/urdf/limits.urdf", inertia = none)]
struct MasslessRobot;

#[test]
fn kinematic_mechanisms_have_limits() {
    assert_eq!((MasslessRobot.lower_limits()[5], MasslessRobot.upper_limits()[5]), (0.1, 0.2));
}
