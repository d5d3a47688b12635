//! Somersault of a quadruped: without contacts, Newton's and Euler's laws determine its centre of mass and
//! its angular momentum.

use crate::report::{
    Picture, Section, Table, UpperBoundCheck, declaration_of_mechanism, format_number, pairs_of_curve,
};
use crate::scene::{Part, Point, Scene, Tone, View, corners_of_box, faces_of_box, point_in_ground};
use linkwork::integrate::Method;
use linkwork::nalgebra::{Matrix3, Vector3};
use linkwork::prelude::*;
use linkwork_design::picture::Chart;
use linkwork_models::Solo12;

type QuadrupedSample = Sample<f64, 19, 18, 12>;

const G: f64 = 9.81;
/// Velocity of the centre of mass at take-off, m/s, and the time until it returns to the same height, s.
const TAKE_OFF: [f64; 3] = [-0.35, 0.0, 4.2];
const FLIGHT: f64 = 2.0 * TAKE_OFF[2] / G;
const PERIOD: f64 = 1e-3;
/// Angles of hip and knee of a front leg, rad; hind legs bend in the opposite direction.
const STANDING: [f64; 2] = [0.7, -1.4];
const TUCKED: [f64; 2] = [1.5, -2.7];
/// Intervals in which the legs are tucked and extended, as fractions of the flight.
const TUCKING: [f64; 2] = [0.12, 0.3];
const OPENING: [f64; 2] = [0.68, 0.86];
/// Frames per second of the animation.
const RATE: f64 = 200.0;

pub fn run_quadruped_tour() -> Result<Section, Box<dyn std::error::Error>> {
    let (spin, landing) = find_takeoff_spin()?;
    let runs = [
        ("implicit midpoint", "1 ms", simulate_flight(spin, ImplicitMidpoint::step(PERIOD))?),
        ("Runge–Kutta 4", "1 ms", simulate_flight(spin, Rk4::step(PERIOD))?),
        (
            "Dormand–Prince, tolerance 1e-13",
            "adaptive",
            simulate_flight(spin, DormandPrince::new().tolerance(1e-13, 1e-13))?,
        ),
    ];
    let worst_error = |errors: &[[f64; 2]]| errors.iter().map(|e| e[1]).fold(0.0, f64::max);
    let table_row_of_method = |(name, step, samples): &(&str, &str, Vec<QuadrupedSample>)| {
        let errors = [distance_from_parabola(samples), angular_momentum_drift(samples)]
            .map(|e| format_number(worst_error(&e)));
        [vec![name.to_string(), step.to_string()], errors.to_vec()].concat()
    };
    let table = Table {
        head: vec![
            "integrator",
            "step",
            "centre of mass off parabola, m",
            "angular momentum, relative drift",
        ],
        rows: runs.iter().map(table_row_of_method).collect(),
    };
    let [_, _, (_, _, samples)] = &runs;
    let angular_rate_samples = |k: usize| samples.iter().map(|s| [s.t, s.v[3 + k]]).collect::<Vec<_>>();
    let fastest = angular_rate_samples(1).iter().map(|r| r[1].abs()).fold(0.0, f64::max);
    let checks = vec![
        UpperBoundCheck::new(
            "centre of mass off its parabola, m",
            worst_error(&distance_from_parabola(samples)),
            1e-11,
        ),
        UpperBoundCheck::new(
            "angular momentum about it, relative drift",
            worst_error(&angular_momentum_drift(samples)),
            1e-11,
        ),
        UpperBoundCheck::new("trunk against level at landing, rad", landing, 1e-6),
        UpperBoundCheck::new("spin at take-off / fastest spin, legs tucked", spin.y.abs() / fastest, 0.9),
    ];
    let pictures = vec![
        Picture::over_time("Angular velocity of the trunk", "angular velocity, rad/s", |chart| {
            let add_rate_curve = |chart: Chart, (k, name): (usize, &str)| {
                chart.curve(name, pairs_of_curve(&angular_rate_samples(k)))
            };
            let chart = ["roll", "pitch", "yaw"].into_iter().enumerate().fold(chart, add_rate_curve);
            chart.instant(TUCKING[0] * FLIGHT, "tuck").instant(OPENING[0] * FLIGHT, "open")
        })?,
        Picture::over_time("Conservation (Dormand–Prince)", "deviation", |chart| {
            let fallen = chart
                .logarithmic()
                .curve("centre of mass off parabola, m", pairs_of_curve(&distance_from_parabola(samples)));
            fallen.curve("angular momentum, relative", pairs_of_curve(&angular_momentum_drift(samples)))
        })?,
    ];
    Ok(Section {
        title: "A quadruped turns a somersault".into(),
        text: format!(
            "Solo 12 from its URDF file, floating base, 18 degrees of freedom, {FLIGHT:.2} s in the air. \
             Joint controllers \
             draw the legs in and stretch them out, not quite evenly; like a skater it spins faster when \
                 small. Newton's \
             method has found the take-off spin ({}) rad/s for which it lands level.",
            spin.iter().map(|w| format!("{w:.2}").replace('-', "−")).collect::<Vec<_>>().join(", ")
        ),
        declaration: declaration_of_mechanism(include_str!("../../src/quadruped.rs"), "Solo12"),
        equations: "",
        tables: vec![table],
        checks,
        scenes: vec![scene_of_samples(samples)],
        pictures,
    })
}

