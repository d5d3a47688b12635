//! Static friction above kinetic friction: closed forms of blocks that stick, slide and stick again.

use linkwork::contact;
use linkwork::integrate::{EventDriven, TimeStepping};
use linkwork::prelude::*;

#[mechanism(gravity = 9.81 * (sin(tilt) * x - cos(tilt) * z))]
struct Block {
    friction: f64,
    stiction: f64,
    tilt: f64,
    #[body(mass = 2)]
    block: Body,
    #[joint(ground -> block, along = (x, y, z))]
    place: Stage,
    #[contact(block, ground.plane(z), friction = friction, stiction = stiction)]
    sole: Contact,
    #[acts(on = block, along = x)]
    push: Force,
    #[acts(on = block, along = y)]
    side: Force,
}

const G: f64 = 9.81;
const LEVEL: Block = Block { friction: 0.4, stiction: 0.6, tilt: 0.0 };

fn precise_event_driven_method() -> EventDriven<f64> {
    EventDriven::new().tolerance(1e-12, 1e-12)
}

/// Distance and speed at time `t` of a block on level ground whose pulling force grows by `ramp`, N/s: it
/// sticks until the force is `μₛ m g`, and then accelerates by `(F − μ m g) / m`.
fn pulled_block_motion(ramp: f64, t: f64) -> [f64; 2] {
    let (weight, mass) = (2.0 * G, 2.0);
    let start = 0.6 * weight / ramp;
    let s = t - start;
    let excess = (0.6 - 0.4) * weight;
    [(excess * s * s / 2.0 + ramp * s.powi(3) / 6.0) / mass, (excess * s + ramp * s * s / 2.0) / mass]
}

#[test]
fn pulled_block_breaks_away_at_the_static_force() {
    let ramp = 20.0;
    for direction in [[1.0, 0.0], [0.6, -0.8]] {
        let simulate_pulled_block = |duration: f64| {
            simulate(&LEVEL)
                .from([0.0; 3], [0.0; 3])
                .inputs(move |t, _, _| SVector::<f64, 2>::from(direction) * (ramp * t))
                .duration(duration)
        };
        let before = simulate_pulled_block(0.58).method(precise_event_driven_method()).finish().unwrap();
        assert!(before.v.amax() < 1e-14 && before.q.amax() < 1e-14, "{before:?}");
        let end = simulate_pulled_block(1.5).method(precise_event_driven_method()).finish().unwrap();
        let steps = simulate_pulled_block(1.5).method(TimeStepping::step(1e-3)).finish().unwrap();
        let [distance, speed] = pulled_block_motion(ramp, 1.5);
        for (i, along) in direction.into_iter().enumerate() {
            assert!((end.q[i] - distance * along).abs() < 1e-10, "{end:?} {distance}");
            assert!((end.v[i] - speed * along).abs() < 1e-10, "{end:?} {speed}");
            assert!((steps.q[i] - distance * along).abs() < 4e-3, "{steps:?} {distance}");
            assert!((steps.v[i] - speed * along).abs() < 4e-3, "{steps:?} {speed}");
        }
    }
}

/// Checks a block on a slope between the angles of kinetic and static friction: it stays at rest, continues
/// to slide downwards once it does, and comes to rest after sliding upwards.
#[test]
fn block_on_a_slope_depends_on_static_and_kinetic_friction() {
    let tilt = 0.5_f64.atan();
    let slope = Block { tilt, ..LEVEL };
    let simulate_on_slope = |v: f64| simulate(&slope).from([0.0; 3], [v, 0.0, 0.0]).duration(1.0);
    let (sin, cos) = tilt.sin_cos();
    let (down, up) = (G * (sin - 0.4 * cos), G * (sin + 0.4 * cos));
    for (v, distance, speed) in
        [(0.0, 0.0, 0.0), (0.1, 0.1 + down / 2.0, 0.1 + down), (-1.0, -1.0 / (2.0 * up), 0.0)]
    {
        let end = simulate_on_slope(v).method(precise_event_driven_method()).finish().unwrap();
        assert!((end.q[0] - distance).abs() < 1e-11 && (end.v[0] - speed).abs() < 1e-11, "{v} {end:?}");
        let steps = simulate_on_slope(v).method(TimeStepping::step(1e-3)).finish().unwrap();
        assert!((steps.q[0] - distance).abs() < 1e-3 && (steps.v[0] - speed).abs() < 1e-9, "{v} {steps:?}");
    }
}

