//! Tests of compliant contacts, in which surfaces indent.

use linkwork::prelude::*;

#[mechanism(gravity = -g * z, derivatives)]
struct Ball {
    g: f64,
    mass: f64,
    stiffness: f64,
    dissipation: f64,
    #[particle(mass = mass)]
    ball: Particle,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball, ground.plane(z), stiffness = stiffness, dissipation = dissipation)]
    floor: Contact,
    #[output(contact_force(floor))]
    load: Vector,
}

#[mechanism(gravity = -g * z, derivatives)]
struct HertzContactBall {
    g: f64,
    mass: f64,
    stiffness: f64,
    dissipation: f64,
    #[particle(mass = mass)]
    ball: Particle,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball, ground.plane(z), hertz = stiffness, dissipation = dissipation)]
    floor: Contact,
}

/// At rest the penetration follows from the weight, and the contact force is the weight.
#[test]
fn compliant_penetration_is_proportional_to_weight() {
    let m = Ball { g: 9.81, mass: 2.0, stiffness: 5e4, dissipation: 0.3 };
    let depth = m.mass * m.g / m.stiffness;
    assert!(m.forward_dynamics(&[-depth].into(), &[0.0].into(), &[0.0].into())[0].abs() < 1e-12);
    assert!((m.load(&[-depth].into(), &[0.0].into())[2] - m.mass * m.g).abs() < 1e-12);
    assert_eq!(m.load(&[1e-9].into(), &[-1.0].into()).norm(), 0.0);
    // A body that is pulled out fast has no tensile contact force.
    assert_eq!(m.load(&[-depth].into(), &[10.0].into())[2], 0.0);
    let m = HertzContactBall { g: 9.81, mass: 2.0, stiffness: 5e6, dissipation: 0.3 };
    let depth = (m.mass * m.g / m.stiffness).powf(2.0 / 3.0);
    assert!(m.forward_dynamics(&[-depth].into(), &[0.0].into(), &[0.0].into())[0].abs() < 1e-11);
}

/// Returns the time at which a body leaves the ground after an impact at one metre per second, and its
/// velocity then. `at` returns the state at a time.
fn rebound_time_and_velocity(at: impl Fn(f64) -> Sample<f64, 1, 1, 0>, longest: f64) -> (f64, f64) {
    let (mut early, mut late) = (longest * 0.3, longest);
    for _ in 0..50 {
        let middle = (early + late) / 2.0;
        if at(middle).q[0] < 0.0 { early = middle } else { late = middle }
    }
    (late, at(late).v[0])
}

/// An impact lasts half a period of the spring, and 2.9432 times the depth over the speed for round bodies
/// (Johnson, *Contact Mechanics*, 1985, § 11.4). Without dissipation it is elastic.
#[test]
fn compliant_impacts_have_closed_form_durations() {
    let precise_method = || DormandPrince::new().tolerance(1e-12, 1e-14);
    let m = Ball { g: 0.0, mass: 0.5, stiffness: 1e4, dissipation: 0.0 };
    let state_after =
        |t: f64| simulate(&m).from([0.0], [-1.0]).method(precise_method()).duration(t).finish().unwrap();
    let half = core::f64::consts::PI * (m.mass / m.stiffness).sqrt();
    let (time, speed) = rebound_time_and_velocity(state_after, half * 1.5);
    assert!((time / half - 1.0).abs() < 1e-9 && (speed - 1.0).abs() < 1e-9, "{time} {half} {speed}");
    let m = HertzContactBall { g: 0.0, mass: 0.5, stiffness: 1e6, dissipation: 0.0 };
    let state_after =
        |t: f64| simulate(&m).from([0.0], [-1.0]).method(precise_method()).duration(t).finish().unwrap();
    let depth = (5.0 * m.mass / (4.0 * m.stiffness)).powf(0.4);
    let (time, speed) = rebound_time_and_velocity(state_after, 4.0 * depth);
    assert!(
        (time / depth - 2.943_274).abs() < 1e-5 && (speed - 1.0).abs() < 1e-8,
        "{} {speed}",
        time / depth
    );
}

