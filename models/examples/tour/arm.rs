//! A Panda arm draws a figure eight with a load that its controller's model does not include.

use crate::report::{Picture, Section, Table, UpperBoundCheck, declaration_of_mechanism, format_number};
use crate::scene::{Part, Point, Scene, Tone, View, point_in_ground};
use linkwork::nalgebra::{IsometryMatrix3, Vector3, Vector6};
use linkwork::prelude::*;
use linkwork_design::picture::Chart;
use linkwork_models::{LoadedPanda, PandaArm};
use std::f64::consts::{FRAC_PI_4, TAU};
use std::hint::black_box;
use std::time::Instant;

type JointVector = SVector<f64, 7>;

/// Initial joint angles: elbow up, hand vertically down.
const HOME: [f64; 7] = [0.0, -0.3, 0.0, -2.2, 0.0, 1.9, FRAC_PI_4];
/// Mass of the load in the hand, kg.
const LOAD: f64 = 1.5;
/// Period of the control loop, s.
const PERIOD: f64 = 1e-3;
const DURATION: f64 = 10.0;
/// Time in which the arm draws the eight twice, s; the arm rests afterwards.
const DRAWING: f64 = 8.5;
/// Half width and half height of the eight, m.
const EIGHT: [f64; 2] = [0.28, 0.14];
/// Gains of the position error and of the velocity error, 1/s² and 1/s: critically damped at 20 rad/s.
const STIFFNESS: f64 = 400.0;
const DAMPING: f64 = 40.0;
/// Bandwidth of the disturbance observer, 1/s.
const BANDWIDTH: f64 = 60.0;
/// Frames per second of the animation.
const RATE: f64 = 50.0;

/// Results of one run of the arm.
struct ArmRun {
    samples: Vec<Sample<f64, 7, 7, 7>>,
    /// Distance of the fingertips from their desired position, m.
    error: Vec<f64>,
    /// Final torques of the disturbance observer, N·m.
    felt: JointVector,
    /// Computing time of each control step, ns.
    cost: Vec<f64>,
}

/// Computed-torque control in the task space of the hand, with the model without a load.
struct TaskSpaceController {
    /// Whether the controller uses the disturbance observer.
    observing: bool,
    /// Desired orientation of the hand.
    home: IsometryMatrix3<f64>,
    /// External torques, as estimated by the observer.
    felt: JointVector,
    /// Generalized momentum that the observer's model predicts.
    momentum: JointVector,
}

pub fn arm_tour_section() -> Result<Section, Box<dyn std::error::Error>> {
    let cases = [
        ("no load", simulate_drawing(0.0, false)?),
        ("unknown load", simulate_drawing(LOAD, false)?),
        ("unknown load, observed", simulate_drawing(LOAD, true)?),
    ];
    let table_row_of_run = |(name, run): &(&str, ArmRun)| {
        let weighed = estimate_load_mass(run);
        let last = run.error.last().copied().unwrap_or(f64::NAN);
        vec![
            name.to_string(),
            format_number(1e3 * run.rms_error()),
            format_number(1e3 * run.largest_error()),
            format_number(1e3 * last),
            if run.felt.amax() > 0.0 { format!("{weighed:.3} kg") } else { "–".into() },
            format!("{:.1} µs", 1e-3 * median_time(&run.cost)),
        ]
    };
    let table = Table {
        head: vec!["", "rms error, mm", "largest, mm", "at rest, mm", "load weighed", "control step"],
        rows: cases.iter().map(table_row_of_run).collect(),
    };
    let [exact, loaded, observed] = &cases.each_ref().map(|(_, run)| run);
    let checks = vec![
        UpperBoundCheck::new("no load: largest error, mm", 1e3 * exact.largest_error(), 0.05),
        UpperBoundCheck::new("unknown load: largest error, mm", 1e3 * loaded.largest_error(), 40.0),
        UpperBoundCheck::new(
            "unknown load, observed: largest error, mm",
            1e3 * observed.largest_error(),
            5.0,
        ),
        UpperBoundCheck::new(
            "load weighed by joint torques, error in kg",
            (estimate_load_mass(observed) - LOAD).abs(),
            0.01,
        ),
        UpperBoundCheck::new("largest torque / limit of the joint", observed.largest_relative_torque(), 1.0),
        UpperBoundCheck::new(
            "median time of a control step, µs",
            1e-3 * median_time(&observed.cost),
            1e6 * PERIOD,
        ),
    ];
    let table_row_of_timing = |(name, times): (&str, [f64; 2])| {
        [vec![name.to_string()], times.map(|ns| format!("{ns:.0} ns")).to_vec()].concat()
    };
    let calls = Table {
        head: vec!["generated function", "median", "least"],
        rows: function_timings(&observed.samples).map(table_row_of_timing).into(),
    };
    let scene = scene_of_run(observed);
    let add_error_curve = |chart: Chart, (name, run): &(&str, ArmRun)| {
        chart.curve(*name, run.samples.iter().zip(&run.error).skip(1).map(|(s, e)| (s.t, 1e3 * e)))
    };
    let add_torque_curve = |chart: Chart, k: usize| {
        let points = observed.samples.iter().step_by(10).map(|s| (s.t, s.u[k]));
        chart.curve(format!("joint {}", k + 1), points)
    };
    let pictures = vec![
        Picture::over_time("Tracking error of the fingertips", "error, mm", |chart| {
            cases.iter().fold(chart.logarithmic(), add_error_curve).instant(DRAWING, "at rest")
        })?,
        Picture::over_time(
            "Torques of the first four motors, unknown load, observed",
            "torque, N·m",
            |chart| (0..4).fold(chart, add_torque_curve),
        )?,
    ];
    Ok(Section {
        title: "A seven-axis arm draws a figure eight".into(),
        text: format!(
            "Franka's Panda from its URDF file under computed torque at {:.0} kHz, the hand pointing down. \
             The controller's \
             model is the bare arm; the arm carries {LOAD} kg. Without a force sensor, a momentum observer \
                 built on the \
             generated momentum and its rate feels the load, cancels it and weighs it.",
            1e-3 / PERIOD
        ),
        declaration: declaration_of_mechanism(include_str!("../../src/arm7.rs"), "LoadedPanda"),
        equations: "",
        tables: vec![table, calls],
        checks,
        scenes: vec![scene],
        pictures,
    })
}

