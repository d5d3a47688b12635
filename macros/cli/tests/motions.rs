//! Tests of the commands `simulate` and `view`.

#[path = "motions/flail.rs"]
mod flail;
#[path = "motions/live.rs"]
mod live;
#[path = "mechanisms/speeds.rs"]
mod speeds;

use flail::Flail;
use linkwork::prelude::*;
use speeds::Juggler;
use std::path::{Path, PathBuf};
use std::process::Command;

const FLAIL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/motions/flail.rs");

fn test_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn run_linkwork(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_linkwork")).current_dir(folder).args(arguments).output().unwrap();
    let decode_utf8 = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), decode_utf8(output.stdout), decode_utf8(output.stderr))
}

/// Returns the numbers of a CSV log, line by line.
fn rows_of_log(log: &str) -> Vec<Vec<f64>> {
    log.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect()
}

/// Checks that the command's simulation agrees with generated code and a fixed-step method.
#[test]
fn simulate_command_agrees_with_generated_code() {
    let here = test_folder("alike");
    std::fs::write(here.join("thrust.csv"), "t,u.thrust,remark\n0,0,1\n1,40,2\n2,10,3\n").unwrap();
    let thrust_at_time = |t: f64| if t < 1.0 { 40.0 * t } else { 40.0 - 30.0 * (t - 1.0) };
    let set =
        ["--set", "handle=0.5", "--set", "v.flight.wx=2", "--set", "v.chain.wy=-3", "--set", "q.flight.z=1"];
    let mut arguments =
        vec!["simulate", FLAIL, "--inputs", "thrust.csv", "--duration", "2", "--every", "0.5"];
    arguments.extend(set);
    arguments.extend(["--tolerance", "1e-11"]);
    let (status, log, stderr) = run_linkwork(&here, &arguments);
    assert_eq!((status, stderr.as_str()), (0, ""));
    assert!(log.starts_with("t,q.flight.x,"), "{log}");

    let flail = Flail { handle: 0.5 };
    let (mut q, mut v) = (flail.neutral(), SVector::<f64, 9>::zeros());
    (q[2], v[3], v[7]) = (1.0, 2.0, -3.0);
    let motion = simulate(&flail).from(q, v).inputs(|t, _, _| [thrust_at_time(t)].into());
    let motion = motion.method(Rk4::step(5e-4)).duration(2.0).sample_every(0.5);
    let samples: Vec<_> = motion.collect::<Result<_, _>>().unwrap();
    let rows = rows_of_log(&log);
    assert_eq!(rows.len(), 5);
    for (row, sample) in rows.iter().zip(&samples) {
        let other = std::iter::once(&sample.t).chain(&sample.q).chain(&sample.v);
        for (a, b) in row.iter().zip(other) {
            assert!((a - b).abs() < 1e-8, "{row:?} {:?} {:?}", sample.q, sample.v);
        }
        assert!((row[21] - thrust_at_time(row[0])).abs() < 1e-12);
    }
}

const JUGGLER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mechanisms/speeds.rs");

/// Checks configurations of a mechanism with declared generalized speeds, which are velocities along the
/// ground axes and combinations of rates. A speed that is a multiple of a rate is not confused with the rate.
#[test]
fn declared_speeds_are_integrated_to_configurations() {
    let here = test_folder("speeds");
    let begin = [0.3, -0.2, 1.5, 0.4, -1.0, 2.0, 0.7, -0.6];
    let names = ["ux", "uy", "uz", "wx", "wy", "wz", "swing", "bend"];
    let mut set =
        vec!["--set".to_string(), "axial=0.25".to_string(), "--set".to_string(), "q.theta=0.4".to_string()];
    set.extend(names.iter().zip(begin).flat_map(|(name, v)| ["--set".to_string(), format!("v.{name}={v}")]));
    let mut arguments =
        vec!["simulate", JUGGLER, "--duration", "1", "--every", "0.25", "--tolerance", "1e-11"];
    arguments.extend(set.iter().map(String::as_str));
    let (status, log, stderr) = run_linkwork(&here, &arguments);
    assert_eq!((status, stderr.as_str()), (0, ""));
    let juggler = Juggler { axial: 0.25 };
    let (mut q, v) = (juggler.neutral(), SVector::<f64, 8>::from(begin));
    q[8] = 0.4;
    let motion = simulate(&juggler).from(q, v).method(Rk4::step(5e-4)).duration(1.0).sample_every(0.25);
    let samples: Vec<_> = motion.collect::<Result<_, _>>().unwrap();
    for (row, sample) in rows_of_log(&log).iter().zip(&samples) {
        let other = std::iter::once(&sample.t).chain(&sample.q).chain(&sample.v);
        for (a, b) in row.iter().zip(other) {
            assert!((a - b).abs() < 1e-8, "{row:?} {:?} {:?}", sample.q, sample.v);
        }
    }
    let rotor = "
#[mechanism]
pub struct Rotor {
    #[body(mass = 1, inertia = diagonal(2, 3, 4))]
    rotor: Body,
    #[joint(ground -> rotor, about = z)]
    angle: Pin,
    #[speed(4 * rate(angle))]
    fast: Speed,
}
";
    std::fs::write(here.join("rotor.rs"), rotor).unwrap();
    let (status, log, _) =
        run_linkwork(&here, &["simulate", "rotor.rs", "--set", "v.fast=3", "--duration", "2"]);
    let end = rows_of_log(&log).pop().unwrap();
    assert!(status == 0 && (end[1] - 1.5).abs() < 1e-9 && (end[2] - 3.0).abs() < 1e-12, "{end:?}");
}

