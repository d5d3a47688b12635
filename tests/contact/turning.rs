//! Moments of friction: torsional friction about the normal, and rolling friction.

use crate::derivatives::check_contact_derivatives;
use crate::laws::Random;
use linkwork::contact::{self, Contacts, Touch};
use linkwork::integrate::EventDriven;
use linkwork::prelude::*;

const G: f64 = 9.81;
const MASS: f64 = 0.5;
const RADIUS: f64 = 0.05;

#[mechanism(gravity = -9.81 * (cos(tilt) * z + sin(tilt) * x), derivatives)]
struct Ball {
    tilt: f64,
    friction: f64,
    torsional: f64,
    rolling: f64,
    #[body(mass = 0.5, inertia = sphere(0.5, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(0.05), ground.plane(z), friction = friction, torsional = torsional, rolling = rolling
    )]
    floor: Contact,
}

const LEVEL: Ball = Ball { tilt: 0.0, friction: 0.5, torsional: 0.002, rolling: 0.001 };

impl Ball {
    fn configuration_on_ground(&self) -> SVector<f64, 7> {
        let mut q = self.neutral();
        q[2] = RADIUS;
        q
    }
}

fn precise_event_driven_method() -> EventDriven<f64> {
    EventDriven::new().tolerance(1e-12, 1e-12)
}

#[test]
fn friction_moments_have_rows_after_their_contact() {
    assert_eq!(Ball::CONTACTS, ["floor", "floor.spin", "floor.roll"]);
    assert_eq!(<Ball as Contacts<7, 6, 0, 3, 6>>::PRESSED_BY, [0; 3]);
    let counts = Ball::CONTACT_ROWS.map(|contact::Rows { first, count }| [first, count]);
    assert_eq!(counts, [[0, 3], [3, 1], [4, 2]]);
}

/// A spinning ball stops after the time ω I / (a m g), having rotated by half of ω times that time, and stays
/// at rest.
#[test]
fn spinning_ball_stops_by_the_friction_moment() {
    let (m, q) = (LEVEL, LEVEL.configuration_on_ground());
    let v = SVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 20.0]);
    let inertia = 0.4 * MASS * RADIUS * RADIUS;
    let stops = 20.0 * inertia / (0.002 * MASS * G);
    let rotation_angle = |q: &SVector<f64, 7>| 2.0 * q[5].atan2(q[6]).rem_euclid(core::f64::consts::PI);
    let turned = (10.0 * stops).rem_euclid(2.0 * core::f64::consts::PI);
    let simulate_spinning_ball = || simulate(&m).from(q, v).method(precise_event_driven_method());
    let half = simulate_spinning_ball().duration(stops / 2.0).finish().unwrap();
    assert!((half.v[5] - 10.0).abs() < 1e-10, "{half:?}");
    let end = simulate_spinning_ball().duration(100.0).finish().unwrap();
    assert!(end.v.amax() < 1e-13 && (rotation_angle(&end.q) - turned).abs() < 1e-9, "{end:?} {turned}");
    let steps = simulate(&m).from(q, v).method(TimeStepping::step(1e-3));
    let half = steps.clone().duration(stops / 2.0).finish().unwrap();
    assert!((half.v[5] - 10.0).abs() < 1e-9, "{half:?}");
    let end = steps.duration(3.0).finish().unwrap();
    assert!(end.v.amax() < 1e-13 && (rotation_angle(&end.q) - turned).abs() < 1e-4, "{end:?} {turned}");
}

/// A rolling ball is decelerated by 5/7 ρ g / r, stops after half of v² over this deceleration, and stays at
/// rest for an hour.
#[test]
fn rolling_ball_stops_by_rolling_friction() {
    let (m, q) = (LEVEL, LEVEL.configuration_on_ground());
    let v = SVector::from([1.0, 0.0, 0.0, 0.0, 20.0, 0.0]);
    let brakes = 5.0 / 7.0 * 0.001 * G / RADIUS;
    let way = 0.5 / brakes;
    let simulate_rolling_ball = || simulate(&m).from(q, v).method(precise_event_driven_method());
    let two = simulate_rolling_ball().duration(2.0).finish().unwrap();
    assert!((two.q[0] - (2.0 - 2.0 * brakes)).abs() < 1e-9, "{two:?}");
    let end = simulate_rolling_ball().duration(20.0).finish().unwrap();
    assert!(end.v.amax() < 1e-12 && (end.q[0] - way).abs() < 1e-9, "{end:?} {way}");
    let steps = simulate(&m).from(q, v).method(TimeStepping::step(2e-3)).duration(8.0).finish().unwrap();
    assert!(steps.v.amax() < 1e-12 && (steps.q[0] - way).abs() < 1e-4, "{steps:?} {way}");
    let hour = simulate(&m).from(steps.q, steps.v).method(TimeStepping::step(0.1)).duration(3600.0);
    let rests = hour.sample_every(3600.0).last().unwrap().unwrap();
    assert!((rests.q - steps.q).amax() < 1e-9, "{:e}", (rests.q - steps.q).amax());
}