/// Returns desired position, velocity and acceleration of the fingertips, relative to the start.
fn desired_figure_eight_motion(t: f64) -> [Vector3<f64>; 3] {
    // Phase from 0 to 2 turns, with zero velocity and acceleration at both ends.
    let s = (t / DRAWING).clamp(0.0, 1.0);
    let turns = 2.0 * TAU;
    let phase = turns * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    let rate = turns * 30.0 * s * s * (1.0 - s) * (1.0 - s) / DRAWING;
    let growth = turns * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (DRAWING * DRAWING);
    let [width, height] = EIGHT;
    let along = Vector3::new(0.0, width * phase.cos(), 2.0 * height * (2.0 * phase).cos());
    let curved = Vector3::new(0.0, -width * phase.sin(), -4.0 * height * (2.0 * phase).sin());
    let at = Vector3::new(0.0, width * phase.sin(), height * (2.0 * phase).sin());
    [at, along * rate, along * growth + curved * rate * rate]
}

fn pose_of_hand(q: &JointVector) -> IsometryMatrix3<f64> {
    PandaArm.frame_placement(frame!(PandaArm, "panda_hand_tcp"), q)
}

/// Returns the small rotation from one frame to another, rad: half of the sum of the cross products of their
/// axes.
fn small_rotation_between(from: &IsometryMatrix3<f64>, to: &IsometryMatrix3<f64>) -> Vector3<f64> {
    let axis_of_frame = |frame: &IsometryMatrix3<f64>, k| frame.rotation.matrix().column(k).into_owned();
    (0..3).map(|k| axis_of_frame(from, k).cross(&axis_of_frame(to, k))).sum::<Vector3<f64>>() / 2.0
}

impl TaskSpaceController {
    fn new(observing: bool) -> Self {
        Self {
            observing,
            home: pose_of_hand(&HOME.into()),
            felt: JointVector::zeros(),
            momentum: JointVector::zeros(),
        }
    }

    /// Returns the joint torques for one period of the control loop.
    fn control_torques(&mut self, t: f64, q: &JointVector, v: &JointVector) -> JointVector {
        let arm = PandaArm;
        let tip = frame!(PandaArm, "panda_hand_tcp");
        let [at, velocity, acceleration] = desired_figure_eight_motion(t);
        let hand = arm.frame_placement(tip, q);
        let twist = arm.frame_velocity(tip, q, v);
        let jacobian = arm.frame_jacobian(tip, q);

        // Desired linear and angular acceleration of the hand.
        let offset = self.home.translation.vector + at - hand.translation.vector;
        let turn = small_rotation_between(&hand, &self.home);
        let stack_vectors = |a: Vector3<f64>, b: Vector3<f64>| Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z);
        let wanted = stack_vectors(acceleration, Vector3::zeros())
            + DAMPING * (stack_vectors(velocity, Vector3::zeros()) - twist)
            + STIFFNESS * stack_vectors(offset, turn);
        let drift = arm.frame_acceleration(tip, q, v, &JointVector::zeros());

