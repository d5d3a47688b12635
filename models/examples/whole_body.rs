//! Whole-body control of a quadruped that moves its trunk while standing on four feet. The torques keep the
//! contact forces within their friction cones, with minimum tangential forces.
//!
//! The accelerations of the trunk and the contact forces depend linearly on the torques, by
//! [`contact::forward_dynamics_derivatives`]: `v̇ = v̇₀ + A τ`, `f = f₀ + F τ`. Among the torques with the
//! desired acceleration of the trunk, the controller selects those with the minimum tangential forces.
//! Source: Righetti, Buchli, Mistry, Kalakrishnan and Schaal, *Optimal distribution of contact forces with
//! inverse-dynamics control*, International Journal of Robotics Research 32 (2013).
//!
//! ```text
//! cargo run --release --example whole_body -p linkwork-models
//! ```

use linkwork::contact::{self, Touch};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::prelude::*;

/// Quadruped Solo 12 on the ground, with a sphere as each foot.
#[mechanism(urdf = "urdf/solo12.urdf", base = free, gravity = -9.81 * z, limits = ignore, derivatives)]
struct StandingSolo {
    #[contact(FL_FOOT.sphere(0.016), ground.plane(z), friction = 0.6)]
    front_left: Contact,
    #[contact(FR_FOOT.sphere(0.016), ground.plane(z), friction = 0.6)]
    front_right: Contact,
    #[contact(HL_FOOT.sphere(0.016), ground.plane(z), friction = 0.6)]
    hind_left: Contact,
    #[contact(HR_FOOT.sphere(0.016), ground.plane(z), friction = 0.6)]
    hind_right: Contact,
}

type Configuration = SVector<f64, 19>;
type Velocity = SVector<f64, 18>;
type Torques = SVector<f64, 12>;

/// Initial angles of hip, thigh and shank of each leg, rad.
const POSTURE: [f64; 3] = [0.0, 0.8, -1.6];
const STANDING: [Touch; 4] = [Touch::Sticks; 4];
/// Weight of torques relative to tangential forces, (N/(N·m))², and weight of normal forces, which
/// distributes the load to all feet.
const TORQUE: f64 = 1e-4;
const NORMAL: f64 = 1e-2;
/// Amplitudes of the trunk's motion: sideways and up, m, and pitch, rad; and its frequency, rad/s.
const REACH: [f64; 3] = [0.03, 0.015, 0.12];
const RATE: f64 = 6.0;

/// Returns the desired displacement of the trunk from its initial pose, in its axes, with velocity and
/// acceleration.
fn desired_trunk_motion(t: f64) -> [SVector<f64, 6>; 3] {
    let [side, up, nod] = REACH;
    let harmonic_trunk_motion =
        |sin: f64, cos: f64| SVector::from([0.0, side * sin, up * cos, 0.0, nod * sin, 0.0]);
    let (sin, cos) = (RATE * t).sin_cos();
    let (x, rate, change) = (
        harmonic_trunk_motion(sin, cos - 1.0),
        harmonic_trunk_motion(cos, -sin) * RATE,
        harmonic_trunk_motion(-sin, -cos) * (RATE * RATE),
    );
    // The motion starts at rest.
    let late = (-4.0 * t).exp();
    let grown = 1.0 - late * (1.0 + 4.0 * t + 8.0 * t * t);
    let (growth, bend) = (32.0 * t * t * late, 64.0 * t * (1.0 - 2.0 * t) * late);
    [x * grown, rate * grown + x * growth, change * grown + rate * (2.0 * growth) + x * bend]
}

/// Returns the configuration in which the trunk has its desired pose.
fn configuration_with_trunk_pose(start: &Configuration, t: f64) -> Configuration {
    let [place, ..] = desired_trunk_motion(t);
    let mut displacement = Velocity::zeros();
    displacement.fixed_rows_mut::<6>(0).copy_from(&place);
    StandingSolo {}.integrate(start, &displacement)
}

