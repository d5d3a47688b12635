//! Tests of contact problems of textbooks against their closed-form solutions.

use linkwork::contact::{self, Touch};
use linkwork::integrate::EventDriven;
use linkwork::prelude::*;

const G: f64 = 9.81;

fn precise_event_driven_method() -> EventDriven<f64> {
    EventDriven::new().tolerance(1e-12, 1e-12)
}

/// Two billiard balls that move freely in space and collide, with friction and restitution.
#[mechanism]
struct Billiards {
    friction: f64,
    restitution: f64,
    #[body(mass = 0.17, inertia = sphere(0.17, 0.0286))]
    cue: Body,
    #[joint(ground -> cue)]
    first: Free,
    #[body(mass = 0.17, inertia = sphere(0.17, 0.0286))]
    object: Body,
    #[joint(ground -> object)]
    second: Free,
    #[contact(cue.sphere(0.0286), object.sphere(0.0286), friction = friction, restitution = restitution)]
    touch: Contact,
}

/// Checks that friction between billiard balls throws the object ball off the line of centres. Its transverse
/// velocity is `μ (1 + e) v cos φ / 2`, or a seventh of the slip velocity if that is less. With side spin
/// `r ω = v sin φ` the surfaces do not slip, and the ball is not thrown.
#[test]
fn friction_throws_the_object_ball_off_its_line() {
    let (v, radius) = (2.0, 0.0286);
    for (friction, restitution) in [(0.06, 0.95), (0.03, 1.0), (0.5, 0.9)] {
        let m = Billiards { friction, restitution };
        for cut in [0.05_f64, 0.3, 0.7, 1.2] {
            for spin in [0.0, 0.5, 1.0, -1.0] {
                let (sin, cos) = cut.sin_cos();
                let mut q = m.neutral();
                (q[7], q[8]) = (2.0 * radius * cos, 2.0 * radius * sin);
                let mut before = SVector::<f64, 12>::zeros();
                (before[0], before[5]) = (v, spin * v * sin / radius);
                let after = contact::impact(&m, 0.0, &q, &before).unwrap().v;
                let along = after[6] * cos + after[7] * sin;
                let across = after[7] * cos - after[6] * sin;
                let slip = (spin - 1.0) * v * sin;
                let grip = (slip.abs() / 7.0).min(friction * (1.0 + restitution) / 2.0 * v * cos);
                assert!((along - (1.0 + restitution) / 2.0 * v * cos).abs() < 1e-12, "{along}");
                assert!((across - grip * slip.signum()).abs() < 1e-12, "{cut} {spin}: {across} {grip}");
            }
        }
    }
}

/// Spinning ball that bounces on a floor with friction.
#[mechanism(gravity = -9.81 * z)]
struct BouncingBallWithFriction {
    friction: f64,
    #[body(mass = 0.06, inertia = sphere(0.06, 0.03))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.03), ground.plane(z), friction = friction, restitution = 0.8)]
    floor: Contact,
}

/// A ball that spins about y and collides with the floor leaves it with the horizontal velocity
/// `(5 vₓ + 2 r ω) / 7` if it grips, and with a velocity reduced by `μ (1 + e) |v_z|` if it slips; back spin
/// reverses it (Cross, *Grip-slip behavior of a bouncing ball*, Am. J. Phys. 70, 2002, for a solid sphere
/// that grips at once).
#[test]
fn spin_changes_the_rebound_of_a_ball() {
    for (friction, spin) in [(1.0, 0.0), (1.0, -150.0), (1.0, 200.0), (0.1, -150.0), (0.1, 250.0)] {
        let m = BouncingBallWithFriction { friction };
        let mut q = m.neutral();
        q[2] = 0.03;
        let before = SVector::from([2.0, 0.0, -4.0, 0.0, spin, 0.0]);
        let after = contact::impact(&m, 0.0, &q, &before).unwrap().v;
        let slip: f64 = 2.0 - 0.03 * spin;
        let change = (2.0 / 7.0 * slip.abs()).min(friction * 1.8 * 4.0) * slip.signum();
        assert!((after[0] - (2.0 - change)).abs() < 1e-12 && (after[2] - 3.2).abs() < 1e-12, "{after}");
        assert!((after[4] - (spin + 2.5 * change / 0.03)).abs() < 1e-10, "{after}");
    }
}