        // Joint accelerations with this hand acceleration; the redundant degree of freedom keeps the elbow
        // near its initial posture.
        let square = jacobian * jacobian.transpose() + SMatrix::<f64, 6, 6>::identity() * 1e-6;
        let inverse = square.try_inverse().unwrap_or_default();
        let posture = -20.0 * (q - JointVector::from(HOME)) - 9.0 * v;
        let a = posture + jacobian.transpose() * (inverse * (wanted - drift - jacobian * posture));
        let tau = arm.inverse_dynamics(q, v, &a) - self.felt;

        if self.observing {
            // De Luca and Mattone's observer (ICRA 2003): the estimated torque follows the residual of the
            // momentum.
            let rate = arm.momentum_rate(q, v) + tau + self.felt;
            let lacking = arm.generalized_momentum(q, v) - self.momentum;
            self.momentum += PERIOD * rate;
            self.felt = BANDWIDTH * lacking;
        }
        tau
    }
}

fn simulate_drawing(load: f64, observing: bool) -> Result<ArmRun, Error> {
    let arm = LoadedPanda { load };
    let mut controller = TaskSpaceController::new(observing);
    let mut cost = Vec::new();
    let run = simulate(&arm)
        .from(HOME, JointVector::zeros())
        .control_every(PERIOD, |t, q, v| {
            let start = Instant::now();
            let tau = controller.control_torques(t, q, v);
            cost.push(start.elapsed().as_nanos() as f64);
            tau
        })
        .method(Rk4::step(PERIOD))
        .duration(DURATION)
        .sample_every(PERIOD);
    let samples: Vec<_> = run.collect::<Result<_, _>>()?;
    let home = pose_of_hand(&HOME.into()).translation.vector;
    let tracking_error = |s: &Sample<f64, 7, 7, 7>| {
        (pose_of_hand(&s.q).translation.vector - home - desired_figure_eight_motion(s.t)[0]).norm()
    };
    Ok(ArmRun { error: samples.iter().map(tracking_error).collect(), felt: controller.felt, samples, cost })
}

impl ArmRun {
    fn rms_error(&self) -> f64 {
        (self.error.iter().map(|e| e * e).sum::<f64>() / self.error.len() as f64).sqrt()
    }

    fn largest_error(&self) -> f64 {
        self.error.iter().copied().fold(0.0, f64::max)
    }

    /// Returns the largest torque of any motor relative to its rating.
    fn largest_relative_torque(&self) -> f64 {
        let rated_torque = |k: usize| if k < 4 { 87.0 } else { 12.0 };
        self.samples
            .iter()
            .flat_map(|s| (0..7).map(move |k| s.u[k].abs() / rated_torque(k)))
            .fold(0.0, f64::max)
    }
}

/// Returns the mass whose weight at the fingertips fits the estimated torques best.
fn estimate_load_mass(run: &ArmRun) -> f64 {
    let Some(last) = run.samples.last() else { return f64::NAN };
    let jacobian = PandaArm.frame_jacobian(frame!(PandaArm, "panda_hand_tcp"), &last.q);
    let lift = jacobian.row(2).transpose();
    -run.felt.dot(&lift) / (9.81 * lift.norm_squared())
}