/// Checks states of first order: they start at zero or at the value of `--set`, and follow the closed form of
/// a lag of 0.5 s. Logs contain them, and a page is made from a log.
#[test]
fn states_of_first_order_are_integrated() {
    let here = test_folder("states");
    let sled = "
#[mechanism]
pub struct Sled {
    pub lag: f64,
    throttle: Input,
    #[state(rate = (throttle - thrust) / lag)]
    thrust: State,
    #[body(mass = 2)]
    sled: Body,
    #[joint(ground -> sled, along = x)]
    rail: Sleeve,
    #[acts(on = rail, value = thrust)]
    engine: Force,
}
";
    std::fs::write(here.join("sled.rs"), sled).unwrap();
    let simulate = ["simulate", "sled.rs", "--set", "lag=0.5", "--set", "u.throttle=6", "--duration", "2"];
    for (set, start) in [(&[][..], 0.0), (&["--set", "x.thrust=2"], 2.0), (&["--set", "thrust=2"], 2.0)] {
        let (status, log, stderr) = run_linkwork(&here, &[&simulate[..], set].concat());
        assert_eq!((status, stderr.as_str()), (0, ""));
        assert!(log.starts_with("t,q.rail,v.rail,x.thrust,u.throttle\r\n"), "{log}");
        for row in rows_of_log(&log) {
            let late = 1.0 - (-row[0] / 0.5).exp();
            let thrust = start + (6.0 - start) * late;
            let velocity = (6.0 * row[0] - (6.0 - start) * 0.5 * late) / 2.0;
            assert!((row[3] - thrust).abs() < 1e-6 && (row[2] - velocity).abs() < 1e-6, "{row:?}");
        }
    }
    let out = [&simulate[..], &["--out", "sled.csv"]].concat();
    assert_eq!(run_linkwork(&here, &out).0, 0);
    let view = ["view", "sled.rs", "--set", "lag=0.5", "--motion", "sled.csv"];
    assert_eq!(run_linkwork(&here, &view), (0, "Sled.html\n".to_string(), String::new()));
    // A log with some of the inputs, or with an input that `--set` gives too.
    let two = sled
        .replace("throttle: Input,", "throttle: Input,\n    brake: Input,")
        .replace("thrust)]", "thrust - brake)]");
    std::fs::write(here.join("two.rs"), two).unwrap();
    std::fs::write(here.join("one.csv"), "t,q.rail,u.brake\n0,0,1\n1,0,1\n").unwrap();
    let (status, _, stderr) =
        run_linkwork(&here, &["view", "two.rs", "--set", "lag=1", "--motion", "one.csv"]);
    assert!(status == 2 && stderr.contains("one.csv: there is no column `u.throttle`"), "{stderr}");
    let both = ["simulate", "two.rs", "--set", "lag=1", "--set", "u.brake=2", "--inputs", "one.csv"];
    let (status, _, stderr) = run_linkwork(&here, &both);
    assert!(status == 2 && stderr.contains("`u.brake` is a column here and given by `--set`"), "{stderr}");
    let log = [&simulate[..], &["--out", "sled.mcap"]].concat();
    assert_eq!(run_linkwork(&here, &log).0, 0);
    let states = messages_of_mcap(&std::fs::read(here.join("sled.mcap")).unwrap());
    let last = states.iter().rfind(|message| message.get("v").is_some()).unwrap();
    assert!((last["v"]["thrust"].as_f64().unwrap() - 6.0 * (1.0 - (-4.0_f64).exp())).abs() < 1e-6, "{last}");
    let (status, _, stderr) =
        run_linkwork(&here, &["simulate", "sled.rs", "--set", "lag=1", "--set", "x.thrst=1"]);
    assert!(
        status == 2 && stderr.contains("there is no `x.thrst`, but lag, q.rail, v.rail, x.thrust"),
        "{stderr}"
    );
}

/// Checks that a stiff arm is integrated by an implicit method, which is reported. The arm settles at the
/// deflection of the spring of 10⁶ N m/rad under its weight.
#[test]
fn stiff_mechanisms_are_integrated_by_an_implicit_method() {
    let here = test_folder("stiff");
    let arm = "
#[mechanism(gravity = -9.81 * y)]
pub struct Arm {
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    link: Body,
    #[body(mass = 0.01, com = 0.05 * x, inertia = rod(0.01, 0.1, x))]
    tip: Body,
    #[joint(ground -> link, about = z)]
    shoulder: Pin,
    #[joint(link.at(x) -> tip, about = z)]
    wrist: Pin,
    #[acts(on = shoulder, stiffness = 1e6)]
    drive: Spring,
    #[acts(on = shoulder, damping = 1e4)]
    damper: Dashpot,
    #[acts(on = wrist, stiffness = 1e4)]
    clamp: Spring,
    #[acts(on = wrist, damping = 100)]
    grease: Dashpot,
}
";
    std::fs::write(here.join("arm.rs"), arm).unwrap();
    let (status, log, stderr) =
        run_linkwork(&here, &["simulate", "arm.rs", "--duration", "2", "--set", "q.wrist=0.1"]);
    assert!(status == 0 && stderr.contains("the motion is stiff: from 0.0"), "{stderr}");
    let end = rows_of_log(&log).pop().unwrap();
    // Torque of the weight divided by the stiffness, with a relative error of 10⁻⁵ from the lever arm at
    // angle zero.
    let bend = -9.81 * (0.5 + 0.01 * 1.05) / 1e6;
    assert!((end[1] - bend).abs() < 1e-8 && (end[2] + 9.81 * 0.01 * 0.05 / 1e4).abs() < 1e-8, "{end:?}");
}