/// Rod of mass 1 and length 2, whose tip slides on a floor with friction (Painlevé's paradox).
#[mechanism(gravity = -9.81 * y)]
struct Rod {
    friction: f64,
    #[body(mass = 1, inertia = rod(1, 2, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    pose: Planar,
    #[contact(rod.at(-x), ground.plane(y), friction = friction)]
    tip: Contact,
}

impl Rod {
    /// Returns a state of the rod at the angle `tilt` to the floor, with its tip sliding backwards at 1 m/s.
    fn sliding_state(tilt: f64, rate: f64) -> (SVector<f64, 3>, SVector<f64, 3>) {
        let (sin, cos) = tilt.sin_cos();
        ([cos, sin, tilt].into(), [-1.0 - rate * sin, rate * cos, rate].into())
    }
}

/// The tip's normal acceleration is `p N − (g − ω² sin θ)` with `p = 1 + 3 cos θ (cos θ − μ sin θ)`. Below μ
/// = 4/3, `p` is positive for every angle, so that the force is unique (Painlevé, *Sur les lois du frottement
/// de glissement*, 1895; Génot and Brogliato, *New results on Painlevé paradoxes*, Eur. J. Mech. A 18, 1999).
#[test]
fn rod_slides_below_the_painleve_limit() {
    let m = Rod { friction: 1.3 };
    for k in 1..15 {
        let (tilt, rate) = (0.1 * f64::from(k), 0.5);
        let (q, v) = Rod::sliding_state(tilt, rate);
        let rates = m.contact_rates(&q, &v);
        assert!(rates[0].abs() < 1e-14 && (rates[1].abs() - 1.0).abs() < 1e-14, "{rates}");
        let (sin, cos) = tilt.sin_cos();
        let p = 1.0 + 3.0 * cos * (cos - m.friction * sin);
        let normal = (G - rate * rate * sin) / p;
        assert!(p > 0.0);
        let found = contact::acting(&m, 0.0, &q, &v, &SVector::zeros()).unwrap();
        assert!((found[0] / normal - 1.0).abs() < 1e-5, "{tilt}: {found} {normal}");
        let slides = contact::forward_dynamics(&m, 0.0, &q, &v, &SVector::zeros(), &[Touch::Slips]).unwrap();
        assert!((slides.forces[0] / normal - 1.0).abs() < 1e-9, "{tilt}: {} {normal}", slides.forces);
    }
}

/// Checks Painlevé's paradox: with μ = 2 at tan θ = 2 no contact force is consistent with continued sliding
/// (`p = −0.8`). An impact without a collision stops the tip with the impulses (0.3, 0.4) N·s, and the rod
/// then rotates about it, with both methods of simulating contacts.
#[test]
fn rod_in_painleves_paradox_stops_by_an_impact() {
    let m = Rod { friction: 2.0 };
    let tilt = 2.0_f64.atan();
    let (q, v) = Rod::sliding_state(tilt, 0.0);
    let (sin, cos) = tilt.sin_cos();
    assert!((1.0 + 3.0 * cos * (cos - 2.0 * sin) + 0.8).abs() < 1e-14);
    let stopped = contact::land(&m, 0.0, &q, &v, &[Touch::Sticks]).unwrap();
    let [normal, along] = [stopped.impulses[0], stopped.impulses[1].abs()];
    assert!((normal - 0.3).abs() < 1e-12 && (along - 0.4).abs() < 1e-12, "{}", stopped.impulses);
    for h in [1e-4, 1e-5] {
        let end = simulate(&m).from(q, v).method(TimeStepping::step(h)).duration(h).finish().unwrap();
        assert!(m.contact_rates(&end.q, &end.v).amax() < 10.0 * h, "{end:?}");
        assert!((end.v - stopped.v).amax() < 30.0 * h, "{} {}", end.v, stopped.v);
    }
    let run = simulate(&m).from(q, v);
    let steps = run.clone().method(TimeStepping::step(1e-5)).duration(0.1).finish().unwrap();
    let events = run.method(precise_event_driven_method()).duration(0.1).finish().unwrap();
    assert!((steps.q - events.q).amax() < 1e-4, "{} {}", steps.q, events.q);
    assert!(m.contact_rates(&events.q, &events.v).amax() < 1e-9);
    let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    assert!((total_energy(&events.q, &events.v) - total_energy(&q, &stopped.v)).abs() < 1e-4);
}

