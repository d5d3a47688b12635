//! Contacts and joint limits of mechanisms with joints and loops.

use linkwork::contact;
use linkwork::prelude::*;

#[mechanism]
struct ArmWithElbowStop {
    #[body(mass = 2, com = 0.25 * x, inertia = rod(2, 0.5, x))]
    upper: Body,
    #[body(mass = 1.5, com = 0.2 * x, inertia = rod(1.5, 0.4, x))]
    fore: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(0.5 * x) -> fore, about = z)]
    elbow: Pin,
    #[acts(on = elbow)]
    motor: Torque,
    #[limit(on = elbow, from = -2, to = 0.5, restitution = 0)]
    stop: Limit,
}

/// A constant torque presses the elbow onto its stop, where it stays until the torque is reversed.
#[test]
fn elbow_rests_at_its_stop_under_torque() {
    let m = ArmWithElbowStop {};
    let applied_push = |t: f64| if t < 1.0 { 2.0 } else { -2.0 };
    let run = simulate(&m)
        .from([0.1, 0.0], [0.3, 0.0])
        .inputs(|t, _, _| [applied_push(t)].into())
        .method(TimeStepping::step(1e-3))
        .duration(1.2);
    let mut reached = None;
    for sample in run {
        let sample = sample.unwrap();
        if reached.is_none() && (sample.q[1] - 0.5).abs() < 1e-9 {
            reached = Some(sample.t);
        }
        if reached.is_some() && sample.t < 1.0 {
            assert!((sample.q[1] - 0.5).abs() < 1e-8 && sample.v[1].abs() < 1e-13, "{sample:?}");
        }
    }
    assert!(reached.is_some_and(|t| t < 0.6), "{reached:?}");
}

/// The velocity after the impact at the stop is v − M⁻¹ e (1 + r) vₑ / (M⁻¹)ₑₑ.
#[test]
fn impact_at_a_stop_has_the_closed_form_velocity() {
    let m = ArmWithElbowStop {};
    let (q, v) = ([0.4, 0.5].into(), SVector::from([0.7, 1.3]));
    let found = contact::impact(&m, 0.0, &q, &v).unwrap();
    let inverse = m.mass_matrix(&q).try_inverse().unwrap();
    let expected = v - inverse.column(1) * v[1] / inverse[(1, 1)];
    assert!((found.v - expected).norm() < 1e-13, "{}", found.v);
    assert_eq!(ArmWithElbowStop::CONTACTS, ["stop.from", "stop.to"]);
    assert!((found.impulses[1] - v[1] / inverse[(1, 1)]).abs() < 1e-13 && found.impulses[0] == 0.0);
}

#[mechanism]
struct SliderCrankHittingStop {
    restitution: f64,
    #[body(mass = 0.5, com = 0.02 * x, inertia = rod(0.5, 0.04, x))]
    crank: Body,
    #[body(mass = 0.5, com = 0.065 * x, inertia = rod(0.5, 0.13, x))]
    rod: Body,
    #[body(mass = 0.5)]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(0.04 * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(0.13 * x) -> piston, about = z)]
    small_end: Pin,
    #[limit(on = cylinder, to = 0.165, restitution = restitution)]
    wall: Limit,
}

/// A piston in a closed loop collides with a stop. The loop stays closed, and the piston leaves with the
/// velocity of restitution. The energy loss is ½ (1 − e²) v² over the inverse mass of the piston under the
/// constraints.
#[test]
fn piston_of_a_loop_rebounds_from_a_stop() {
    for e in [0.0, 0.3, 1.0] {
        let m = SliderCrankHittingStop { restitution: e };
        let place = 0.165;
        let crank = ((0.04_f64.powi(2) + place * place - 0.13 * 0.13) / (2.0 * 0.04 * place)).acos();
        let q = m.assemble(&[crank, -0.5, place].into(), &[2]).unwrap();
        let v = m.complete_velocity(&q, &[0.0, 0.0, 2.0].into(), &[2]).unwrap();
        let found = contact::impact(&m, 0.0, &q, &v).unwrap();
        assert!(m.constraint_rates(&q, &found.v).amax() < 1e-12);
        assert!((found.v[2] + e * 2.0).abs() < 1e-12, "{}", found.v);
        let unit = [0.0, 0.0, 1.0].into();
        let weight = linkwork::integrate::Hooks::velocity_change_by_impulse(
            &m,
            0.0,
            &q,
            &SVector::zeros(),
            0.0,
            &unit,
        )[2];
        let lost = m.kinetic_energy(&q, &v) - m.kinetic_energy(&q, &found.v);
        assert!((lost - 0.5 * (1.0 - e * e) * 4.0 / weight).abs() < 1e-12, "{lost}");
    }
}

/// Bob on a rope, which may be slack.
#[mechanism(gravity = -9.81 * y)]
struct BobOnRope {
    length: f64,
    #[particle(mass = 0.3)]
    bob: Particle,
    #[joint(ground -> bob, along = (x, y))]
    place: Stage,
    #[limit(on = norm(r(bob / ground)), to = length, restitution = 0)]
    rope: Limit,
}