/// Checks that a page is made from a log, and from a simulated motion.
#[test]
fn pages_are_made_from_logs_and_simulations() {
    let here = test_folder("pages");
    let (status, path, stderr) =
        run_linkwork(&here, &["view", FLAIL, "--set", "handle=0.5", "--duration", "1", "--out", "one.html"]);
    assert_eq!((status, path.as_str(), stderr.as_str()), (0, "one.html\n", ""));
    let page = std::fs::read_to_string(here.join("one.html")).unwrap();
    assert!(page.contains("\"Cuboid\"") && page.contains("\"count\":61"), "{}", &page[..2000]);
    let log = ["simulate", FLAIL, "--set", "handle=0.5", "--duration", "1", "--out", "log.csv"];
    assert_eq!(run_linkwork(&here, &log), (0, String::new(), String::new()));
    let (status, _, stderr) =
        run_linkwork(&here, &["view", FLAIL, "--set", "handle=0.5", "--motion", "log.csv"]);
    assert_eq!((status, stderr.as_str()), (0, ""));
    // Both pages are equal up to the last digits.
    let again = std::fs::read_to_string(here.join("Flail.html")).unwrap();
    assert_eq!(again.len(), page.len());

    // Lengths, angles and inputs that change have separate plots.
    let cart = "
#[mechanism(gravity = -9.81 * y)]
pub struct Cart {
    #[body(mass = 1)]
    cart: Body,
    #[body(mass = 1, com = -y, inertia = rod(1, 2, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = rail)]
    push: Force,
}
";
    std::fs::write(here.join("cart.rs"), cart).unwrap();
    std::fs::write(here.join("push.csv"), "t,u.push\n0,0\n1,2\n").unwrap();
    for (inputs, plots) in [(&[][..], 0), (&["--inputs", "push.csv"], 1)] {
        let view = [&["view", "cart.rs", "--duration", "1"][..], inputs].concat();
        assert_eq!(run_linkwork(&here, &view).0, 0);
        let page = std::fs::read_to_string(here.join("Cart.html")).unwrap();
        let count_in_page = |text: &str| page.matches(text).count();
        assert_eq!((count_in_page("[\"Coordinates\","), count_in_page("[\"Inputs\",\"N\",")), (2, plots));
    }
}

/// Returns the messages of an MCAP file; a record begins with its kind and the length of its content.
fn messages_of_mcap(file: &[u8]) -> Vec<serde_json::Value> {
    let (mut rest, mut found) = (&file[8..file.len() - 8], Vec::new());
    while let [kind, length @ ..] = rest {
        let (length, after) = length.split_first_chunk().unwrap();
        let (content, next) = after.split_at(u64::from_le_bytes(*length) as usize);
        found.extend((*kind == 5).then(|| serde_json::from_slice(&content[22..]).unwrap()));
        rest = next;
    }
    found
}

/// Checks that the MCAP log has the states of the table in full precision, and the placements of generated
/// code.
#[test]
fn mcap_logs_contain_the_states_of_the_table() {
    let here = test_folder("logs");
    let simulate_to_file = |out: &str| {
        let (set, every) =
            (["--set", "handle=0.5", "--set", "v.chain.wy=-3"], ["--duration", "0.4", "--every", "0.2"]);
        let log = [&["simulate", FLAIL][..], &set, &every, &["--out", out]].concat();
        assert_eq!(run_linkwork(&here, &log), (0, String::new(), String::new()));
        std::fs::read(here.join(out)).unwrap()
    };
    let table = rows_of_log(&String::from_utf8(simulate_to_file("log.csv")).unwrap());
    let sample_from_row = |row: &Vec<f64>| {
        let (q, v) = (SVector::from_column_slice(&row[1..12]), SVector::from_column_slice(&row[12..21]));
        linkwork::simulate::Sample::<f64, 11, 9, 1> {
            t: row[0],
            q,
            v,
            u: [row[21]].into(),
            event: None,
            violation: 0.0,
        }
    };
    let samples: Vec<_> = table.iter().map(sample_from_row).collect();
    let expected = messages_of_mcap(&linkwork_view::mcap(&Flail { handle: 0.5 }, &samples).unwrap());
    let found = messages_of_mcap(&simulate_to_file("log.mcap"));
    assert_eq!((found.len(), expected.len()), (9, 9));
    for (found, expected) in found.iter().zip(&expected) {
        let Some(transforms) = found["transforms"].as_array() else {
            assert_eq!(found, expected);
            continue;
        };
        let others = expected["transforms"].as_array().unwrap();
        assert_eq!(transforms.len(), others.len());
        for (one, other) in transforms.iter().zip(others) {
            assert_eq!(one["child_frame_id"], other["child_frame_id"]);
            for (part, axes) in [("translation", "xyz"), ("rotation", "xyzw")] {
                for axis in axes.chars().map(String::from) {
                    let component_of_json = |of: &serde_json::Value| of[part][&axis].as_f64().unwrap();
                    assert!(
                        (component_of_json(one) - component_of_json(other)).abs() < 1e-12,
                        "{one} {other}"
                    );
                }
            }
        }
    }
}