/// Ladder on a smooth floor and a smooth wall.
#[mechanism(gravity = -9.81 * y)]
struct Ladder {
    #[body(mass = 8, inertia = rod(8, 4, x))]
    ladder: Body,
    #[joint(ground -> ladder, about = z)]
    pose: Planar,
    #[contact(ladder.at(2 * x), ground.plane(x))]
    wall: Contact,
    #[contact(ladder.at(-2 * x), ground.plane(y))]
    floor: Contact,
}

/// A sliding ladder separates from the wall when its top has descended by a third, and then keeps its
/// velocity along the floor.
#[test]
fn sliding_ladder_separates_from_the_wall() {
    let (m, half, start) = (Ladder {}, 2.0, 1.2_f64);
    let q = [half * start.cos(), half * start.sin(), core::f64::consts::PI - start];
    let leaves = 2.0 / 3.0 * start.sin();
    let rate = (1.5 * G / half * start.sin() / 3.0).sqrt();
    let speed = half * rate * leaves;
    let (mut nearest, mut after) = (f64::INFINITY, 0);
    for sample in simulate(&m).from(q, [0.0; 3]).method(precise_event_driven_method()).duration(1.1) {
        let sample = sample.unwrap();
        let height = sample.q[1] / half;
        nearest = nearest.min((height - leaves).abs());
        let gaps = m.contact_gaps(&sample.q);
        assert!(gaps.min() > -1e-12 && gaps[1] < 1e-11, "{gaps}");
        if height > leaves + 1e-9 {
            let turning = 1.5 * G / half * (start.sin() - height);
            assert!((sample.v[2] * sample.v[2] - turning).abs() < 1e-9 && gaps[0] < 1e-11, "{sample:?}");
        } else {
            assert!((sample.v[0] - speed).abs() < 1e-9, "{sample:?} {speed}");
            after += 1;
        }
    }
    assert!(nearest < 1e-9 && after > 5, "{nearest} {after}");
}

/// Valve in which a preloaded spring presses a disc on its seat.
#[mechanism]
struct Valve {
    restitution: f64,
    #[particle(mass = 0.02)]
    disc: Particle,
    #[joint(ground -> disc, along = z)]
    lift: Sleeve,
    #[acts(on = lift, stiffness = 800, free_length = -0.004)]
    spring: Spring,
    #[limit(on = lift, from = 0, restitution = restitution)]
    seat: Limit,
}

/// The valve chatters: flights last `2/ω atan(v/(ω d))` for a preload of `k d`, each impact reduces the speed
/// by the factor `e`, and after infinitely many impacts the valve is closed.
#[test]
fn valve_chatters_with_closed_form_flights() {
    let (omega, preload, restitution) = ((800.0_f64 / 0.02).sqrt(), 0.004, 0.6);
    let m = Valve { restitution };
    let simulate_valve = |t: f64| {
        simulate(&m).from([0.0], [1.5]).method(precise_event_driven_method()).duration(t).finish().unwrap()
    };
    let (mut t, mut speed) = (0.0, 1.5_f64);
    for k in 0..60 {
        let flight = 2.0 / omega * (speed / (omega * preload)).atan();
        if k < 12 {
            let top = simulate_valve(t + flight / 2.0);
            let height = preload.hypot(speed / omega) - preload;
            assert!((top.q[0] - height).abs() < 1e-11 && top.v[0].abs() < 1e-8, "{k}: {top:?} {height}");
        }
        t += flight;
        speed *= restitution;
    }
    let closed = simulate_valve(t * 1.001);
    assert!(closed.q[0].abs() < 1e-14 && closed.v[0].abs() < 1e-14, "{closed:?}");
    // The valve stays closed with the force k d.
    let force = contact::acting(&m, 0.0, &closed.q, &closed.v, &SVector::zeros()).unwrap();
    assert!((force[0] - 800.0 * preload).abs() < 1e-6);
}

