//! Heavy top: its precession and nutation against Lagrange's closed-form solutions.

use crate::report::{Picture, Section, Table, UpperBoundCheck, declaration_of_mechanism, format_number};
use crate::scene::{Part, Point, Scene, Tone, View, point_in_ground};
use linkwork::nalgebra::{IsometryMatrix3, UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::HeavyTop;
use std::f64::consts::TAU;

const TOP: HeavyTop<f64> = HeavyTop { g: 9.81, mass: 0.3, height: 0.05, axial: 2.4e-4, transverse: 1.8e-4 };
/// Initial inclination of the top, rad.
const TILT: f64 = 0.5;
/// Spin of the top about its axis, rad/s.
const SPIN: f64 = 150.0;
/// Number of revolutions of steady precession that are simulated.
const TURNS: f64 = 10.0;
/// Duration of the released top's animation, s.
const SHOWN: f64 = 2.8;
/// Frames per second of the animation.
const RATE: f64 = 240.0;

pub fn run_top_tour() -> Result<Section, Box<dyn std::error::Error>> {
    let across = TOP.transverse + TOP.mass * TOP.height * TOP.height;
    let (spin, weight) = (TOP.axial * SPIN, TOP.mass * TOP.g * TOP.height);
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), TILT);
    let q = [tilt.i, tilt.j, tilt.k, tilt.w];
    let method = DormandPrince::new().tolerance(1e-12, 1e-12);
    let mut table = Table { head: vec!["", "simulated", "closed form"], rows: Vec::new() };
    let mut checks = Vec::new();
    let mut add_closed_form_comparison = |row: &str, what, unit: &str, simulated: f64, closed: f64| {
        let cells = [simulated, closed].map(|x| format!("{x:.9} {unit}"));
        table.rows.push([vec![row.to_string()], cells.to_vec()].concat());
        checks.push(UpperBoundCheck::new(what, (simulated / closed - 1.0).abs(), 1e-9));
    };

    // Steady precession: the slower solution of A Ω² cos θ − C n Ω + m g h = 0.
    let rate = 2.0 * weight / (spin + (spin * spin - 4.0 * across * TILT.cos() * weight).sqrt());
    let mut omega = tilt.inverse() * Vector3::new(0.0, 0.0, rate);
    omega.z = SPIN;
    let end = simulate(&TOP).from(q, omega).method(method).duration(TURNS * TAU / rate).finish()?;
    let tip = axis_of_top(&end.q);
    let missed = tip.x.atan2(-tip.y);
    add_closed_form_comparison(
        "steady precession",
        "steady precession, relative error",
        "rad/s",
        rate * (1.0 + missed / (TURNS * TAU)),
        rate,
    );

    // Released with its axis at rest, the top falls to the other root of β (1 − u²) = a² (u₀ − u), and rises
    // again to a cusp.
    let (a2, b) = ((spin / across) * (spin / across), 2.0 * weight / across);
    let lowest = (a2 - (a2 * a2 - 4.0 * b * (a2 * TILT.cos() - b)).sqrt()) / (2.0 * b);
    let released = simulate(&TOP).from(q, [0.0, 0.0, SPIN]).method(method);
    let axis_height_rate = |_: f64, q: &SVector<f64, 4>, v: &SVector<f64, 3>| {
        (rotation_of_top(q) * Vector3::new(v.y, -v.x, 0.0)).z
    };
    let bottom = released.until_crossing(Crossing::Rising, axis_height_rate).finish()?;
    add_closed_form_comparison(
        "released: lowest inclination",
        "lowest inclination, relative error",
        "rad",
        axis_of_top(&bottom.q).z.acos(),
        lowest.acos(),
    );

    let samples: Vec<_> = simulate(&TOP)
        .from(q, [0.0, 0.0, SPIN])
        .method(method)
        .duration(SHOWN)
        .sample_every(1.0 / RATE)
        .collect::<Result<_, _>>()?;
    let nutation = Picture::over_time("Inclination of the axis", "inclination, rad", |chart| {
        let simulated = chart.curve("simulated", samples.iter().map(|s| (s.t, axis_of_top(&s.q).z.acos())));
        simulated
            .curve("closed form, highest", horizontal_line(TILT))
            .curve("closed form, lowest", horizontal_line(lowest.acos()))
    })?;
    // Both angular momenta are constant: φ̇ = (L − C n cos θ) / (A sin²θ), and L = C n cos θ₀.
    let fastest = spin * (TILT.cos() - lowest) / (across * (1.0 - lowest * lowest));
    let precession = Picture::over_time("Rate of precession: zero at the cusps", "rate, rad/s", |chart| {
        let simulated = chart.curve("simulated", samples.iter().map(|s| (s.t, precession_rate(s))));
        simulated.curve("closed form, fastest", horizontal_line(fastest))
    })?;

    let vertical_angular_momentum =
        |s: &Sample<f64, 4, 3, 0>| (rotation_of_top(&s.q) * TOP.generalized_momentum(&s.q, &s.v)).z;
    let momentum = samples
        .iter()
        .map(|s| (vertical_angular_momentum(s) / vertical_angular_momentum(&samples[0]) - 1.0).abs())
        .fold(0.0, f64::max);
    let slowed = samples.iter().map(|s| (s.v[2] / SPIN - 1.0).abs()).fold(0.0, f64::max);
    checks.push(UpperBoundCheck::new("angular momentum about the vertical, drift", momentum, 1e-9));
    checks.push(UpperBoundCheck::new("spin about the axis, drift", slowed, 1e-9));

    Ok(Section {
        title: "A heavy top precesses and nutates".into(),
        text: format!(
            "On a ball joint (a quaternion, no Euler angles), spinning at {} rad/s. Steady precession is \
             followed for \
             {TURNS} turns; then the top is let go with its axis at rest and draws cusps.",
            format_number(SPIN)
        ),
        declaration: declaration_of_mechanism(include_str!("../../src/heavy_top.rs"), "HeavyTop"),
        equations: HeavyTop::<f64>::EQUATIONS,
        tables: vec![table],
        checks,
        scenes: vec![scene_of_samples(&samples)],
        pictures: vec![nutation, precession],
    })
}