/// A spring of stiffness `k` whose end moves at a constant speed `V` pulls a block: stick-slip with the
/// period `2 Δ / V + (π + 2 φ) / ω` where `Δ = (μₛ − μ) m g / k` and `tan φ = V / (ω Δ)`.
#[test]
fn spring_driven_block_has_the_stick_slip_period() {
    let (k, speed, mass): (f64, f64, f64) = (50.0, 0.1, 2.0);
    let spring_pull = move |t: f64, q: &SVector<f64, 3>| [k * (speed * t - q[0]), 0.0].into();
    let omega = (k / mass).sqrt();
    let excess = 0.2 * mass * G / k;
    let phi = (speed / (omega * excess)).atan();
    let period = 2.0 * excess / speed + (std::f64::consts::PI + 2.0 * phi) / omega;
    let first = 0.6 * mass * G / k / speed;
    for periods in 1..4 {
        let n = f64::from(periods);
        // In the middle of the time in which it sticks.
        let t = first + n * period - excess / speed;
        let simulate_on_spring =
            || simulate(&LEVEL).from([0.0; 3], [0.0; 3]).inputs(move |t, q: &_, _: &_| spring_pull(t, q));
        let end = simulate_on_spring().method(precise_event_driven_method()).duration(t).finish().unwrap();
        assert!((end.q[0] - n * speed * period).abs() < 1e-9, "{end:?} {}", n * speed * period);
        assert!(end.v.amax() < 1e-14, "{end:?}");
    }
}

#[test]
fn contact_forces_use_static_and_kinetic_coefficients() {
    let weight = 2.0 * G;
    let contact_force_of_block = |v: f64, push: f64| {
        let (q, v) = (SVector::zeros(), [v, 0.0, 0.0].into());
        contact::acting(&LEVEL, 0.0, &q, &v, &[push, 0.0].into()).unwrap()
    };
    for (v, push, friction) in [
        (0.0, 0.5 * weight, -0.5 * weight),
        (0.0, 0.7 * weight, -0.4 * weight),
        (1.0, 0.5 * weight, -0.4 * weight),
        (-1.0, 0.0, 0.4 * weight),
    ] {
        let f = contact_force_of_block(v, push);
        assert!((f[0] - weight).abs() < 1e-7, "{f}");
        assert!((f[1] - friction).abs() < 1e-7 && f[2].abs() < 1e-7, "{v} {push}: {f}");
    }
}

#[mechanism(gravity = -9.81 * z)]
struct Crate {
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    load: Body,
    #[joint(ground -> load)]
    pose: Free,
    #[contact(load.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = 0.4, stiction = 0.6)]
    sole: Contact,
    #[acts(on = load, along = x)]
    push: Force,
}

/// A crate on four corners, which share its weight, sticks below the static force and slides above it.
#[test]
fn corners_of_a_crate_break_away_together() {
    let mut q = Crate {}.neutral();
    let height = Crate::CONFIGURATION.iter().position(|name| *name == "pose.z").unwrap();
    q[height] = 0.05;
    for (push, speed) in [(0.55 * 2.0 * G, 0.0), (0.65 * 2.0 * G, 0.25 * G * 0.5)] {
        let simulate_crate =
            || simulate(&Crate {}).from(q, SVector::zeros()).inputs(move |_, _, _| [push].into());
        let end = simulate_crate().duration(0.5).method(TimeStepping::step(1e-3)).finish().unwrap();
        let i = Crate::VELOCITIES.iter().position(|name| *name == "pose.vx").unwrap();
        assert!((end.v[i] - speed).abs() < 1e-9, "{push}: {}", end.v);
    }
}

#[test]
fn static_friction_below_kinetic_friction_is_an_error() {
    for (friction, stiction) in [(0.4, 0.3), (0.0, 0.3), (0.4, f64::NAN)] {
        let m = Block { friction, stiction, tilt: 0.0 };
        let at = contact::acting(&m, 0.0, &SVector::zeros(), &SVector::zeros(), &SVector::zeros());
        let Err(ConstraintError::Coefficient { constraint: "sole", value }) = at else { panic!("{at:?}") };
        assert!(value == stiction || stiction.is_nan() && value.is_nan());
    }
    assert!(Block { stiction: 0.3, ..LEVEL }.validate().is_err());
    assert!(LEVEL.validate().is_ok());
}