const BALL: &str = "
#[mechanism(gravity = -9.81 * z)]
pub struct Ball {
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.1), ground.plane(z))]
    floor: Contact,
}
";

/// Checks that a ball falls, lands and rests on its floor, with the methods for contacts; that surfaces which
/// overlap at the beginning are separated; and that without its contacts it falls by `g t² / 2`.
#[test]
fn falling_bodies_land_and_rest_on_contacts() {
    let here = test_folder("contacts");
    std::fs::write(here.join("ball.rs"), BALL).unwrap();
    let drop = ["simulate", "ball.rs", "--set", "q.pose.z=0.5905", "--duration", "1", "--every", "0.1"];
    let time_stepping = ["time-stepping", "time-stepping-midpoint", "time-stepping-leapfrog"];
    for method in ["automatic", "event-driven"].into_iter().chain(time_stepping) {
        let (status, log, stderr) = run_linkwork(&here, &[&drop[..], &["--method", method]].concat());
        assert_eq!((status, stderr.as_str()), (0, ""), "{method}");
        let rows = rows_of_log(&log);
        assert_eq!(rows.len(), 11);
        // It lands after 0.3162 s, without restitution.
        for row in &rows {
            let height = (0.5905 - 9.81 / 2.0 * row[0] * row[0]).max(0.1);
            assert!((row[3] - height).abs() < 2e-3, "{method}: {row:?}");
        }
        assert!((rows[10][3] - 0.1).abs() < 1e-6 && rows[10][10].abs() < 1e-9, "{method}: {:?}", rows[10]);
    }
    let (status, log, stderr) = run_linkwork(&here, &["simulate", "ball.rs", "--duration", "0.1"]);
    assert!(status == 0 && stderr.contains("surfaces overlap at the beginning"), "{stderr}");
    assert!((rows_of_log(&log)[0][3] - 0.1).abs() < 1e-9);
    let (status, _, stderr) =
        run_linkwork(&here, &["view", "ball.rs", "--set", "q.pose.z=1", "--duration", "1"]);
    assert_eq!((status, stderr.as_str()), (0, ""));
    assert!(std::fs::read_to_string(here.join("Ball.html")).unwrap().contains("\"count\":61,"));
    let (status, _, stderr) = run_linkwork(&here, &[&drop[..], &["--method", "rk4"]].concat());
    assert!(status == 2 && stderr.contains("`Ball` has contacts"), "{stderr}");
    let (status, _, stderr) = run_linkwork(&here, &[&drop[..], &["--method", "rk5"]].concat());
    assert!(status == 2 && stderr.contains("possible values"), "{stderr}");
    let (_, log, _) = run_linkwork(&here, &["simulate", "ball.rs", "--without-contacts", "--duration", "2"]);
    for row in rows_of_log(&log) {
        assert!((row[3] + 9.81 / 2.0 * row[0] * row[0]).abs() < 1e-7, "{row:?}");
    }
}

/// Checks the methods of smooth motions on a pendulum of small amplitude, whose period is known, and steps.
#[test]
fn simulate_accepts_each_method_and_step() {
    let here = test_folder("methods");
    let pendulum = "
#[mechanism(gravity = -9.81 * y)]
pub struct Pendulum {
    #[body(mass = 2, com = -y)]
    bob: Body,
    #[joint(ground -> bob, about = z)]
    hinge: Pin,
}
";
    std::fs::write(here.join("pendulum.rs"), pendulum).unwrap();
    let swing = ["simulate", "pendulum.rs", "--set", "q.hinge=1e-4", "--duration", "2", "--every", "0.5"];
    let frequency = 9.81_f64.sqrt();
    for (method, tolerance) in [
        ("dormand-prince", 1e-6),
        ("dormand-prince8", 1e-6),
        ("rodas", 1e-5),
        ("rk4", 1e-6),
        ("implicit-midpoint", 1e-4),
        ("rosenbrock", 1e-4),
        ("semi-implicit-euler", 1e-2),
    ] {
        let (status, log, stderr) = run_linkwork(&here, &[&swing[..], &["--method", method]].concat());
        assert_eq!((status, stderr.as_str()), (0, ""), "{method}");
        for row in rows_of_log(&log) {
            let exact = 1e-4 * (frequency * row[0]).cos();
            let tolerance: f64 = tolerance;
            assert!((row[1] - exact).abs() < 1e-4 * tolerance + 2e-8, "{method}: {row:?}");
        }
    }
    let (status, coarse, _) =
        run_linkwork(&here, &[&swing[..], &["--method", "rk4", "--step", "0.25"]].concat());
    let end = rows_of_log(&coarse).pop().unwrap();
    let off = (end[1] - 1e-4 * (2.0 * frequency).cos()).abs();
    assert!(status == 0 && off > 1e-8 && off < 1e-5, "{off}");
    let wrong = [&swing[..], &["--method", "rodas", "--step", "0.1"]].concat();
    let (status, _, stderr) = run_linkwork(&here, &wrong);
    assert!(status == 2 && stderr.contains("the method rodas chooses its steps"), "{stderr}");
}

