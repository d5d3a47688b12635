//! Operational-space control of a seven-axis arm: its hand moves along a circle with constant orientation,
//! while the elbow stays near a preferred posture. It uses the generated inverse mass matrix, frame Jacobian
//! and bias forces.
//!
//! Source: Khatib, *A unified approach for motion and force control of robot manipulators: the operational
//! space formulation*, IEEE Journal on Robotics and Automation 3 (1987).
//!
//! ```text
//! cargo run --release --example operational_space -p linkwork-models
//! ```

use linkwork::inverse_kinematics::{InverseKinematics, Target};
use linkwork::nalgebra::{IsometryMatrix3, Rotation3, SVector, Vector3};
use linkwork::placement_difference;
use linkwork::prelude::{Limits, Rk4, frame, index, simulate};
use linkwork_models::PandaArm;
use std::f64::consts::PI;

type JointVector = SVector<f64, 7>;
/// Twist: linear, then angular velocity, in ground axes.
type Twist = SVector<f64, 6>;

/// Preferred joint angles, rad: far from their limits, with the elbow bent.
const POSTURE: [f64; 7] = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
/// Radius of the circle that the hand follows, m.
const RADIUS: f64 = 0.12;
const RATE: f64 = 2.0;

/// Returns the desired pose, velocity and acceleration of the hand: pointing down, on a vertical circle.
fn desired_hand_motion(t: f64) -> (IsometryMatrix3<f64>, Twist, Twist) {
    let (sin, cos) = (RATE * t).sin_cos();
    let planar_twist = |y: f64, z: f64| Twist::from([0.0, RADIUS * y, RADIUS * z, 0.0, 0.0, 0.0]);
    let place = Vector3::new(0.5, RADIUS * cos, 0.45 + RADIUS * sin);
    let placement =
        IsometryMatrix3::from_parts(place.into(), Rotation3::from_axis_angle(&Vector3::x_axis(), PI));
    (placement, planar_twist(-sin, cos) * RATE, planar_twist(-cos, -sin) * RATE * RATE)
}

/// Returns the torques for the desired motion of the hand. In the nullspace of the hand's motion, they move
/// the joints towards their preferred posture.
fn hand_control_torques(t: f64, q: &JointVector, v: &JointVector) -> JointVector {
    let (arm, hand) = (PandaArm, frame!(PandaArm, "panda_hand_tcp"));
    let (placement, twist, acceleration) = desired_hand_motion(t);
    let jacobian = arm.frame_jacobian(hand, q);
    let missing = placement_difference(&arm.frame_placement(hand, q), &placement);
    // Desired acceleration of the hand with feedback, minus the part J̇ v that it has without joint
    // accelerations.
    let corrected = acceleration + missing * 400.0 + (twist - jacobian * v) * 40.0;
    let hand_acceleration = corrected - arm.frame_acceleration(hand, q, v, &JointVector::zeros());

    // The operational-space inertia Λ = (J M⁻¹ Jᵀ)⁻¹ maps the acceleration to a force.
    let inverse_mass = arm.mass_matrix_inverse(q);
    let Some(inertia) = (jacobian * inverse_mass * jacobian.transpose()).try_inverse() else {
        return arm.clamp_effort(&arm.bias_forces(q, v)); // Singular: hold still.
    };
    let posture = arm.mass_matrix(q) * ((JointVector::from(POSTURE) - q) * 25.0 - v * 10.0);
    // Posture torques projected into the nullspace: the part Jᵀ Λ J M⁻¹ that would move the hand is
    // subtracted.
    let moving = jacobian.transpose() * (inertia * (jacobian * (inverse_mass * posture)));
    let torques = jacobian.transpose() * (inertia * hand_acceleration) + posture - moving;
    // Gravity, Coriolis and centrifugal forces and friction do not depend on the acceleration.
    arm.clamp_effort(&(torques + arm.bias_forces(q, v)))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (arm, hand) = (PandaArm, frame!(PandaArm, "panda_hand_tcp"));
    // The initial configuration follows by inverse kinematics from the posture. It starts at rest, so that
    // the hand must catch up.
    let target = Target::pose(index!(PandaArm::FRAMES, "panda_hand_tcp"), desired_hand_motion(0.0).0);
    let found = InverseKinematics::new().reach(&arm, 0.0, &[target], &POSTURE.into())?;

    let run = simulate(&arm)
        .from(found.q, JointVector::zeros())
        .control_every(1e-3, hand_control_torques)
        .method(Rk4::step(1e-3))
        .duration(2.0 * PI / RATE)
        .sample_every(PI / RATE / 8.0);
    println!("   t, s     y, m     z, m   off, mm   turned, mrad   joint 3, rad   largest share of a limit");
    let limits = arm.effort_limits();
    let mut posture_kept = 0.0_f64;
    for sample in run {
        let sample = sample?;
        let is = arm.frame_placement(hand, &sample.q);
        let left = placement_difference(&is, &desired_hand_motion(sample.t).0);
        let (off, turned) = (left.fixed_rows::<3>(0).norm(), left.fixed_rows::<3>(3).norm());
        let share = sample.u.component_div(&limits).amax();
        let place = is.translation;
        println!(
            "{:7.3} {:8.4} {:8.4} {:9.4} {:14.4} {:14.4} {share:26.2}",
            sample.t,
            place.y,
            place.z,
            1e3 * off,
            1e3 * turned,
            sample.q[2]
        );
        assert!(share <= 1.0, "no motor gives more than it can");
        posture_kept = posture_kept.max((sample.q - JointVector::from(POSTURE)).amax());
        if sample.t > 1.0 {
            assert!(off < 1e-5 && turned < 1e-4, "a hundredth of a millimetre, a tenth of a milliradian");
        }
    }
    assert!(posture_kept < 0.8, "the arm stays in its posture, as far as the hand lets it");
    Ok(())
}

#[test]
fn hand_follows_the_circle() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
