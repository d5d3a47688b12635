//! Contacts of single bodies (balls, blocks and rods) against closed-form solutions.

use linkwork::contact;
use linkwork::prelude::*;

const G: f64 = 9.81;

#[mechanism(gravity = -9.81 * z)]
struct Ball {
    restitution: f64,
    #[body(mass = 0.5, inertia = sphere(0.5, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.05), ground.plane(z), friction = 0.4, restitution = restitution)]
    bounce: Contact,
}

/// Returns the heights of the apexes of a ball that is dropped from `height` above its contact position.
fn apex_heights(m: &Ball, height: f64, h: f64, duration: f64) -> Vec<f64> {
    let mut q = m.neutral();
    q[2] = 0.05 + height;
    let run = simulate(m).from(q, [0.0; 6]).method(TimeStepping::step(h)).duration(duration);
    let samples: Vec<_> = run.map(|sample| sample.unwrap()).collect();
    let turns = samples.windows(2).filter(|pair| pair[0].v[2] > 0.0 && pair[1].v[2] <= 0.0);
    // Between two steps the height follows a parabola.
    turns.map(|pair| pair[0].q[2] - 0.05 + pair[0].v[2] * pair[0].v[2] / (2.0 * G)).collect()
}

/// Checks that the n-th apex of a ball dropped from a height h is e²ⁿ h. Other engines miss it: with the
/// nominal restitution 0.25 they bounce with 0.25, 0.07 or 0.01 (dimforge/rapier, issue 974).
#[test]
fn bounce_heights_follow_the_coefficient_of_restitution() {
    for e in [0.3, 0.5, 0.8, 0.95, 1.0] {
        let m = Ball { restitution: e };
        let [coarse, fine] = [1e-3, 1e-4].map(|h| {
            let found = apex_heights(&m, 1.0, h, 1.6);
            (found[0] - e * e).abs()
        });
        assert!(coarse < 8e-3 && fine < 8e-4, "{e}: {coarse}, {fine}");
    }
}

/// A ball comes to rest after infinitely many bounces, at the time √(2h/g)(1 + e)/(1 − e), and stays at rest.
#[test]
fn ball_comes_to_rest_at_the_zeno_time() {
    let m = Ball { restitution: 0.8 };
    let mut q = m.neutral();
    q[2] = 1.05;
    let rest = (2.0 / G).sqrt() * 1.8 / 0.2;
    assert!((rest - 4.063_712_768_871_578).abs() < 1e-12);
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(1e-4)).duration(5.0);
    let samples: Vec<_> = run.map(|sample| sample.unwrap()).collect();
    let last = samples.iter().rfind(|sample| sample.v[2].abs() > 1e-9).unwrap();
    assert!((last.t - rest).abs() < 0.03, "{} {rest}", last.t);
    let end = samples.last().unwrap();
    assert!((end.q[2] - 0.05).abs() < 1e-8 && end.v.norm() < 1e-14, "{end:?}");
}

/// A ball without restitution is at rest after its first impact.
#[test]
fn plastic_impact_stops_the_ball() {
    let m = Ball { restitution: 0.0 };
    let mut q = m.neutral();
    q[2] = 1.05;
    let fall = (2.0 / G).sqrt();
    for sample in simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(1.0) {
        let sample = sample.unwrap();
        if sample.t > fall + 2e-3 {
            assert!((sample.q[2] - 0.05).abs() < 1e-8 && sample.v.norm() < 1e-14, "{sample:?}");
        }
    }
}

#[mechanism(gravity = -9.81 * cos(tilt) * z + 9.81 * sin(tilt) * x)]
struct BallRollingOnSlope {
    tilt: f64,
    mass: f64,
    radius: f64,
    friction: f64,
    #[body(mass = mass, inertia = sphere(mass, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(radius), ground.plane(z), friction = friction)]
    slope: Contact,
}

/// Checks that a sphere rolls down a slope of 15° with the acceleration 5/7 g sin α and the friction force
/// 2/7 m g sin α. Parameters are those of Drake's test.
#[test]
fn sphere_rolls_down_a_slope_by_closed_form() {
    let tilt = 15.0_f64.to_radians();
    let m = BallRollingOnSlope { tilt, mass: 0.1, radius: 0.05, friction: 0.5 };
    let mut q = m.neutral();
    q[2] = 0.05;
    let (h, t) = (1e-3, 2.0);
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(h)).duration(t);
    let end = run.last().unwrap().unwrap();
    let acceleration = 1.813_582_023_182_663_4;
    assert!((acceleration - G * tilt.sin() * 5.0 / 7.0).abs() < 1e-14);
    // The sphere rotates by 0.07 rad in the last step. The method has order 4 in the axes of the velocity and
    // an error of 1e-6.
    let along = end.v.fixed_rows::<3>(0).norm();
    assert!((along - acceleration * t).abs() < 2e-6, "{along}");
    assert!((end.q[0] - acceleration * t * t / 2.0).abs() < 2e-6, "{}", end.q[0]);
    let force = contact::forces(&m, end.t, &end.q, &end.v, &SVector::zeros(), h).unwrap();
    assert!((force[0] - 0.1 * G * tilt.cos()).abs() < 1e-5, "{force}");
    let friction = (force[1] * force[1] + force[2] * force[2]).sqrt();
    assert!((friction - 0.072_543_280_927_306_54).abs() < 1e-6, "{friction}");
    // At rest, without rotation, the forces are exact to rounding.
    let start = contact::forces(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros(), h).unwrap();
    let friction = (start[1] * start[1] + start[2] * start[2]).sqrt();
    assert!((friction * 0.05 - 0.003_627_164_046_365_327).abs() < 1e-13, "{friction}");
}