/// One-way clutch, or silent ratchet: a strut hinged 0.1 m above a slide, whose tip a torque of 0.3 N·m
/// presses on the slide.
#[mechanism]
struct OneWayClutch {
    friction: f64,
    /// Angle of the strut with the vertical, rad.
    lean: f64,
    #[body(mass = 2)]
    slide: Body,
    #[joint(ground -> slide, along = x)]
    way: Sleeve,
    #[acts(on = way)]
    load: Force,
    #[body(mass = 0.01, com = -0.05 / cos(lean) * y, inertia = rod(0.01, 0.1 / cos(lean), y))]
    strut: Body,
    #[joint(ground.at(0.1 * y) -> strut, about = z)]
    hinge: Pin,
    #[acts(on = hinge, value = 0.3)]
    press: Torque,
    #[contact(strut.at(-0.1 / cos(lean) * y), slide.plane(y), friction = friction)]
    tip: Contact,
}

/// Checks a clutch with a leaning strut. If tan α is less than the coefficient of friction, it blocks the
/// slide in one direction against any load, and drags with `μ τ / (L (sin α + μ cos α))` in the other. With
/// less friction it slips in both.
#[test]
fn leaning_strut_acts_as_a_one_way_clutch() {
    let simulate_clutch = |m: &OneWayClutch, load: f64, speed: f64, t: f64| {
        let steps = simulate(m).from([0.0, -m.lean], [speed, 0.0]).inputs(move |_, _, _| [load].into());
        steps.method(TimeStepping::step(1e-4)).duration(t).finish().unwrap()
    };
    let m = OneWayClutch { friction: 0.3, lean: 0.25_f64.atan() };
    let (sin, cos) = m.lean.sin_cos();
    let length = 0.1 / cos;
    let contacts = m.contact_gaps(&[0.0, -m.lean].into());
    assert!(contacts[0].abs() < 1e-15, "{contacts}");
    for load in [1.0, 100.0, 1e5] {
        let end = simulate_clutch(&m, load, 0.0, 0.2);
        assert!(end.q[0].abs() < 1e-9 && end.v.amax() < 1e-9, "{load}: {end:?}");
    }
    let end = simulate_clutch(&m, 0.0, 1.0, 0.01);
    assert!(end.q[0].abs() < 2e-4 && end.v.amax() < 1e-9, "{end:?}");
    let free = simulate_clutch(&m, -5.0, 0.0, 0.2);
    let drag = 0.3 * 0.3 / (length * (sin + 0.3 * cos));
    assert!((free.v[0] + (5.0 - drag) / 2.0 * 0.2).abs() < 1e-6, "{free:?} {drag}");
    let slippery = OneWayClutch { friction: 0.2, ..m };
    let drag = 0.2 * 0.3 / (length * (sin - 0.2 * cos));
    let slips = simulate_clutch(&slippery, drag + 4.0, 0.0, 0.2);
    assert!((slips.v[0] - 0.4).abs() < 1e-6, "{slips:?} {drag}");
    assert!(simulate_clutch(&slippery, drag - 0.1, 0.0, 0.2).v.amax() < 1e-9);
}