/// Returns the desired joint angles of the legs at a time.
fn desired_posture(t: f64) -> SVector<f64, 12> {
    let part = t / FLIGHT;
    let smoothstep_over_interval = |[from, to]: [f64; 2], part: f64| {
        let s = ((part - from) / (to - from)).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    };
    SVector::from_fn(|k, _| {
        let (leg, joint) = (k / 3, k % 3);
        // The left hind leg is delayed.
        let late = if leg == 2 { 0.04 } else { 0.0 };
        let tuck =
            smoothstep_over_interval(TUCKING, part - late) - smoothstep_over_interval(OPENING, part - late);
        let bend = if leg < 2 { 1.0 } else { -1.0 };
        match joint {
            0 => 0.0,
            _ => bend * (STANDING[joint - 1] + tuck * (TUCKED[joint - 1] - STANDING[joint - 1])),
        }
    })
}

/// Returns the state of the quadruped at take-off, with the feet on the floor and the desired velocities of
/// centre of mass and trunk.
fn take_off_state(spin: Vector3<f64>) -> (SVector<f64, 19>, SVector<f64, 18>) {
    let robot = Solo12;
    let mut q = robot.neutral();
    q.fixed_rows_mut::<12>(7).copy_from(&desired_posture(0.0));
    q[2] = FOOT - robot.frame_placement(frame!(Solo12, "FL_FOOT"), &q).translation.z;
    let arm = robot.center_of_mass(&q) - q.fixed_rows::<3>(0);
    let mut v = SVector::<f64, 18>::zeros();
    v.fixed_rows_mut::<3>(0).copy_from(&(Vector3::from(TAKE_OFF) - spin.cross(&arm)));
    v.fixed_rows_mut::<3>(3).copy_from(&spin);
    (q, v)
}

/// Radius of a foot, m.
const FOOT: f64 = 0.018;

fn simulate_flight(spin: Vector3<f64>, method: impl Method<f64>) -> Result<Vec<QuadrupedSample>, Error> {
    let (q, v) = take_off_state(spin);
    simulate(&Solo12)
        .from(q, v)
        .control_every(PERIOD, |t, q, v| {
            8.0 * (desired_posture(t) - q.fixed_rows::<12>(7)) - 0.15 * v.fixed_rows::<12>(6)
        })
        .method(method)
        .duration(FLIGHT)
        .sample_every(1.0 / RATE)
        .collect()
}

/// Returns the angular velocity at take-off for which the trunk is level again at the end, and the remaining
/// tilt.
fn find_takeoff_spin() -> Result<(Vector3<f64>, f64), Box<dyn std::error::Error>> {
    let rotation_over_flight = |spin: Vector3<f64>| -> Result<Vector3<f64>, Box<dyn std::error::Error>> {
        let samples = simulate_flight(spin, Rk4::step(PERIOD))?;
        let (first, last) = samples.first().zip(samples.last()).ok_or("no samples")?;
        Ok(Solo12.difference(&first.q, &last.q).fixed_rows::<3>(3).into_owned())
    };
    let mut spin = Vector3::new(0.0, -5.0, 0.0);
    let mut error = rotation_over_flight(spin)?;
    for _ in 0..12 {
        if error.norm() < 1e-9 {
            break;
        }
        let mut slope = Matrix3::zeros();
        for k in 0..3 {
            let mut other = spin;
            other[k] += 1e-4;
            slope.set_column(k, &((rotation_over_flight(other)? - error) / 1e-4));
        }
        let step = slope.try_inverse().ok_or("a spin that changes nothing")? * error;
        spin -= step * (0.5 / step.norm()).min(1.0);
        error = rotation_over_flight(spin)?;
    }
    Ok((spin, error.norm()))
}