/// Friction that is too small for rolling lets the sphere slip: g (sin α − μ cos α).
#[test]
fn sphere_slips_down_a_steep_slope() {
    let (tilt, friction) = (1.0_f64, 0.2);
    let m = BallRollingOnSlope { tilt, mass: 0.1, radius: 0.05, friction };
    assert!(friction < 2.0 / 7.0 * tilt.tan());
    let mut q = m.neutral();
    q[2] = 0.05;
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(1.0);
    let end = run.last().unwrap().unwrap();
    let acceleration = G * (tilt.sin() - friction * tilt.cos());
    assert!((end.q[0] - acceleration / 2.0).abs() < 1e-6, "{}", end.q[0] - acceleration / 2.0);
}

#[mechanism(gravity = -9.81 * cos(tilt) * z + 9.81 * sin(tilt) * x)]
struct Block {
    tilt: f64,
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction)]
    face: Contact,
}

impl Block {
    fn configuration_on_slope(&self) -> SVector<f64, 7> {
        let mut q = self.neutral();
        q[2] = 0.05;
        q
    }
}

/// A block on a slope below the angle of friction does not move by a micrometre in ten minutes. The forces at
/// its four corners are not unique.
#[test]
fn block_sticks_on_a_slope_for_ten_minutes() {
    let m = Block { tilt: 15.0_f64.to_radians(), friction: 0.5 };
    let q = m.configuration_on_slope();
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(0.1)).duration(600.0);
    let end = run.sample_every(600.0).last().unwrap().unwrap();
    assert!((end.q - q).norm() < 1e-9, "{:e}", (end.q - q).norm());
}

/// Checks that a block on a slope above the angle of friction slides with g (sin α − μ cos α) and stays flat
/// on its face.
#[test]
fn block_slides_down_a_steep_slope() {
    let (tilt, friction) = (30.0_f64.to_radians(), 0.3);
    let m = Block { tilt, friction };
    let run = simulate(&m)
        .from(m.configuration_on_slope(), [0.0; 6])
        .method(TimeStepping::step(1e-3))
        .duration(1.0);
    let end = run.last().unwrap().unwrap();
    let acceleration = G * (tilt.sin() - friction * tilt.cos());
    assert!((end.q[0] - acceleration / 2.0).abs() < 1e-9, "{:e}", end.q[0] - acceleration / 2.0);
    assert!((end.q[2] - 0.05).abs() < 1e-8 && end.q[3].hypot(end.q[4]).hypot(end.q[5]) < 1e-8);
}

/// A block that slides on a level plane comes to rest after v²/(2 μ g), and stays at rest.
#[test]
fn sliding_block_stops_after_the_coulomb_distance() {
    let m = Block { tilt: 0.0, friction: 0.3 };
    let mut v = SVector::zeros();
    v[0] = 1.5;
    let run = simulate(&m).from(m.configuration_on_slope(), v).method(TimeStepping::step(1e-3)).duration(2.0);
    let end = run.last().unwrap().unwrap();
    let way = 1.5 * 1.5 / (2.0 * 0.3 * G);
    assert!((end.q[0] - way).abs() < 1e-5 && end.v.norm() < 1e-13, "{:e}", end.q[0] - way);
}

#[mechanism]
struct LogsAndBlock {
    #[body(mass = 1.5, inertia = cylinder(1.5, 0.1, 1, x))]
    first: Body,
    #[joint(ground -> first)]
    pose: Free,
    #[body(mass = 1, inertia = cylinder(1, 0.05, 0.6, z))]
    second: Body,
    #[joint(ground -> second)]
    other: Free,
    #[body(mass = 1, inertia = cuboid(1, 0.4, 0.3, 0.2))]
    block: Body,
    #[joint(ground -> block)]
    third: Free,
    #[contact(first.capsule(0.1, 1, x), second.capsule(0.05, 0.6, z), friction = 0.3)]
    cross: Contact,
    #[contact(block.cuboid(0.4, 0.3, 0.2), second.at(0.3 * z).sphere(0.05), friction = 0.3)]
    head: Contact,
}