/// Checks that a ball with rolling friction ρ stays at rest on a slope if tan α is less than ρ / r. On
/// steeper slopes it rolls down with 5/7 g (sin α − ρ / r cos α).
#[test]
fn ball_rests_on_slopes_below_the_rolling_limit() {
    let rolling = 0.1 * RADIUS;
    for tilt in [0.099_f64, 0.12] {
        let m = Ball { tilt: tilt.atan(), rolling, ..LEVEL };
        let (sin, cos) = m.tilt.sin_cos();
        let a = 5.0 / 7.0 * G * (sin - 0.1 * cos).max(0.0);
        for t in [1.0, 3.0] {
            let run = simulate(&m).from(m.configuration_on_ground(), [0.0; 6]);
            let events = run.clone().method(precise_event_driven_method()).duration(t).finish().unwrap();
            let steps = run.method(TimeStepping::step(1e-3)).duration(t).finish().unwrap();
            assert!((events.q[0] + a * t * t / 2.0).abs() < 1e-9, "{tilt}: {events:?}");
            assert!((steps.q[0] + a * t * t / 2.0).abs() < 1e-5, "{tilt}: {steps:?}");
        }
    }
}

#[test]
fn friction_moments_oppose_the_angular_velocity() {
    let (m, q) = (LEVEL, LEVEL.configuration_on_ground());
    let (u, none) = (SVector::<f64, 0>::zeros(), SVector::<f64, 6>::zeros());
    let weight = MASS * G;
    let spins = contact::acting(&m, 0.0, &q, &[0.0, 0.0, 0.0, 0.0, 0.0, 3.0].into(), &u).unwrap();
    assert!((spins - SVector::from([weight, 0.0, 0.0, -0.002 * weight, 0.0, 0.0])).amax() < 1e-7, "{spins}");
    // The ball rolls and spins: both moments are at their maxima, and friction in the plane decelerates the
    // centre together with the rotation.
    let v = SVector::from([0.3, 0.0, 0.0, 0.0, 0.3 / RADIUS, -2.0]);
    let rolls =
        contact::forward_dynamics(&m, 0.0, &q, &v, &none, &[Touch::Sticks, Touch::Slips, Touch::Slips]);
    let rolls = rolls.unwrap();
    let brakes = 5.0 / 7.0 * 0.001 * G / RADIUS;
    assert!((rolls.a[0] + brakes).abs() < 1e-12, "{rolls:?}");
    assert!((rolls.a[5] - 0.002 * weight / (0.4 * MASS * RADIUS * RADIUS)).abs() < 1e-12, "{rolls:?}");
    assert!((rolls.forces.rows(4, 2).norm() - 0.001 * weight).abs() < 1e-12, "{rolls:?}");
    let found = contact::acting(&m, 0.0, &q, &v, &u).unwrap();
    assert!((found - rolls.forces).amax() < 1e-6, "{found} {}", rolls.forces);
    // With sticking moments the ball does not roll at all.
    let held = contact::forward_dynamics(&m, 0.0, &q, &none, &none, &[Touch::Sticks; 3]).unwrap();
    assert!(held.a.amax() < 1e-13 && (held.forces[0] - weight).abs() < 1e-12);
}

#[test]
fn contact_derivatives_include_friction_moments() {
    use Touch::{Open, Slips, Sticks};
    let m = Ball { tilt: 0.2, ..LEVEL };
    let mut random = Random(11);
    let q = m.integrate(&m.configuration_on_ground(), &random.random_vector(1.0));
    let (v, tau) = (random.random_vector(1.0), random.random_vector(1.0));
    for touches in [
        [Sticks, Slips, Slips],
        [Slips, Slips, Slips],
        [Slips, Sticks, Open],
        [Sticks, Sticks, Sticks],
        [Slips, Open, Slips],
    ] {
        check_contact_derivatives(&m, 0.0, (&q, &v), &tau, &touches);
    }
}