/// Belt of three links over a drum, with contacts at its joints and ends.
#[mechanism]
struct Belt {
    friction: f64,
    length: f64,
    radius: f64,
    #[body(mass = 0.05, com = length / 2 * x, inertia = rod(0.05, length, x))]
    first: Body,
    #[joint(ground -> first, about = z)]
    pose: Planar,
    #[body(mass = 0.05, com = length / 2 * x, inertia = rod(0.05, length, x))]
    second: Body,
    #[joint(first.at(length * x) -> second, about = z)]
    front: Pin,
    #[body(mass = 0.05, com = length / 2 * x, inertia = rod(0.05, length, x))]
    third: Body,
    #[joint(second.at(length * x) -> third, about = z)]
    back: Pin,
    #[acts(on = first, along = ground.x)]
    slack_x: Force,
    #[acts(on = first, along = ground.y)]
    slack_y: Force,
    #[acts(on = third.at(length * x), along = ground.x)]
    taut_x: Force,
    #[acts(on = third.at(length * x), along = ground.y)]
    taut_y: Force,
    #[contact(first, ground.cylinder(radius, z), friction = friction)]
    start: Contact,
    #[contact(second, ground.cylinder(radius, z), friction = friction)]
    one: Contact,
    #[contact(third, ground.cylinder(radius, z), friction = friction)]
    two: Contact,
    #[contact(third.at(length * x), ground.cylinder(radius, z), friction = friction)]
    end: Contact,
}

/// A belt that bends by `δ` at each of `n` points holds while the ratio of its tensions is below
/// `((1 + μ tan δ/2) / (1 − μ tan δ/2))ⁿ`. At a point between the tensions `T` and `T'` the normal force is
/// `(T + T') sin δ/2`, and friction balances `(T' − T) cos δ/2`. The limit is higher than the `e^{μ n δ}` of
/// a belt with continuous contact (Eytelwein's or Euler's formula).
#[test]
fn belt_holds_up_to_the_capstan_limit() {
    let (friction, radius, slack) = (0.3_f64, 0.1, 10.0);
    for turn in [0.3_f64, core::f64::consts::FRAC_PI_3] {
        let m = Belt { friction, length: 2.0 * radius * (turn / 2.0).sin(), radius };
        // Position of the first joint, and direction of the belt from there.
        let (at, way) = (core::f64::consts::FRAC_PI_2 + 1.5 * turn, turn);
        let q: SVector<f64, 5> = [radius * at.cos(), radius * at.sin(), way, -turn, -turn].into();
        let grip = friction * (turn / 2.0).tan();
        let limit = ((1.0 + grip) / (1.0 - grip)).powi(4);
        assert!(limit > (friction * 4.0 * turn).exp() * 1.002, "{limit}");
        let simulate_loaded_belt = |part: f64| {
            let (back, on) = ((way + turn).sin_cos(), (way - 3.0 * turn).sin_cos());
            let taut = slack * limit * part;
            let loads = [-slack * back.1, -slack * back.0, taut * on.1, taut * on.0];
            simulate(&m).from(q, [0.0; 5]).inputs(move |_, _, _| loads.into())
        };
        let slip_with_time_stepping = |part: f64, h: f64, t: f64| {
            let end = simulate_loaded_belt(part).method(TimeStepping::step(h)).duration(t).finish().unwrap();
            (end.q - q).amax()
        };
        let event_driven_slip_distance = |part: f64| {
            let end = simulate_loaded_belt(part).method(EventDriven::new()).duration(0.02).finish().unwrap();
            (end.q - q).amax()
        };
        for part in [0.5, 0.9, 0.999, 1.0 - 1e-6] {
            let (steps, events) =
                (slip_with_time_stepping(part, 1e-3, 0.1), event_driven_slip_distance(part));
            assert!(steps < 1e-12 && events < 1e-11, "{turn} {part}: {steps} {events}");
        }
        // Above the limit the belt slips, at first in proportion to the excess load.
        let (little, more) = (event_driven_slip_distance(1.0 + 1e-6), event_driven_slip_distance(1.0 + 1e-5));
        assert!(little > 1e-8 && (more / little - 10.0).abs() < 0.01, "{little} {more}");
        let slips = slip_with_time_stepping(1.0 + 1e-5, 1e-4, 0.02);
        assert!((slips / more - 1.0).abs() < 0.01, "{slips} {more}");
    }
}