/// Checks that the computed distances between capsules, and between a sphere and a box, equal the minimum
/// over many pairs of points.
#[test]
fn computed_distances_are_minima_over_points() {
    let m = LogsAndBlock {};
    let mut seed = 3_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    for case in 0..60 {
        let moved = SVector::<f64, 18>::from_fn(|k, _| {
            let size = if k % 6 < 3 { 1.0 } else { 3.0 };
            // Some of the capsules are parallel.
            if case % 5 == 0 && (3..6).contains(&k) {
                if k == 4 { core::f64::consts::FRAC_PI_2 } else { 0.0 }
            } else if case % 5 == 0 && (9..12).contains(&k) {
                0.0
            } else {
                random() * size
            }
        });
        let q = m.integrate(&m.neutral(), &moved);
        let ground_position_of_body_point = |body: usize, p: [f64; 3]| {
            let s = &q.as_slice()[7 * body..];
            let rotation = linkwork::nalgebra::UnitQuaternion::from_quaternion(
                linkwork::nalgebra::Quaternion::new(s[6], s[3], s[4], s[5]),
            );
            rotation * linkwork::nalgebra::Vector3::from(p)
                + linkwork::nalgebra::Vector3::new(s[0], s[1], s[2])
        };
        // Ternary search: distance is convex along both lines.
        let minimum_on_interval = |f: &dyn Fn(f64) -> f64| {
            let (mut a, mut b) = (-1.0, 1.0);
            for _ in 0..55 {
                let (c, d) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
                if f(c) < f(d) { b = d } else { a = c }
            }
            f((a + b) / 2.0)
        };
        let lines = minimum_on_interval(&|s| {
            minimum_on_interval(&|t| {
                (ground_position_of_body_point(0, [0.5 * s, 0.0, 0.0])
                    - ground_position_of_body_point(1, [0.0, 0.0, 0.3 * t]))
                .norm()
            })
        });
        let gaps = m.contact_gaps(&q);
        // The first of five contact points of capsules is the closest one, unless an end is as close.
        let cross = gaps.fixed_rows::<5>(0);
        assert!((gaps[0] - (lines - 0.15)).abs() < 1e-6, "{case}: {} {}", gaps[0], lines - 0.15);
        assert!(cross.min() > gaps[0] - 1e-6, "{case}: {cross}");
        let center = ground_position_of_body_point(1, [0.0, 0.0, 0.3]);
        // The distance to the box is convex along each of its axes.
        let distance_beyond_box_along_axis = |axis: usize, half: f64| {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            let x = (center - ground_position_of_body_point(2, [0.0; 3]))
                .dot(&(ground_position_of_body_point(2, unit) - ground_position_of_body_point(2, [0.0; 3])));
            (x.abs() - half).max(0.0)
        };
        let cuboid = (distance_beyond_box_along_axis(0, 0.2).powi(2)
            + distance_beyond_box_along_axis(1, 0.15).powi(2)
            + distance_beyond_box_along_axis(2, 0.1).powi(2))
        .sqrt();
        assert!((gaps[5] - (cuboid - 0.05)).abs() < 1e-6, "{case}: {} {}", gaps[5], cuboid - 0.05);
        // Contact velocities are the rates of the gap functions.
        let v = SVector::<f64, 18>::from_fn(|_, _| random());
        let h = 1e-6;
        let change = (m.contact_gaps(&m.integrate(&q, &(v * h)))
            - m.contact_gaps(&m.integrate(&q, &(v * -h))))
            / (2.0 * h);
        let rates = m.contact_rates(&q, &v);
        if cuboid > 1e-3 && lines > 1e-3 && case % 5 != 0 {
            assert!((change[0] - rates[0]).abs() < 1e-6 && (change[5] - rates[15]).abs() < 1e-6, "{case}");
        }
    }
}

/// A log in the groove between two fixed parallel logs.
#[mechanism(gravity = -9.81 * z)]
struct LogInGroove {
    #[body(mass = 1, inertia = capsule(1, 0.05, 0.4, x))]
    log: Body,
    #[joint(ground -> log)]
    pose: Free,
    #[contact(log.capsule(0.05, 0.4, x), ground.at(0.05 * y).capsule(0.05, 0.6, x), friction = 0.3)]
    left: Contact,
    #[contact(log.capsule(0.05, 0.4, x), ground.at(-0.05 * y).capsule(0.05, 0.6, x), friction = 0.3)]
    right: Contact,
}

/// Checks that a tilted log falls into the groove between two others and comes to rest parallel to them, with
/// three centres at the corners of an equilateral triangle. Logs overlap by less than a thousandth of their
/// radius.
#[test]
fn log_comes_to_rest_in_a_groove() {
    let m = LogInGroove {};
    let mut q = m.neutral();
    let half = 0.05_f64;
    (q[2], q[4], q[6]) = (0.15, half.sin(), half.cos());
    let height = 0.1 * 0.75_f64.sqrt();
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(3.0);
    let mut last = q;
    for sample in run.sample_every(1e-3) {
        last = sample.unwrap().q;
        let overlap = -m.contact_gaps(&last).min();
        assert!(overlap < 5e-5, "{overlap:e} m");
    }
    assert!((last[2] - height).abs() < 1e-6 && last[4].abs() < 1e-6, "{last}");
}
