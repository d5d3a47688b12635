//! Random mechanisms whose motion is known from another mechanism or in closed form, with declared
//! generalized speeds, states of first order, inputs over time and stiff springs.
//!
//! `LINKWORK_CASES` sets the number of mechanisms of each kind, and `LINKWORK_COMMAND` the path of another
//! build of the command.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Generator of pseudorandom numbers (Knuth's linear congruential generator).
struct Random(u64);

impl Random {
    fn random_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn random_index_below(&mut self, n: u64) -> u64 {
        self.random_bits() % n
    }

    /// Returns a random number between bounds, rounded to three decimals.
    fn random_number_between(&mut self, low: f64, high: f64) -> f64 {
        let x = low + (high - low) * self.random_index_below(10_000) as f64 / 1e4;
        (x * 1e3).round() / 1e3
    }
}

fn case_count() -> u64 {
    std::env::var("LINKWORK_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(6)
}

fn test_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Motion as printed by the command: names of the columns, and rows.
struct MotionLog {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl MotionLog {
    fn last_logged_value(&self, name: &str) -> f64 {
        let column = self.names.iter().position(|known| known == name);
        self.rows[self.rows.len() - 1][column.unwrap_or_else(|| panic!("no `{name}` in {:?}", self.names))]
    }
}

fn simulate_to_log(here: &Path, name: &str, text: &str, set: &[String], more: &[&str]) -> MotionLog {
    let file = format!("{name}.rs");
    std::fs::write(here.join(&file), text).unwrap();
    let command = std::env::var_os("LINKWORK_COMMAND").unwrap_or(env!("CARGO_BIN_EXE_linkwork").into());
    let mut command = Command::new(command);
    command.current_dir(here).args(["simulate", &file, "--tolerance", "1e-10", "--every", "0.25"]).args(more);
    set.iter().for_each(|set| _ = command.arg("--set").arg(set));
    let output = command.output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{text}\n{set:?}\n{stderr}");
    let log = String::from_utf8(output.stdout).unwrap();
    let mut lines = log.lines();
    let names = lines.next().unwrap().split(',').map(ToString::to_string).collect();
    MotionLog {
        names,
        rows: lines.map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect(),
    }
}

/// Returns a chain of bodies on pins and sleeves with springs, or a slider-crank, with its coordinates.
fn random_linkage(random: &mut Random) -> (String, Vec<String>, bool) {
    let mut text = String::new();
    if random.random_index_below(4) == 0 {
        let (r, l) = (random.random_number_between(0.2, 0.5), random.random_number_between(0.9, 1.5));
        let _ = write!(
            text,
            "    #[body(mass = 1.2, com = {r} / 2 * x, inertia = rod(1.2, {r}, x))]\n    crank: Body,
    #[body(mass = 0.7, com = {l} / 2 * x, inertia = rod(0.7, {l}, x))]\n    arm: Body,
    #[body(mass = 2.1)]\n    piston: Body,
    #[joint(ground -> crank, about = z)]\n    j0: Pin,
    #[joint(crank.at({r} * x) -> arm, about = z)]\n    j1: Pin,
    #[joint(ground.at(({r} + {l}) * x) -> piston, along = x)]\n    j2: Sleeve,
    #[joint(arm.at({l} * x) -> piston, about = z)]\n    closing: Pin,\n"
        );
        return (text, (0..3).map(|k| format!("j{k}")).collect(), true);
    }
    let n = 1 + random.random_index_below(3);
    for k in 0..n {
        let (mass, length) = (random.random_number_between(0.5, 3.0), random.random_number_between(0.3, 1.2));
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at(-0.4 * y)", k - 1) };
        let (how, kind) = [("about = z", "Pin"), ("about = x", "Pin"), ("along = x", "Sleeve")]
            [random.random_index_below(3) as usize];
        let _ = write!(
            text,
            "    #[body(mass = {mass}, com = -{length} / 2 * y + 0.1 * z, inertia = cuboid({mass}, 0.2, {length}, 0.3))]\n    b{k}: Body,
    #[joint({parent} -> b{k}, {how})]\n    j{k}: {kind},
    #[acts(on = j{k}, stiffness = {})]\n    s{k}: Spring,\n    #[acts(on = j{k}, damping = {})]\n    d{k}: Dashpot,\n",
            random.random_number_between(5.0, 40.0),
            random.random_number_between(0.0, 1.0)
        );
    }
    (text, (0..n).map(|k| format!("j{k}")).collect(), false)
}

fn mechanism_source(body: &str) -> String {
    format!("use linkwork::prelude::*;\n#[mechanism(gravity = -9.81 * y)]\npub struct Random {{\n{body}}}\n")
}

/// Checks that declared generalized speeds do not change the motion of a mechanism.
#[test]
fn declared_speeds_leave_random_motions_unchanged() {
    let here = test_folder("random_speeds");
    for case in 0..case_count() {
        let random = &mut Random(2 * case + 1);
        let (body, joints, loops) = random_linkage(random);
        let mut with = body.clone();
        let (mut begin, mut of_speeds, mut of_rates) = (Vec::new(), Vec::new(), Vec::new());
        // A loop starts in its assembled configuration; one velocity is free.
        let q: Vec<f64> = joints
            .iter()
            .map(|_| if loops { 0.0 } else { random.random_number_between(-0.5, 0.5) })
            .collect();
        let v: Vec<f64> = joints.iter().map(|_| random.random_number_between(-1.0, 1.0)).collect();
        for (k, joint) in joints.iter().enumerate() {
            let (own, other) =
                (random.random_number_between(0.5, 3.0), random.random_number_between(-1.0, 1.0));
            let (mut value, mut speed) = (format!("{own} * rate({joint})"), own * v[k]);
            // Triangular, hence invertible everywhere.
            if k > 0 && random.random_index_below(2) == 0 {
                let before = &joints[k - 1];
                let _ = write!(value, " + {other} * cos({joint}) * rate({before})");
                speed += other * q[k].cos() * v[k - 1];
            }
            let _ = write!(with, "    #[speed({value})]\n    w{k}: Speed,\n");
            begin.push(format!("q.{joint}={}", q[k]));
            if !loops || k == 0 {
                of_speeds.push(format!("v.w{k}={speed}"));
                of_rates.push(format!("v.{joint}={}", v[k]));
            }
        }
        if loops {
            begin.clear();
        }
        let more = ["--duration", "1"];
        let [a, b] = [(with, of_speeds), (body, of_rates)].map(|(body, set)| {
            simulate_to_log(&here, "speeds", &mechanism_source(&body), &[begin.clone(), set].concat(), &more)
        });
        for joint in &joints {
            let name = format!("q.{joint}");
            let (a, b) = (a.last_logged_value(&name), b.last_logged_value(&name));
            assert!((a - b).abs() < 1e-6 * (1.0 + b.abs()), "case {case}: {name} is {a}, not {b}");
        }
    }
}

/// Checks that a state of first order equals the velocity of a particle of 1 kg on a separate rail, under a
/// force equal to the rate of the state.
#[test]
fn first_order_states_integrate_like_velocities() {
    let here = test_folder("random_states");
    for case in 0..case_count() {
        let random = &mut Random(2 * case + 2);
        let (linkage, joints, loops) = random_linkage(random);
        let j = &joints[0];
        // Parameters have inferred units.
        let parameters = ["lag", "lift", "drag", "wave", "scale", "gain"];
        let values = [
            random.random_number_between(0.5, 20.0),
            random.random_number_between(-0.5, 0.5),
            random.random_number_between(0.0, 0.5),
            random.random_number_between(-0.5, 0.5),
            random.random_number_between(0.2, 2.0),
            random.random_number_between(-8.0, 8.0),
        ];
        let state_rate_source = |x: &str| {
            format!(
                "lag * (drive - {x}) + lift * sin(scale * {j}) - drag * rate({j}) + wave * {x} * cos(3 * t)"
            )
        };
        let declared: String = parameters.iter().map(|name| format!("    pub {name}: f64,\n")).collect();
        let force_declaration = |x: &str| {
            format!(
                "{declared}    pub share: f64,\n    drive: Input,\n    #[acts(on = {j}, value = gain * \
                 tanh(share * {x}))]\n    f: Force,\n"
            )
        };
        let is_pin = linkage.contains("j0: Pin");
        let actuator_declaration = |x: &str| {
            if is_pin { force_declaration(x).replace("f: Force", "f: Torque") } else { force_declaration(x) }
        };
        let of_state = format!(
            "{}    #[state(rate = {})]\n    level: State,\n{linkage}",
            actuator_declaration("level"),
            state_rate_source("level")
        );
        let of_rail = format!(
            "{}{linkage}    #[particle(mass = 1)]\n    dot: Particle,\n    #[joint(ground -> dot, along = x)]\n    rail: Sleeve,
    #[acts(on = rail, value = {})]\n    push: Force,\n",
            actuator_declaration("rate(rail)"),
            state_rate_source("rate(rail)")
        );
        let (level, drive) =
            (random.random_number_between(-1.0, 1.0), random.random_number_between(-2.0, 2.0));
        let begin =
            if loops { vec![] } else { vec![format!("q.{j}={}", random.random_number_between(-0.5, 0.5))] };
        let options_with_values = |name: &str| {
            let values = parameters.iter().zip(values).map(|(name, value)| format!("{name}={value}"));
            let own = ["share=0.7".to_string(), format!("{name}={level}"), format!("u.drive={drive}")];
            [begin.clone(), values.collect(), own.to_vec()].concat()
        };
        let more = ["--duration", "1"];
        let a = simulate_to_log(
            &here,
            "states",
            &mechanism_source(&of_state),
            &options_with_values("x.level"),
            &more,
        );
        let b = simulate_to_log(
            &here,
            "states",
            &mechanism_source(&of_rail),
            &options_with_values("v.rail"),
            &more,
        );
        let names = joints.iter().map(|joint| (format!("q.{joint}"), format!("q.{joint}")));
        for (name, other) in names.chain([("x.level".to_string(), "v.rail".to_string())]) {
            let (a, b) = (a.last_logged_value(&name), b.last_logged_value(&other));
            assert!((a - b).abs() < 1e-6 * (1.0 + b.abs()), "case {case}: {name} is {a}, not {b}");
        }
    }
}

/// Checks a cart of 1 kg under a piecewise linear force between random instants, with jumps and short pulses:
/// velocity and position are integrals of the table.
#[test]
fn piecewise_linear_inputs_are_applied_exactly() {
    let here = test_folder("random_inputs");
    let cart = mechanism_source(
        "    #[body(mass = 1)]\n    cart: Body,\n    \
         #[joint(ground -> cart, along = x)]\n    rail: Sleeve,\n    #[acts(on = rail)]\n    push: Force,\n",
    );
    for case in 0..case_count() {
        let random = &mut Random(3 * case + 5);
        let mut rows = vec![(0.0, random.random_number_between(-5.0, 5.0))];
        while rows.len() < 12 {
            let last = rows[rows.len() - 1].0;
            let t = match random.random_index_below(4) {
                0 => last,
                1 => last + 0.001,
                _ => last + random.random_number_between(0.05, 0.6),
            };
            rows.push((t, random.random_number_between(-50.0, 50.0)));
        }
        let table: String = rows.iter().map(|(t, u)| format!("{t},{u}\r\n")).collect();
        std::fs::write(here.join("push.csv"), format!("\u{feff}t,u.push\r\n{table}")).unwrap();
        let end = rows[rows.len() - 1].0 + 0.5;
        rows.push((end, rows[rows.len() - 1].1));
        let (mut x, mut v) = (0.0, 0.0);
        for pair in rows.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            let h = to - from;
            x += v * h + (2.0 * a + b) * h * h / 6.0;
            v += (a + b) * h / 2.0;
        }
        let more = ["--inputs", "push.csv", "--duration", &end.to_string()];
        let log = simulate_to_log(&here, "inputs", &cart, &[], &more);
        let (is, goes) = (log.last_logged_value("q.rail"), log.last_logged_value("v.rail"));
        assert!((is - x).abs() < 1e-8 * (1.0 + x.abs()), "case {case}: {is}, not {x}");
        assert!((goes - v).abs() < 1e-8 * (1.0 + v.abs()), "case {case}: {goes}, not {v}");
    }
}

/// Checks a cart on a stiff, overdamped spring under a constant force, which starts at rest: the motion is
/// the closed form of an overdamped oscillator with large `c` and `k`.
#[test]
fn stiff_overdamped_springs_follow_the_closed_form() {
    let here = test_folder("random_stiff");
    for case in 0..case_count() {
        let random = &mut Random(5 * case + 7);
        let (mass, push) =
            (random.random_number_between(0.5, 2.0), random.random_number_between(-50.0, 50.0));
        let fast = 10_f64.powf(random.random_number_between(3.0, 6.0)).round();
        let slow = random.random_number_between(0.5, 20.0);
        // m x″ + m (fast + slow) x′ + m fast slow x = push.
        let (c, k) = (mass * (fast + slow), mass * fast * slow);
        let cart = mechanism_source(&format!(
            "    #[body(mass = {mass})]\n    cart: Body,\n    #[joint(ground -> cart, along = x)]\n    rail: Sleeve,
    #[acts(on = rail, stiffness = {k})]\n    spring: Spring,\n    #[acts(on = rail, damping = {c})]\n    damper: Dashpot,\n    #[acts(on = rail)]\n    push: Force,\n"
        ));
        let begin = random.random_number_between(-1.0, 1.0);
        let set = [format!("q.rail={begin}"), format!("u.push={push}")];
        let log = simulate_to_log(&here, "stiff", &cart, &set, &["--duration", "2"]);
        let rest = push / k;
        for row in &log.rows {
            let (t, x) = (row[0], row[1]);
            let decay = (fast * (-slow * t).exp() - slow * (-fast * t).exp()) / (fast - slow);
            let exact = rest + (begin - rest) * decay;
            assert!((x - exact).abs() < 1e-7, "case {case}, {t} s: {x}, not {exact}");
        }
    }
}