fn median_time(times: &[f64]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Returns the time per call of some generated functions, ns: median and minimum over batches of calls with
/// all states of the motion.
fn function_timings(samples: &[Sample<f64, 7, 7, 7>]) -> [(&'static str, [f64; 2]); 4] {
    let arm = PandaArm;
    let states: Vec<(JointVector, JointVector, JointVector)> =
        samples.iter().step_by(100).map(|s| (s.q, s.v, s.u * 0.1)).collect();
    let median_and_least_time = |f: &dyn Fn(&JointVector, &JointVector, &JointVector) -> f64| {
        let mean_time_per_call = || {
            let start = Instant::now();
            for (q, v, a) in &states {
                black_box(f(black_box(q), black_box(v), black_box(a)));
            }
            start.elapsed().as_nanos() as f64 / states.len() as f64
        };
        let times: Vec<f64> = (0..400).map(|_| mean_time_per_call()).collect();
        [median_time(&times), times.iter().copied().fold(f64::INFINITY, f64::min)]
    };
    let tip = frame!(PandaArm, "panda_hand_tcp");
    [
        ("inverse_dynamics", median_and_least_time(&|q, v, a| black_box(arm.inverse_dynamics(q, v, a))[0])),
        ("forward_dynamics", median_and_least_time(&|q, v, a| black_box(arm.forward_dynamics(q, v, a))[0])),
        ("mass_matrix", median_and_least_time(&|q, _, _| black_box(arm.mass_matrix(q))[0])),
        ("frame_jacobian", median_and_least_time(&|q, _, _| black_box(arm.frame_jacobian(tip, q))[0])),
    ]
}

fn scene_of_run(run: &ArmRun) -> Scene {
    let frame_index_of_name = |name: &str| PandaArm::frame_index(name).unwrap_or(0);
    let joints: [usize; 7] = std::array::from_fn(|k| frame_index_of_name(&format!("panda_link{}", k + 1)));
    let (flange, palm) = (frame_index_of_name("panda_link8"), frame_index_of_name("panda_hand"));
    let tip = frame_index_of_name("panda_hand_tcp");
    let points_of_sample = |s: &Sample<f64, 7, 7, 7>| {
        let at = PandaArm.frame_placements(&s.q);
        let mut points: Vec<Point> = vec![[0.0; 3]];
        // Origins of the links, then the ends of each joint's housing.
        points.extend(joints.map(|k| point_in_ground(&at[k], [0.0; 3])));
        points.push(point_in_ground(&at[flange], [0.0; 3]));
        for end in [-1.0, 1.0] {
            points.extend(joints.map(|k| point_in_ground(&at[k], [0.0, 0.0, 0.055 * end])));
        }
        // Points of the palm, the fingers, the load, and the edge of the base.
        for [y, z] in
            [[-0.085, 0.035], [0.085, 0.035], [-0.03, 0.05], [-0.03, 0.11], [0.03, 0.05], [0.03, 0.11]]
        {
            points.push(point_in_ground(&at[palm], [0.0, y, z]));
        }
        points.push(point_in_ground(&at[tip], [0.0, 0.0, 0.02]));
        points.push(point_in_ground(&at[tip], [0.0; 3]));
        points.push(point_in_ground(&at[flange], [0.0, 0.0, 0.02]));
        points
    };
    let mut parts = vec![Part::Rod(0, 1, 0.06, Tone::Body)];
    let thick = [0.055, 0.055, 0.055, 0.05, 0.05, 0.05, 0.04];
    parts.extend((1..8).map(|k| Part::Rod(k, k + 1, thick[k - 1], Tone::Body)));
    parts.extend(
        (0..7).map(|k| {
            Part::Rod(9 + k, 16 + k, [0.062, 0.062, 0.06, 0.058, 0.055, 0.05, 0.042][k], Tone::Dark)
        }),
    );
    parts.extend([
        Part::Rod(23, 24, 0.028, Tone::Body),
        Part::Rod(31, 8, 0.04, Tone::Body),
        Part::Rod(25, 26, 0.011, Tone::Dark),
        Part::Rod(27, 28, 0.011, Tone::Dark),
        Part::Ball(29, 0.045, Tone::Second),
    ]);
    let home = pose_of_hand(&HOME.into()).translation.vector;
    let guide =
        (0..=120).map(|k| (home + desired_figure_eight_motion(DRAWING / 2.0 * k as f64 / 120.0)[0]).into());
    let every = (1.0 / (RATE * PERIOD)).round() as usize;
    Scene {
        title: "Figure eight with an unknown load",
        rate: RATE,
        speed: 1.0,
        parts,
        frames: run.samples.iter().step_by(every).map(points_of_sample).collect(),
        still: 4.4,
        captions: vec![(0, "drawing".into()), ((DRAWING * RATE) as usize, "at rest: load weighed".into())],
        guides: vec![guide.collect()],
        trail: Some((30, 90)),
        view: View {
            target: [0.25, 0.0, 0.38],
            size: [1.2, 1.2],
            yaw: -55.0,
            pitch: 18.0,
            turning: 6.0,
            floor: Some([0.0, 0.6]),
        },
    }
}
