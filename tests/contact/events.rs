//! Tests of motions with located contact events against closed-form solutions, to rounding.

use linkwork::integrate::EventDriven;
use linkwork::prelude::*;

fn precise_event_driven_method() -> EventDriven<f64> {
    EventDriven::new().tolerance(1e-13, 1e-13)
}

#[mechanism(gravity = -9.81 * z)]
struct Ball {
    restitution: f64,
    #[particle(mass = 0.1)]
    ball: Particle,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball, ground.plane(z), restitution = restitution)]
    bounce: Contact,
}

/// The n-th apex of a ball that falls from 1 m is e²ⁿ m high, and the ball rests from the time √(2 h / g) (1
/// + e) / (1 − e).
#[test]
fn bouncing_ball_rests_at_the_zeno_time() {
    let (g, e) = (9.81_f64, 0.8_f64);
    let fall = (2.0 / g).sqrt();
    let m = Ball { restitution: e };
    let simulate_ball = || simulate(&m).from([1.0], [0.0]).method(precise_event_driven_method());
    let mut apex = 0.0;
    for n in 1..12 {
        apex += fall * (e.powi(n - 1) + e.powi(n));
        let top = simulate_ball().duration(apex).finish().unwrap();
        assert!((top.q[0] - e.powi(2 * n)).abs() < 1e-12 && top.v[0].abs() < 1e-12, "{n}: {top:?}");
    }
    let rest = fall * (1.0 + e) / (1.0 - e);
    assert!((rest - 4.063712768871578).abs() < 1e-14);
    let mut last = 0.0;
    let mut samples = 0;
    for sample in simulate_ball().duration(10.0) {
        let sample = sample.unwrap();
        samples += 1;
        if sample.v[0].abs() > 1e-15 || sample.q[0].abs() > 1e-15 {
            last = sample.t;
        }
    }
    assert!((last - rest).abs() < 1e-12, "{last} {rest}");
    assert!(samples < 600, "{samples}");
    let stays = Ball { restitution: 0.0 };
    let end = simulate(&stays)
        .from([1.0], [0.0])
        .method(precise_event_driven_method())
        .duration(1e4)
        .finish()
        .unwrap();
    assert!(end.q[0].abs() < 1e-15 && end.v[0].abs() < 1e-15, "{end:?}");
}

/// A ball without loss bounces to the same height forever.
#[test]
fn elastic_ball_conserves_energy() {
    let m = Ball { restitution: 1.0 };
    let fall = (2.0 / 9.81_f64).sqrt();
    for start in [1.0_f64, 1e-10] {
        let period = fall * start.sqrt() * 2.0;
        let end = simulate(&m)
            .from([start], [0.0])
            .method(precise_event_driven_method())
            .duration(50.0 * period)
            .finish()
            .unwrap();
        let energy = end.v[0] * end.v[0] / 2.0 + 9.81 * end.q[0];
        assert!((energy / (9.81 * start) - 1.0).abs() < 1e-9, "{start}: {energy} {end:?}");
    }
}

#[mechanism(gravity = -9.81 * (cos(tilt) * z + sin(tilt) * x))]
struct Sphere {
    tilt: f64,
    friction: f64,
    #[body(mass = 0.1, inertia = sphere(0.1, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.05), ground.plane(z), friction = friction, restitution = 0.6)]
    floor: Contact,
    #[output(contact_force(floor))]
    load: Vector,
}

/// A sphere rolls down 15° from rest with 5/7 g sin 15°, with a friction force of 2/7 m g sin 15°.
#[test]
fn sphere_rolls_down_a_slope_with_located_events() {
    let m = Sphere { tilt: 15.0_f64.to_radians(), friction: 0.3 };
    let mut q = m.neutral();
    q[2] = 0.05;
    let end =
        simulate(&m).from(q, [0.0; 6]).method(precise_event_driven_method()).duration(2.0).finish().unwrap();
    let a = 5.0 / 7.0 * 9.81 * m.tilt.sin();
    assert!((a - 1.813_582_023_182_663_4).abs() < 1e-15);
    let speed = end.v[0].hypot(end.v[2]);
    assert!((speed - a * 2.0).abs() < 1e-11 && (end.q[0] + a * 2.0).abs() < 1e-11, "{end:?}");
    assert!((end.v[4] + a * 2.0 / 0.05).abs() < 1e-10 && (end.q[2] - 0.05).abs() < 1e-14, "{end:?}");
}