/// The coefficient of restitution decreases with the speed, by two thirds of the dissipation to first order
/// (Hunt and Crossley, 1975).
#[test]
fn compliant_restitution_decreases_with_speed() {
    for dissipation in [0.003, 0.03] {
        let expected_restitution = |speed: f64| 1.0 - 2.0 / 3.0 * dissipation * speed;
        let m = Ball { g: 0.0, mass: 0.5, stiffness: 1e4, dissipation };
        let state_after = |t: f64| simulate(&m).from([0.0], [-1.0]).duration(t).finish().unwrap();
        let (_, linear) = rebound_time_and_velocity(state_after, 0.05);
        let m = HertzContactBall { g: 0.0, mass: 0.5, stiffness: 1e6, dissipation };
        let state_after = |t: f64| simulate(&m).from([0.0], [-1.0]).duration(t).finish().unwrap();
        let (_, round) = rebound_time_and_velocity(state_after, 0.05);
        for found in [linear, round] {
            assert!(
                (found - expected_restitution(1.0)).abs() < dissipation * dissipation,
                "{dissipation}: {found}"
            );
        }
    }
}

#[mechanism(gravity = -9.81 * z, derivatives)]
struct BowlingBallOnLane {
    friction: f64,
    #[body(mass = 6, inertia = sphere(6, 0.11))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(0.11), ground.plane(z), stiffness = 1e6, dissipation = 0.5, friction = friction,
        speed = 1e-4
    )]
    lane: Contact,
}

/// Checks that a ball which slides on a compliant contact begins to roll, with 5/7 of its speed.
#[test]
fn sliding_ball_begins_to_roll_on_compliant_contact() {
    let m = BowlingBallOnLane { friction: 0.2 };
    let depth = 6.0 * 9.81 / 1e6;
    let start = [0.0, 0.0, 0.11 - depth, 0.0, 0.0, 0.0, 1.0];
    let run = simulate(&m)
        .from(start, [2.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        .method(Rodas::new().tolerance(1e-7, 1e-9))
        .duration(1.0);
    let end = run.finish().unwrap();
    let speed = end.v.fixed_rows::<3>(0).norm();
    assert!((speed - 10.0 / 7.0).abs() < 1e-3, "{speed}");
}

/// Derivatives of the accelerations agree with differences, in contact with the ground and above it.
#[test]
fn compliant_contact_derivatives_agree_with_differences() {
    let m = BowlingBallOnLane { friction: 0.2 };
    let tau = SVector::<f64, 6>::zeros();
    for height in [0.1099, 0.2] {
        let q = m.integrate(
            &[0.3, -0.2, height, 0.0, 0.0, 0.0, 1.0].into(),
            &[0.0, 0.0, 0.0, 0.2, 0.5, -0.3].into(),
        );
        let v = SVector::from([0.3, -0.1, 0.02, 0.4, -0.2, 0.1]);
        let (by_q, by_v, _) = m.forward_dynamics_derivatives(&q, &v, &tau);
        let h = 1e-7;
        for k in 0..6 {
            let mut step = SVector::<f64, 6>::zeros();
            step[k] = h;
            let acceleration_at_displacement =
                |s: f64| m.forward_dynamics(&m.integrate(&q, &(step * s)), &v, &tau);
            let acceleration_at_velocity_step = |s: f64| m.forward_dynamics(&q, &(v + step * s), &tau);
            let size = by_q.amax().max(by_v.amax()).max(1.0);
            assert!(
                ((acceleration_at_displacement(1.0) - acceleration_at_displacement(-1.0)) / (2.0 * h)
                    - by_q.column(k))
                .amax()
                    < 1e-6 * size
            );
            assert!(
                ((acceleration_at_velocity_step(1.0) - acceleration_at_velocity_step(-1.0)) / (2.0 * h)
                    - by_v.column(k))
                .amax()
                    < 1e-6 * size
            );
        }
    }
}