/// Impacts on a ball that spins and rolls: moments stay within their bounds, oppose the rotation, and no
/// energy is gained.
#[test]
fn impacts_with_friction_moments_gain_no_energy() {
    let mut random = Random(12);
    for _ in 0..2000 {
        let m = Ball {
            tilt: 0.0,
            friction: random.random_choice([0.0, 0.1, 1.0]),
            torsional: random.random_choice([0.0, 1e-3, 0.1]),
            rolling: random.random_choice([0.0, 1e-3, 0.1]),
        };
        let q = m.integrate(
            &m.configuration_on_ground(),
            &SVector::from([0.0, 0.0, 0.0, 1.0, 2.0, random.next()]),
        );
        let v =
            random.random_vector::<6>(3.0).component_mul(&SVector::from([1.0, 1.0, 1.0, 20.0, 20.0, 20.0]));
        let found = contact::impact(&m, 0.0, &q, &v).unwrap();
        let (rates, impulses) = (m.contact_rates(&q, &found.v), found.impulses);
        let (before, after) = (m.kinetic_energy(&q, &v), m.kinetic_energy(&q, &found.v));
        assert!(after <= before * (1.0 + 1e-12), "{before} {after}");
        for (first, count, most) in [(1, 2, m.friction), (3, 1, m.torsional), (4, 2, m.rolling)] {
            let (moment, turning) = (impulses.rows(first, count), rates.rows(first, count));
            let most = most * impulses[0];
            assert!(moment.norm() <= most * (1.0 + 1e-9), "{moment} {most}");
            if turning.norm() > 1e-7 {
                let against = moment + turning.normalize() * most;
                assert!(against.norm() < 1e-6 * (most + 1e-9), "{against} of {most}, {turning}");
            }
        }
    }
}

#[mechanism(gravity = -9.81 * z)]
struct CompliantBallOnFelt {
    #[body(mass = 0.5, inertia = sphere(0.5, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(0.05), ground.plane(z),
        stiffness = 1e6, dissipation = 0.5, friction = 0.5, torsional = 0.002, rolling = 0.001, speed = 1e-5
    )]
    felt: Contact,
}

/// Compliant surfaces have the same decelerations: spin by a m g / I, and rolling by 5/7 ρ g / r.
#[test]
fn compliant_friction_moments_have_equal_decelerations() {
    let m = CompliantBallOnFelt {};
    let mut q = m.neutral();
    q[2] = RADIUS - MASS * G / 1e6;
    let simulate_ball_from = |v: [f64; 6], t: f64| {
        let method = Rodas::new().tolerance(1e-8, 1e-10);
        simulate(&m).from(q, v).method(method).duration(t).finish().unwrap()
    };
    let spins = simulate_ball_from([0.0, 0.0, 0.0, 0.0, 0.0, 20.0], 0.5);
    let slower = 0.5 * 0.002 * G / (0.4 * RADIUS * RADIUS);
    assert!((spins.v[5] - 20.0 + slower).abs() < 1e-3 * slower, "{spins:?}");
    let rolls = simulate_ball_from([1.0, 0.0, 0.0, 0.0, 20.0, 0.0], 0.5);
    let way = 0.5 - 0.125 * 5.0 / 7.0 * 0.001 * G / RADIUS;
    assert!((rolls.q[0] - way).abs() < 1e-4, "{rolls:?} {way}");
}

/// Ball on felt, with the contact moments as an output.
#[mechanism(gravity = -9.81 * z)]
struct BallOnFelt {
    #[body(mass = 0.5, inertia = sphere(0.5, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ground.plane(z), ball.sphere(0.05), friction = 0.5, torsional = 0.002, rolling = 0.001)]
    floor: Contact,
    #[output(contact_moment(floor))]
    couple: Vector,
    #[output(power(floor))]
    taken: Scalar,
}

/// Ball on a compliant surface, with the contact moments as an output.
#[mechanism(gravity = -9.81 * z)]
struct BallOnSoftGround {
    #[body(mass = 0.5, inertia = sphere(0.5, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(0.05), ground.plane(z), stiffness = 1e4, torsional = 0.002, rolling = 0.001, speed = 1e-6
    )]
    floor: Contact,
    #[output(contact_moment(floor))]
    couple: Vector,
    #[output(power(floor))]
    taken: Scalar,
}

/// A ball that rolls along x and spins about z has the contact moments `ρ m g` about y and `a m g` about z,
/// and dissipates these times its angular velocities. The output is the moment on the first surface of the
/// contact.
#[test]
fn outputs_include_friction_moments() {
    let v: SVector<f64, 6> = [1.0, 0.0, 0.0, 0.0, 20.0, -15.0].into();
    let moments = SVector::<f64, 3>::from([0.0, -0.001, 0.002]) * (MASS * G);
    let lost = -(0.001 * 20.0 + 0.002 * 15.0) * MASS * G;
    let q = LEVEL.configuration_on_ground();
    let m = BallOnFelt {};
    assert!((m.couple(&q, &v).unwrap() + moments).amax() < 1e-8);
    assert!((m.taken(&q, &v).unwrap() - lost).abs() < 1e-6, "{:?} {lost}", m.taken(&q, &v));
    let m = BallOnSoftGround {};
    let mut q = q;
    q[2] -= MASS * G / 1e4;
    assert!((m.couple(&q, &v) - moments).amax() < 1e-6, "{}", m.couple(&q, &v));
    assert!((m.taken(&q, &v) - lost).abs() < 1e-5);
}