/// Checks that a ball which slides without rotation at 5 m/s begins to roll after 2 v / (7 μ g), with 5/7 of
/// its speed.
#[test]
fn sliding_bowling_ball_begins_to_roll() {
    let m = Sphere { tilt: 0.0, friction: 0.2 };
    let mut q = m.neutral();
    q[2] = 0.05;
    let rolls = 2.0 * 5.0 / (7.0 * 0.2 * 9.81);
    let run = simulate(&m)
        .from(q, [3.0, 4.0, 0.0, 0.0, 0.0, 0.0])
        .method(precise_event_driven_method())
        .duration(2.0);
    let mut found = None;
    for sample in run {
        let sample = sample.unwrap();
        // The velocity is compared in the ground's axes, since those of the ball have rotated.
        let q = sample.q;
        let turned = linkwork::nalgebra::Quaternion::new(q[6], q[3], q[4], q[5]);
        let axes = linkwork::nalgebra::UnitQuaternion::from_quaternion(turned).to_rotation_matrix();
        let omega = axes * sample.v.fixed_rows::<3>(3);
        let v = axes * sample.v.fixed_rows::<3>(0);
        let slip = (v[0] - omega[1] * 0.05).hypot(v[1] + omega[0] * 0.05);
        if found.is_none() && slip < 1e-11 {
            found = Some(sample.t);
            assert!((v[0] - 3.0 * 5.0 / 7.0).abs() < 1e-11 && (v[1] - 4.0 * 5.0 / 7.0).abs() < 1e-11, "{v}");
        }
        assert!(found.is_none() || slip < 1e-11, "{slip}");
    }
    assert!(found.is_some_and(|t| (t - rolls).abs() < 1e-11), "{found:?} {rolls}");
}

#[mechanism(gravity = -9.81 * z)]
struct Block {
    friction: f64,
    #[body(mass = 2)]
    block: Body,
    #[joint(ground -> block, along = x)]
    slide: Sleeve,
    #[acts(on = slide)]
    pull: Force,
    #[joint(block -> pad, along = z)]
    up: Sleeve,
    #[particle(mass = 1)]
    pad: Particle,
    #[contact(pad, ground.plane(z), friction = friction)]
    rubs: Contact,
}

/// A force that grows with time moves the block when it exceeds friction, and that instant is located. When
/// the force ends, the block comes to rest and stays at rest.
#[test]
fn block_breaks_loose_and_stops_at_located_instants() {
    let m = Block { friction: 0.4 };
    let hold = 0.4 * 9.81;
    let applied_force = |t: f64| if t < 4.0 { 1.5 * t } else { 0.0 };
    let loose = hold / 1.5;
    // The force ends at a control instant.
    let run = simulate(&m)
        .inputs(|t, _, _| [applied_force(t)].into())
        .method(precise_event_driven_method())
        .duration(4.0);
    let end = run.finish().unwrap();
    let s = 4.0 - loose;
    assert!((end.v[0] - 0.5 * 1.5 * s * s / 3.0).abs() < 1e-11, "{end:?}");
    assert!((end.q[0] - 1.5 * s * s * s / 18.0).abs() < 1e-11, "{end:?}");
    let brake = hold / 3.0;
    let stop = end.v[0] / brake;
    let run =
        simulate(&m).from(end.q, end.v).start_at(4.0).method(precise_event_driven_method()).duration(3600.0);
    let mut rests = None;
    for sample in run {
        let sample = sample.unwrap();
        if rests.is_none() && sample.v[0].abs() < 1e-12 {
            rests = Some(sample);
        }
        if let Some(rests) = rests {
            assert!((rests.q - sample.q).amax() < 1e-14 && sample.v.amax() < 1e-14, "{sample:?}");
        }
    }
    let rests = rests.unwrap();
    assert!((rests.t - 4.0 - stop).abs() < 1e-11, "{rests:?}");
    assert!((rests.q[0] - end.q[0] - end.v[0] * stop / 2.0).abs() < 1e-11, "{rests:?}");
}

#[mechanism(gravity = -9.81 * z)]
struct Crate {
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.2, 0.2, 0.4))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.2, 0.2, 0.4), ground.plane(z), friction = friction)]
    floor: Contact,
    push: Input,
    #[acts(on = block.at(0.2 * z), value = push * x)]
    pushes: Force,
}

/// Checks that a crate pushed at its top edge tips, before it slides, when the moment of the push exceeds
/// that of its weight.
#[test]
fn pushed_crate_tips_before_it_slides() {
    let m = Crate { friction: 0.8 };
    let mut q = m.neutral();
    q[2] = 0.2;
    // F · 0.4 = m g · 0.1 at F = m g / 4.
    let rate = 10.0;
    let tips = 2.0 * 9.81 / 4.0 / rate;
    let run = simulate(&m)
        .from(q, [0.0; 6])
        .inputs(|t, _, _| [rate * t].into())
        .method(precise_event_driven_method());
    let rests = run.clone().duration(tips - 1e-3).finish().unwrap();
    assert!((rests.q - q).amax() < 1e-13, "{rests:?}");
    // Rotation about the edge: initially I θ̈ = 0.4 rate (t − tips).
    let s = 1e-3;
    let end = run.duration(tips + s).finish().unwrap();
    let inertia =
        2.0 / 12.0 * (0.2_f64.powi(2) + 0.4_f64.powi(2)) + 2.0 * (0.1_f64.powi(2) + 0.2_f64.powi(2));
    let expected = 0.4 * rate * s * s / 2.0 / inertia;
    assert!((end.v[4] / expected - 1.0).abs() < 1e-3, "{} {expected}", end.v[4]);
}