const CLOSED: &str = "
#[mechanism(gravity = -9.81 * y, derivatives)]
pub struct Closed {
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    crank: Body,
    #[body(mass = 2, com = x, inertia = rod(2, 2, x))]
    coupler: Body,
    #[body(mass = 2.5, com = 1.25 * x, inertia = rod(2.5, 2.5, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    input: Pin,
    #[joint(crank.at(x) -> coupler, about = z)]
    elbow: Pin,
    #[joint(ground.at(3 * x) -> rocker, about = z)]
    output: Pin,
    #[joint(coupler.at(2 * x) -> rocker.at(2.5 * x), about = z)]
    closing: Pin,
    #[acts(on = input)]
    motor: Torque,
}
";

/// Checks that a closed four-bar linkage moves as in Rust, remains closed, and conserves its energy without a
/// motor.
#[test]
fn closed_loops_remain_closed_in_simulations() {
    let here = test_folder("closed");
    std::fs::write(here.join("closed.rs"), CLOSED).unwrap();
    let begin =
        ["--set", "q.input=1.4017", "--set", "v.input=2", "--set", "q.output=2.0835", "--set", "u.motor=0"];
    let arguments = [
        &["simulate", "closed.rs", "--duration", "2", "--every", "0.25", "--tolerance", "1e-11"][..],
        &begin,
    ]
    .concat();
    let (status, log, stderr) = run_linkwork(&here, &arguments);
    // The given angles close the loop only up to their digits, which is reported.
    assert!(status == 0 && stderr.contains("the given values do not satisfy the constraints"), "{stderr}");
    assert!(stderr.contains("the motion begins near them, at q."), "{stderr}");
    let m = linkwork_models::FourBar { g: 9.81, density: 1.0, a: 1.0, b: 2.0, c: 2.5, d: 3.0 };
    let rows = rows_of_log(&log);
    assert_eq!(rows.len(), 9);
    let state_of_row = |row: &[f64]| -> (SVector<f64, 3>, SVector<f64, 3>) {
        (SVector::from_column_slice(&row[1..4]), SVector::from_column_slice(&row[4..7]))
    };
    let (q, v) = state_of_row(&rows[0]);
    let motion = simulate(&m).from(q, v).method(Rk4::step(5e-4)).duration(2.0).sample_every(0.25);
    let samples: Vec<_> = motion.collect::<Result<_, _>>().unwrap();
    let total_energy =
        |q: &SVector<f64, 3>, v: &SVector<f64, 3>| m.kinetic_energy(q, v) + m.potential_energy(q);
    for (row, sample) in rows.iter().zip(&samples) {
        let (at, rate) = state_of_row(row);
        assert!(m.constraint_residuals(&at).norm() < 1e-11, "{row:?}");
        assert!(m.constraint_rates(&at, &rate).norm() < 1e-11, "{row:?}");
        assert!((total_energy(&at, &rate) - total_energy(&q, &v)).abs() < 1e-7, "{row:?}");
        assert!(
            (at - sample.q).norm() + (rate - sample.v).norm() < 1e-6,
            "{row:?} {:?} {:?}",
            sample.q,
            sample.v
        );
    }
    // One angle and one velocity are preserved, and the constraints determine the others.
    let one = ["simulate", "closed.rs", "--duration", "0.1", "--set", "q.input=0.3", "--set", "v.output=2"];
    let (status, log, stderr) = run_linkwork(&here, &one);
    assert!(
        status == 0
            && stderr.contains(
                "the given values are kept, and the constraints determine the others at q.elbow = "
            ),
        "{stderr}"
    );
    assert!(
        stderr.contains("v.input = ") && !stderr.contains("q.input") && !stderr.contains("v.output"),
        "{stderr}"
    );
    let (at, rate) = state_of_row(&self::rows_of_log(&log)[0]);
    assert_eq!((at[0], rate[2]), (0.3, 2.0));
    assert!(m.constraint_residuals(&at).norm() < 1e-11 && m.constraint_rates(&at, &rate).norm() < 1e-11);
    // The same angle in the other assembly mode.
    let guessed = [&one[..], &["--guess", "q.output=2"]].concat();
    let (status, log, stderr) = run_linkwork(&here, &guessed);
    assert!(status == 0 && stderr.contains("the given values are kept"), "{stderr}");
    let (other, _) = state_of_row(&self::rows_of_log(&log)[0]);
    assert!(other[0] == 0.3 && other[2] > 1.0 && at[2] < 0.0, "{other} {at}");
    assert!(m.constraint_residuals(&other).norm() < 1e-11);
    // Angles that contradict the constraints are rejected.
    let wrong = ["simulate", "closed.rs", "--set", "q.input=1.2", "--set", "q.output=1.9"];
    let (status, log, stderr) = run_linkwork(&here, &wrong);
    assert!(status == 2 && log.is_empty() && stderr.contains("or the nearest ones: q.input = "), "{stderr}");
    // The singular stretched configuration is replaced by a nearby one, which is reported; the page shows the
    // motion.
    let (status, _, stderr) = run_linkwork(&here, &["view", "closed.rs", "--duration", "1"]);
    assert!(status == 0 && stderr.contains("the motion begins near it, at q."), "{stderr}");
    assert!(std::fs::read_to_string(here.join("Closed.html")).unwrap().contains("\"count\":61"));
}