/// Returns the joint torques, and the contact forces that they cause.
fn torques_and_contact_forces(
    start: &Configuration,
    t: f64,
    q: &Configuration,
    v: &Velocity,
) -> (Torques, SVector<f64, 12>) {
    let robot = StandingSolo {};
    let missing = robot.difference(q, &configuration_with_trunk_pose(start, t));
    let [_, velocity, acceleration] = desired_trunk_motion(t);
    let off = missing.fixed_rows::<6>(0) * 900.0 + (velocity - v.fixed_rows::<6>(0)) * 60.0;
    let target = acceleration + off;
    // With sticking feet: motion and contact forces for zero torques, and their derivatives with respect to
    // torques.
    let Ok(held) = contact::forward_dynamics_derivatives(&robot, 0.0, q, v, &Velocity::zeros(), &STANDING)
    else {
        return (Torques::zeros(), SVector::zeros());
    };
    let trunk = held.by_tau.fixed_view::<6, 12>(0, 6);
    let pushes = held.forces_by_tau.fixed_view::<12, 12>(0, 6);
    let weights = SVector::<f64, 12>::from_fn(|k, _| if k % 3 == 0 { NORMAL } else { 1.0 });
    let weighted = SMatrix::<f64, 12, 12>::from_diagonal(&weights) * pushes;
    // Minimum of ½ fᵀ W f + ½ ε τᵀ τ with A τ = v̇ − v̇₀ (Lagrange multipliers).
    let mut system = SMatrix::<f64, 18, 18>::zeros();
    let mut right = SVector::<f64, 18>::zeros();
    let costs = pushes.transpose() * weighted + SMatrix::<f64, 12, 12>::identity() * TORQUE;
    system.fixed_view_mut::<12, 12>(0, 0).copy_from(&costs);
    system.fixed_view_mut::<6, 12>(12, 0).copy_from(&trunk);
    system.fixed_view_mut::<12, 6>(0, 12).copy_from(&trunk.transpose());
    right.fixed_rows_mut::<12>(0).copy_from(&-(weighted.transpose() * held.forces));
    right.fixed_rows_mut::<6>(12).copy_from(&(target - held.a.fixed_rows::<6>(0)));
    let Some(solved) = system.lu().solve(&right) else { return (Torques::zeros(), SVector::zeros()) };
    let torques = solved.fixed_rows::<12>(0).into_owned();
    (torques, held.forces + pushes * torques)
}

/// Returns the largest ratio of tangential force to friction limit over all feet, with positive normal
/// forces.
fn largest_friction_ratio(forces: &SVector<f64, 12>) -> f64 {
    let ratio =
        |foot: usize| forces.fixed_rows::<2>(3 * foot + 1).norm() / (0.6 * forces[3 * foot].max(1e-9));
    (0..4).map(ratio).fold(0.0, f64::max)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = StandingSolo {};
    let mut start = robot.neutral();
    for leg in 0..4 {
        start.fixed_rows_mut::<3>(7 + 3 * leg).copy_from_slice(&POSTURE);
    }
    start[2] -= robot.contact_gaps(&start).min();
    let largest_slip_speed = |q: &Configuration, v: &Velocity| {
        let rates = robot.contact_rates(q, v);
        (0..4).map(|foot| rates.fixed_rows::<2>(3 * foot + 1).norm()).fold(0.0, f64::max)
    };

    let run = simulate(&robot)
        .from(start, Velocity::zeros())
        .control_every(1e-3, |t, q, v| torques_and_contact_forces(&start, t, q, v).0)
        .method(TimeStepping::step(1e-3))
        .duration(3.0)
        .sample_every(0.25);
    println!("  t, s   side, mm    up, mm   nod, mrad   off, mm   friction   slip, µm/s");
    for sample in run {
        let Sample { t, q, v, .. } = sample?;
        let moved = robot.difference(&start, &q);
        let off = robot.difference(&q, &configuration_with_trunk_pose(&start, t)).fixed_rows::<6>(0).amax();
        let (_, forces) = torques_and_contact_forces(&start, t, &q, &v);
        let slip = largest_slip_speed(&q, &v);
        println!(
            "{t:6.2} {:10.2} {:9.2} {:11.1} {:9.3} {:10.2} {:11.1e}",
            1e3 * moved[1],
            1e3 * moved[2],
            1e3 * moved[4],
            1e3 * off,
            largest_friction_ratio(&forces),
            1e6 * slip
        );
        assert!(off < 1e-3, "the trunk is led to a millimetre and a milliradian");
        assert!(
            largest_friction_ratio(&forces) < 0.5 && slip < 1e-6,
            "feet press well within their cones, and stand"
        );
    }
    Ok(())
}

#[test]
fn contact_forces_stay_in_cones() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