fn horizontal_line(value: f64) -> [(f64, f64); 2] {
    [(0.0, value), (SHOWN, value)]
}

fn rotation_of_top(q: &SVector<f64, 4>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion((*q).into())
}

fn axis_of_top(q: &SVector<f64, 4>) -> Vector3<f64> {
    rotation_of_top(q) * Vector3::z()
}

/// Returns the precession rate of the top's axis about the vertical, rad/s.
fn precession_rate(s: &Sample<f64, 4, 3, 0>) -> f64 {
    let (at, rate) = (axis_of_top(&s.q), rotation_of_top(&s.q) * Vector3::new(s.v.y, -s.v.x, 0.0));
    (at.x * rate.y - at.y * rate.x) / (at.x * at.x + at.y * at.y)
}

/// Number of points on the circumference of the drawn top.
const CORNERS: usize = 20;

fn scene_of_samples(samples: &[Sample<f64, 4, 3, 0>]) -> Scene {
    let points_of_ring = |body: &IsometryMatrix3<f64>, radius: f64, z: f64| {
        (0..CORNERS)
            .map(|k| TAU * k as f64 / CORNERS as f64)
            .map(|a| point_in_ground(body, [radius * a.cos(), radius * a.sin(), z]))
            .collect::<Vec<Point>>()
    };
    let points_of_sample = |s: &Sample<f64, 4, 3, 0>| {
        let body = TOP.frame_placement(frame!(HeavyTop<f64>, "top"), &s.q);
        let mut points = vec![
            [0.0; 3],
            point_in_ground(&body, [0.0, 0.0, 0.07]),
            point_in_ground(&body, [0.0, 0.0, 0.105]),
        ];
        points.extend(points_of_ring(&body, 0.042, 0.052));
        points.extend(points_of_ring(&body, 0.016, 0.07));
        points
    };
    let mut parts = vec![Part::Rod(1, 2, 0.003, Tone::Dark), Part::Ball(2, 0.0045, Tone::Accent)];
    for k in 0..CORNERS {
        let (a, b) = (3 + k, 3 + (k + 1) % CORNERS);
        let tone = if k < 3 { Tone::Second } else { Tone::Body };
        parts.push(Part::Face(vec![0, a, b], tone));
        parts.push(Part::Face(vec![a, b, b + CORNERS, a + CORNERS], tone));
    }
    parts.push(Part::Face((3 + CORNERS..3 + 2 * CORNERS).collect(), Tone::Body));
    Scene {
        title: "Released with its axis at rest, a quarter of its speed",
        rate: RATE,
        speed: 0.25,
        parts,
        frames: samples.iter().map(points_of_sample).collect(),
        still: 1.2,
        captions: Vec::new(),
        guides: Vec::new(),
        trail: Some((2, 1000)),
        view: View {
            target: [0.0, 0.0, 0.052],
            size: [0.19, 0.16],
            yaw: 20.0,
            pitch: 20.0,
            turning: 0.0,
            floor: Some([0.0, 0.1]),
        },
    }
}