#[mechanism(gravity = -9.81 * y)]
struct RockingBlock {
    friction: f64,
    #[body(mass = 3, inertia = cuboid(3, 0.1, 0.5, 0.1))]
    block: Body,
    #[joint(ground -> block, about = z)]
    pose: Planar,
    #[contact(block.at(-0.05 * x - 0.25 * y), ground.plane(y), friction = friction)]
    left: Contact,
    #[contact(block.at(0.05 * x - 0.25 * y), ground.plane(y), friction = friction)]
    right: Contact,
}

/// A slender block rocks from edge to edge. Between impacts θ satisfies I θ̈ = −m g R sin(α − θ), and an
/// impact on the other edge leaves the fraction 1 − (3/2) sin² α of the angular velocity (Housner, *The
/// behavior of inverted pendulum structures during earthquakes*, 1963).
#[test]
fn rocking_block_follows_housners_model() {
    let m = RockingBlock { friction: 5.0 };
    let (half, height) = (0.05_f64, 0.25_f64);
    let (alpha, radius) = ((half / height).atan(), half.hypot(height));
    let tilt = 0.5 * alpha;
    // The block is rotated about its right edge by −tilt.
    let (sine, cosine) = tilt.sin_cos();
    let q = [half - (half * cosine - height * sine), half * sine + height * cosine, -tilt];
    let inertia = 4.0 / 3.0 * 3.0 * radius * radius;
    let potential_energy_at_tilt = |tilt: f64| 3.0 * 9.81 * radius * (alpha - tilt).cos();
    let run = simulate(&m).from(q, [0.0; 3]).method(precise_event_driven_method()).duration(2.0);
    let (mut before, mut impacts) = (None::<f64>, 0);
    let mut rate = (2.0 * (potential_energy_at_tilt(tilt) - potential_energy_at_tilt(0.0)) / inertia).sqrt();
    for sample in run {
        let sample = sample.unwrap();
        let (tilt, speed) = (sample.q[2], sample.v[2]);
        let energy = inertia / 2.0 * speed * speed + potential_energy_at_tilt(tilt.abs());
        if let Some(before) = before
            && energy < before - 1e-6
        {
            impacts += 1;
            rate *= 1.0 - 1.5 * alpha.sin().powi(2);
        }
        before = Some(energy);
        let expected = inertia / 2.0 * rate * rate + potential_energy_at_tilt(0.0);
        assert!((energy - expected).abs() < 1e-10, "{impacts}: {energy} {expected} {sample:?}");
    }
    assert!(impacts >= 6, "{impacts}");
}

/// A bouncing ball has two samples for each impact, before and after it, at the same time and position.
#[test]
fn impacts_have_samples_before_and_after() {
    #[mechanism(gravity = -9.81 * z)]
    struct Ball {
        #[particle(mass = 0.1)]
        ball: Particle,
        #[joint(ground -> ball, along = z)]
        height: Sleeve,
        #[contact(ball, ground.plane(z), restitution = 0.5)]
        bounce: Contact,
    }
    let fall = (2.0 / 9.81_f64).sqrt();
    let run = simulate(&Ball {}).from([1.0], [0.0]).method(EventDriven::new()).duration(2.6 * fall);
    let samples: Vec<_> = run.map(|sample| sample.unwrap()).collect();
    let impacts: Vec<_> = samples.windows(2).filter(|pair| pair[0].t == pair[1].t).collect();
    // The impacts are at 1, 2 and 2.5 times the duration of the fall, with velocities that halve.
    assert_eq!(impacts.len(), 3);
    for (k, (pair, time)) in impacts.iter().zip([1.0, 2.0, 2.5]).enumerate() {
        let speed = 9.81 * fall * 0.5_f64.powi(k as i32);
        assert!((pair[0].t - time * fall).abs() < 1e-10);
        assert!((pair[0].v[0] + speed).abs() < 1e-9 && (pair[1].v[0] - 0.5 * speed).abs() < 1e-9);
        assert!(pair[0].q == pair[1].q && pair[0].q[0].abs() < 1e-12);
    }
    // Impacts that are declared as events have two samples, too.
    #[mechanism(gravity = -9.81 * z)]
    struct DroppedBall {
        #[particle(mass = 0.1)]
        ball: Particle,
        #[joint(ground -> ball, along = z)]
        height: Sleeve,
    }
    let run = simulate(&DroppedBall {}).from([1.0], [0.0]).sample_every(10.0).duration(1.5 * fall);
    let run = run.impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| v * -0.5);
    let samples: Vec<_> = run.map(|sample| sample.unwrap()).collect();
    let events: Vec<_> = samples.iter().map(|sample| sample.event).collect();
    assert_eq!(events, [None, None, Some(0), None]);
    assert!(samples[1].t == samples[2].t && samples[1].v * -0.5 == samples[2].v);
}