const SWING: &str = "
#[mechanism(gravity = -9.81 * y)]
pub struct Swing {
    pub rope: f64,
    pub child: f64,
    #[body(mass = 0.5, com = -rope / 2 * y, inertia = rod(0.5, rope, y))]
    left: Body,
    #[body(mass = 0.5, com = -rope / 2 * y, inertia = rod(0.5, rope, y))]
    right: Body,
    #[body(mass = 2, com = 0.4 * x, inertia = rod(2, 0.8, x))]
    seat: Body,
    #[body(mass = child, com = 0.4 * y, inertia = rod(child, 0.8, y))]
    kid: Body,
    #[joint(ground -> left, about = z)]
    left_hook: Pin,
    #[joint(ground.at(0.8 * x) -> right, about = z)]
    right_hook: Pin,
    #[joint(left.at(-rope * y) -> seat, about = z)]
    left_knot: Pin,
    #[joint(seat.at(0.8 * x) -> right.at(-rope * y), about = z)]
    right_knot: Pin,
    #[joint(seat.at(0.4 * x) -> kid, about = z)]
    hips: Pin,
}
";

/// Checks that a joint which no constraint affects keeps its initial angle, and that the loop remains in the
/// assembly mode of the zero configuration, a parallelogram, for any amplitude. Inadmissible parameters are
/// rejected.
#[test]
fn unconstrained_joints_keep_their_initial_values() {
    let here = test_folder("swing");
    std::fs::write(here.join("swing.rs"), SWING).unwrap();
    let short = ["simulate", "swing.rs", "--duration", "0.1", "--set", "rope=2"];
    for angle in ["0.6", "-1.5", "2.5"] {
        let given = format!("q.left_hook={angle}");
        let (status, log, stderr) =
            run_linkwork(&here, &[&short[..], &["--set", "child=25", "--set", &given]].concat());
        assert!(status == 0 && stderr.contains("the given values are kept"), "{stderr}");
        let begin = &rows_of_log(&log)[0];
        let angle: f64 = angle.parse().unwrap();
        let off = begin[1..5].iter().zip([angle, angle, -angle, 0.0]).map(|(is, wanted)| (is - wanted).abs());
        assert!(off.fold(0.0, f64::max) < 1e-11, "{begin:?}");
    }
    for (figures, why) in [
        (
            ["child=25", "rope=-2"],
            "the length of a `rod` cannot be negative, but it is -2 (by the parameter `rope`)",
        ),
        (["child=0", "rope=2"], "the mass matrix of `Swing` is singular at the beginning"),
        (["child=25", "rope=2 m"], "`--set`: expected a number for `rope`, found `2 m`"),
        (["child=25", "rop=2"], "did you mean `rope`?"),
    ] {
        let arguments = ["simulate", "swing.rs", "--set", figures[0], "--set", figures[1]];
        let (status, log, stderr) = run_linkwork(&here, &arguments);
        assert!(status == 2 && log.is_empty() && stderr.contains(why), "{stderr}");
    }
}

/// Checks the errors for a mechanism that cannot be assembled, and for missing values of tables.
#[test]
fn failed_assemblies_are_reported() {
    let here = test_folder("apart");
    let apart = CLOSED
        .replace("ground.at(3 * x)", "ground.at(base * x)")
        .replace("Closed {", "Closed {\n    pub base: f64,");
    std::fs::write(here.join("apart.rs"), apart).unwrap();
    let (status, out, stderr) = run_linkwork(&here, &["simulate", "apart.rs", "--set", "base=30"]);
    assert!(status == 2 && out.is_empty() && stderr.contains("`Closed` cannot be assembled"), "{stderr}");
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mechanisms/mod.rs");
    let (status, out, stderr) =
        run_linkwork(&here, &["simulate", file, "--struct", "Wing", "--set", "mass=1"]);
    assert!(
        status == 2 && out.is_empty() && stderr.contains("--table lift=FILE --table drag=FILE"),
        "{stderr}"
    );
}

/// Checks that a spline table with three points of a parabola is the parabola: the resulting spring
/// oscillates with the expected frequency.
#[test]
fn spline_tables_are_read_from_files() {
    let here = test_folder("tables");
    let spring = "
#[mechanism]
pub struct Slider {
    pub potential: Table<1>,
    #[particle(mass = 2)]
    block: Particle,
    #[joint(ground -> block, along = x)]
    rail: Sleeve,
    #[energy(potential(rail))]
    spring: Potential,
}
";
    std::fs::write(here.join("slider.rs"), spring).unwrap();
    std::fs::write(here.join("spring.csv"), "x,energy\n2,16\n0,0\n-2,16\n").unwrap();
    let arguments = [
        "simulate",
        "slider.rs",
        "--set",
        "q.rail=1",
        "--duration",
        "3",
        "--every",
        "0.5",
        "--tolerance",
        "1e-11",
    ];
    let table = ["--table", "potential=spring.csv,smooth"];
    let (status, log, stderr) = run_linkwork(&here, &[&arguments[..], &table].concat());
    assert_eq!((status, stderr.as_str()), (0, ""));
    // Potential 4 x², mass 2 kg: 2 rad/s.
    for row in rows_of_log(&log) {
        assert!((row[1] - (2.0 * row[0]).cos()).abs() < 1e-8, "{row:?}");
    }
    for (table, part) in [
        (None, "tables without values: --table potential=FILE"),
        (Some("potentail=spring.csv"), "there is no table `potentail`, but potential"),
        (Some("potential=none.csv"), "cannot read none.csv"),
        (Some("potential=slider.rs"), "slider.rs: line 3: expected numbers"),
    ] {
        let table: Vec<&str> = table.iter().flat_map(|table| ["--table", table]).collect();
        let (status, out, stderr) = run_linkwork(&here, &[&arguments[..], &table].concat());
        assert!(status == 2 && out.is_empty() && stderr.contains(part), "{stderr}");
    }
}