/// Returns the distance of the centre of mass from its free-fall parabola over time, m.
fn distance_from_parabola(samples: &[QuadrupedSample]) -> Vec<[f64; 2]> {
    let start = Solo12.center_of_mass(&samples[0].q);
    let free_fall_position = |t: f64| start + Vector3::from(TAKE_OFF) * t - Vector3::z() * (G * t * t / 2.0);
    samples
        .iter()
        .skip(1)
        .map(|s| [s.t, (Solo12.center_of_mass(&s.q) - free_fall_position(s.t)).norm()])
        .collect()
}

/// Returns the relative change of the angular momentum about the centre of mass over time.
fn angular_momentum_drift(samples: &[QuadrupedSample]) -> Vec<[f64; 2]> {
    let angular_momentum = |s: &QuadrupedSample| Solo12.momentum(&s.q, &s.v).fixed_rows::<3>(3).into_owned();
    let start = angular_momentum(&samples[0]);
    samples.iter().skip(1).map(|s| [s.t, (angular_momentum(s) - start).norm() / start.norm()]).collect()
}

fn scene_of_samples(samples: &[QuadrupedSample]) -> Scene {
    let frame_index_of_link =
        |leg: &str, link: &str| Solo12::frame_index(&format!("{leg}_{link}")).unwrap_or(0);
    let legs = ["FL", "FR", "HL", "HR"];
    let points_of_sample = |s: &QuadrupedSample| {
        let at = Solo12.frame_placements(&s.q);
        let trunk = Solo12.frame_placement(frame!(Solo12, "base_link"), &s.q);
        let mut points: Vec<Point> = corners_of_box(&trunk, [0.0; 3], [0.2, 0.055, 0.028]).to_vec();
        for leg in legs {
            for link in ["SHOULDER", "UPPER_LEG", "LOWER_LEG", "FOOT"] {
                points.push(point_in_ground(&at[frame_index_of_link(leg, link)], [0.0; 3]));
            }
            // Axle of the shoulder, from inside the trunk.
            let inwards = if leg.ends_with('L') { -0.05 } else { 0.05 };
            points.push(point_in_ground(&at[frame_index_of_link(leg, "SHOULDER")], [0.0, inwards, 0.0]));
        }
        points.push(Solo12.center_of_mass(&s.q).into());
        points
    };
    let mut parts: Vec<Part> = faces_of_box(0, Tone::Body).collect();
    for k in 0..4 {
        let first = 8 + 5 * k;
        let tone = if k % 2 == 0 { Tone::Accent } else { Tone::Second };
        parts.extend([
            Part::Rod(first + 4, first + 1, 0.022, Tone::Dark),
            Part::Rod(first + 1, first + 2, 0.018, tone),
            Part::Rod(first + 2, first + 3, 0.011, tone),
            Part::Ball(first + 2, 0.02, Tone::Dark),
            Part::Ball(first + 3, FOOT, Tone::Dark),
        ]);
    }
    let start = Solo12.center_of_mass(&samples[0].q);
    let free_fall_position = |k: usize| {
        let t = FLIGHT * k as f64 / 60.0;
        (start + Vector3::from(TAKE_OFF) * t - Vector3::z() * (G * t * t / 2.0)).into()
    };
    let sample_index_at_flight_fraction = |part: f64| (part * FLIGHT * RATE) as usize;
    Scene {
        title: "Somersault of Solo 12, a quarter of its speed",
        rate: RATE,
        speed: 0.25,
        parts,
        frames: samples.iter().map(points_of_sample).collect(),
        still: 0.75,
        captions: vec![
            (0, "take-off".into()),
            (sample_index_at_flight_fraction(TUCKING[0]), "tucking: spins faster".into()),
            (sample_index_at_flight_fraction(OPENING[0]), "opening: spins slower".into()),
        ],
        guides: vec![(0..=60).map(free_fall_position).collect()],
        trail: Some((28, 400)),
        view: View {
            target: [TAKE_OFF[0] * FLIGHT / 2.0, 0.0, 0.66],
            size: [1.7, 1.55],
            yaw: -18.0,
            pitch: 9.0,
            turning: 0.0,
            floor: Some([0.0, 0.8]),
        },
    }
}