/// The bob falls until the rope is taut. The impact removes the velocity along the rope; then the bob swings.
#[test]
fn rope_becomes_taut_and_removes_radial_velocity() {
    let m = BobOnRope { length: 1.0 };
    assert_eq!(BobOnRope::CONTACTS, ["rope.to"]);
    let run = simulate(&m)
        .from([0.6, 0.0], [0.0; 2])
        .method(EventDriven::new().tolerance(1e-11, 1e-11))
        .sample_every(0.05)
        .duration(2.0);
    let taut = (1.6 / 9.81_f64).sqrt();
    // The component 0.6 of the velocity g t is normal to the rope, 0.8 m below the peg.
    let energy = 0.3 * 9.81 * (0.5 * 0.36 * 1.6 - 0.8);
    let mut swings = 0;
    for sample in run {
        let sample = sample.unwrap();
        let length = sample.q.norm();
        if sample.t < taut {
            assert!((sample.q[0] - 0.6).abs() < 1e-12 && length < 1.0);
            continue;
        }
        let now = m.kinetic_energy(&sample.q, &sample.v) + m.potential_energy(&sample.q);
        assert!((length - 1.0).abs() < 1e-9, "{length} at {}", sample.t);
        assert!((now - energy).abs() < 1e-8, "{now} {energy} at {}", sample.t);
        swings += 1;
    }
    assert!(swings > 30);
}

/// Two weights on a rope over a massless wheel.
#[mechanism(gravity = -9.81 * z)]
struct Atwood {
    #[particle(mass = 3)]
    heavy: Particle,
    #[particle(mass = 2)]
    light: Particle,
    #[joint(ground -> heavy, along = -z)]
    left: Sleeve,
    #[joint(ground.at(0.3 * x) -> light, along = -z)]
    right: Sleeve,
    #[limit(on = left + right, to = 2, restitution = 0)]
    rope: Limit,
}

/// The rope is slack by 0.1 m, and both weights fall. When it is taut, momentum along the rope determines
/// their common speed, and the heavy weight descends with `(m₁ − m₂) g / (m₁ + m₂)`.
#[test]
fn taut_rope_over_a_wheel_equalises_speeds() {
    let fall = (0.1 / 9.81_f64).sqrt();
    let run = simulate(&Atwood {}).from([1.0, 0.9], [0.0; 2]).method(EventDriven::new());
    let end = run.duration(fall + 0.2).finish().unwrap();
    let speed = 9.81 * fall * (3.0 - 2.0) / 5.0;
    let acceleration = 9.81 / 5.0;
    assert!((end.v[0] - (speed + acceleration * 0.2)).abs() < 1e-9, "{}", end.v);
    assert!((end.v[0] + end.v[1]).abs() < 1e-12 && (end.q.sum() - 2.0).abs() < 1e-9, "{} {}", end.q, end.v);
    // The tension of the rope is 2 m₁ m₂ g / (m₁ + m₂).
    let force = contact::acting(&Atwood {}, 0.0, &end.q, &end.v, &SVector::zeros()).unwrap();
    assert!((force[0] - 2.4 * 9.81).abs() < 1e-6, "{force}");
}

/// Two gear wheels, one of which drives the other by teeth with backlash.
#[mechanism]
struct GearsWithBacklash {
    play: f64,
    restitution: f64,
    #[body(mass = 1, inertia = diagonal(1, 1, 0.02))]
    first: Body,
    #[body(mass = 1, inertia = diagonal(1, 1, 0.03))]
    second: Body,
    #[joint(ground -> first, about = z)]
    input: Pin,
    #[joint(ground.at(0.2 * x) -> second, about = z)]
    output: Pin,
    #[limit(on = 0.1 * input + 0.05 * output, from = -play, to = play, restitution = restitution)]
    teeth: Limit,
}

/// The gears rattle: each impact reverses the relative velocity of the teeth and multiplies it by the
/// coefficient of restitution, while `I₁ ω₁ / r₁ − I₂ ω₂ / r₂` is constant. Without restitution the teeth
/// stay in contact.
#[test]
fn gear_backlash_impacts_follow_restitution() {
    let conserved_momentum = |v: &SVector<f64, 2>| 0.02 * v[0] / 0.1 - 0.03 * v[1] / 0.05;
    let approach_speed_of_teeth = |v: &SVector<f64, 2>| 0.1 * v[0] + 0.05 * v[1];
    let start = SVector::from([3.0, 1.0]);
    for (restitution, impacts) in [(1.0, 4), (0.5, 3), (0.0, 1)] {
        let m = GearsWithBacklash { play: 0.004, restitution };
        let method = EventDriven::new().tolerance(1e-12, 1e-12);
        // The first impact follows from the middle of the play; the later ones cross the whole play with
        // decreasing speed.
        let speed = approach_speed_of_teeth(&start);
        let (mut t, mut now) = (0.004 / speed, speed);
        for _ in 1..impacts {
            now *= restitution;
            t += 0.008 / now;
        }
        let run = simulate(&m).from([0.0; 2], start).method(method).duration(t * 1.0001);
        let end = run.finish().unwrap();
        let wanted = speed * restitution.powi(impacts) * if impacts % 2 == 0 { 1.0 } else { -1.0 };
        assert!(
            (approach_speed_of_teeth(&end.v) - wanted).abs() < 1e-9,
            "{} {wanted}",
            approach_speed_of_teeth(&end.v)
        );
        assert!((conserved_momentum(&end.v) - conserved_momentum(&start)).abs() < 1e-12);
        assert!(m.contact_gaps(&end.q).min() > -1e-9);
    }
}