#[test]
fn unsupported_simulations_are_reported() {
    let here = test_folder("refused");
    std::fs::write(here.join("bad.csv"), "t,u.thrsut\n0,1\n").unwrap();
    std::fs::write(here.join("plain.csv"), "t,thrust\n0,1\n").unwrap();
    for (arguments, part) in [
        (vec![], "parameters without a value: --set handle=…"),
        (vec!["--set", "handle"], "expected NAME=VALUE"),
        (
            vec!["--set", "handle=0.5", "--set", "q.flight=1"],
            "there is no `q.flight`, but handle, q.flight.x",
        ),
        (vec!["--set", "handle=0.5", "--every", "0"], "`--every`: expected a number above zero"),
        (vec!["--set", "handle=0.5", "--inputs", "none.csv"], "cannot read none.csv"),
        (vec!["--set", "handle=0.5", "--inputs", "bad.csv"], "there is no input `u.thrsut`, but u.thrust"),
        (vec!["--set", "handle=0.5", "--inputs", "plain.csv"], "no column of an input: expected u.thrust"),
        (vec!["--set", "handle=0.5", "--set", "q.chain.qw=0"], "is zero"),
    ] {
        let (status, out, stderr) =
            run_linkwork(&here, &[vec!["simulate", FLAIL], arguments.clone()].concat());
        assert!(status == 2 && out.is_empty() && stderr.contains(part), "{arguments:?}: {stderr}");
    }
}

/// Crank that rotates at constant speed, with a rod and a piston: no degrees of freedom.
const DRIVEN: &str = "
#[mechanism(gravity = -9.81 * y)]
pub struct Driven {
    pub speed: f64,
    #[frame(ground, z(speed * t))]
    turned: Frame,
    #[body(mass = 1, com = 0.02 * x, inertia = rod(1, 0.04, x), frame = turned)]
    crank: Body,
    #[body(mass = 1, com = 0.06 * x, inertia = rod(1, 0.13, x))]
    rod: Body,
    #[body(mass = 0.5)]
    piston: Body,
    #[joint(crank.at(0.04 * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(0.13 * x) -> piston, about = z)]
    small_end: Pin,
    #[output(crank)]
    loads: FreeBody,
}
";

/// Checks that every command accepts a mechanism without degrees of freedom, which follows its prescribed
/// motion.
#[test]
fn commands_accept_driven_mechanisms_without_freedom() {
    let here = test_folder("driven");
    std::fs::write(here.join("driven.rs"), DRIVEN).unwrap();
    let simulate = ["simulate", "driven.rs", "--set", "speed=7", "--duration", "1", "--every", "0.125"];
    let (status, log, _) = run_linkwork(&here, &simulate);
    assert_eq!(status, 0);
    let rows = rows_of_log(&log);
    assert_eq!(rows.len(), 9);
    for row in rows {
        let (sine, cosine) = (7.0 * row[0]).sin_cos();
        let piston = 0.04 * cosine + (0.13_f64.powi(2) - (0.04 * sine).powi(2)).sqrt();
        assert!((row[2] - piston).abs() < 1e-8, "{row:?}");
    }
    for command in [&["check", "driven.rs"][..], &["show", "driven.rs"], &["export", "c", "driven.rs"]] {
        assert_eq!(run_linkwork(&here, command).0, 0, "{command:?}");
    }
    assert_eq!(run_linkwork(&here, &["view", "driven.rs", "--set", "speed=7", "--duration", "1"]).0, 0);
    // A locked piston contradicts the prescribed rotation of the crank.
    let twice = DRIVEN
        .replace("#[output(crank)]\n    loads: FreeBody", "#[constraint(cylinder = 0.13)] stop: Holonomic");
    std::fs::write(here.join("twice.rs"), twice).unwrap();
    let simulate = ["simulate", "twice.rs", "--set", "speed=7", "--duration", "1"];
    let (status, _, stderr) = run_linkwork(&here, &simulate);
    assert!(status != 0 && stderr.contains("cannot be assembled"), "{stderr}");
}

/// With declared speeds a driven mechanism follows its drive. Configurations in which the speeds do not
/// determine the rates are reported at the beginning and during the motion.
#[test]
fn driven_mechanisms_may_have_singular_declared_speeds() {
    let here = test_folder("driven_speeds");
    let simulate_driven_with_speeds = |speeds: &str| {
        let with = DRIVEN.replace("#[output(crank)]\n    loads: FreeBody,", speeds);
        std::fs::write(here.join("driven.rs"), with).unwrap();
        run_linkwork(
            &here,
            &["simulate", "driven.rs", "--set", "speed=7", "--duration", "1", "--every", "0.125"],
        )
    };
    let (status, log, stderr) = simulate_driven_with_speeds(
        "#[speed(3 * rate(big_end))] a: Speed, #[speed(rate(cylinder) + 0.1 * rate(big_end))] b: Speed,",
    );
    assert_eq!(status, 0, "{stderr}");
    for row in rows_of_log(&log) {
        let (sine, cosine) = (7.0 * row[0]).sin_cos();
        let piston = 0.04 * cosine + (0.13_f64.powi(2) - (0.04 * sine).powi(2)).sqrt();
        assert!((row[2] - piston).abs() < 1e-8, "{row:?}");
    }
    // The crank begins at zero, where the rod is in line with it.
    let (status, _, stderr) = simulate_driven_with_speeds(
        "#[speed(sin(big_end) * rate(cylinder))] a: Speed, #[speed(rate(big_end))] b: Speed,",
    );
    assert!(
        status == 2 && stderr.contains("the speeds of `Driven` are singular at the beginning"),
        "{stderr}"
    );
    // Their determinant is proportional to 1 + cos(big_end): zero after half a turn.
    let (status, _, stderr) = simulate_driven_with_speeds(
        "#[speed(cos(big_end) * rate(cylinder) - 0.1 * rate(big_end))] a: Speed,
         #[speed(2 * rate(cylinder) + 0.2 * rate(big_end))] b: Speed,",
    );
    let there =
        stderr.split_once("beyond 0.448").is_some_and(|(_, why)| why.contains("speeds are singular there"));
    assert!(status == 2 && there, "{stderr}");
}

/// Declaration of a leg of Jansen's linkage.
const LEG: &str = "
#[mechanism(gravity = -9.81 * y)]
struct Leg {
    #[body(mass = 0.1, com = 0.075 * x, inertia = rod(0.1, 0.15, x))]
    crank: Body,
    #[body(mass = 0.9, com = 0.2 * x + 0.13 * y, inertia = diagonal(0.02, 0.02, 0.03))]
    upper: Body,
    #[body(mass = 0.4, com = 0.1965 * x, inertia = rod(0.4, 0.393, x))]
    lower: Body,
    #[body(mass = 1.1, com = 0.2 * x + 0.2 * y, inertia = diagonal(0.03, 0.03, 0.05))]
    foot: Body,
    #[body(mass = 0.5, com = 0.25 * x, inertia = rod(0.5, 0.5, x))]
    to_upper: Body,
    #[body(mass = 0.6, com = 0.3095 * x, inertia = rod(0.6, 0.619, x))]
    to_lower: Body,
    #[body(mass = 0.4, com = 0.197 * x, inertia = rod(0.4, 0.394, x))]
    coupling: Body,
    #[joint(ground -> crank, about = z)]
    shaft: Pin,
    #[joint(ground.at(-0.38 * x - 0.078 * y) -> upper, about = z)]
    upper_pivot: Pin,
    #[joint(ground.at(-0.38 * x - 0.078 * y) -> lower, about = z)]
    lower_pivot: Pin,
    #[joint(lower.at(0.393 * x) -> foot, about = z)]
    ankle: Pin,
    #[joint(crank.at(0.15 * x) -> to_upper, about = z)]
    upper_pin: Pin,
    #[joint(crank.at(0.15 * x) -> to_lower, about = z)]
    lower_pin: Pin,
    #[joint(upper.at(0.0260987951807229 * x + 0.400149788067062 * y) -> coupling, about = z)]
    knee: Pin,
    #[joint(to_upper.at(0.5 * x) -> upper.at(0.415 * x), about = z)]
    first: Pin,
    #[joint(to_lower.at(0.619 * x) -> lower.at(0.393 * x), about = z)]
    second: Pin,
    #[joint(coupling.at(0.394 * x) -> foot.at(0.367 * x), about = z)]
    third: Pin,
}
";

/// Checks that for any subset of given angles the remaining angles are found within half a revolution, and
/// that the assembly mode is printed.
#[test]
fn leg_assembly_stays_within_half_a_revolution() {
    let here = test_folder("leg");
    std::fs::write(here.join("leg.rs"), LEG).unwrap();
    for (given, wanted) in [
        ("q.knee=2.787", [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.787]),
        ("q.knee=-3.037", [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -3.037]),
        ("q.ankle=-2.418", [0.0, 0.0, 0.0, -2.418, 0.0, 0.0, 0.0]),
        ("q.lower_pin=-1.285", [0.0, 0.0, 0.0, 0.0, 0.0, -1.285, 0.0]),
        ("q.shaft=-0.308", [-0.308, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ] {
        let simulate = ["simulate", "leg.rs", "--set", given, "--duration", "0.01", "--every", "0.01"];
        let (status, log, stderr) = run_linkwork(&here, &simulate);
        assert!(status == 0 && stderr.contains("this is assembly mode "), "{given}: {stderr}");
        let first = &rows_of_log(&log)[0];
        for (angle, wanted) in first[1..8].iter().zip(wanted) {
            assert!((angle - wanted).abs() < std::f64::consts::PI + 1e-9, "{given}: {first:?}");
        }
    }
}
