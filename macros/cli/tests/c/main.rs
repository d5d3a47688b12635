//! What `linkwork export c` writes, compiled by the C compiler of the system, against the same functions in Rust.

mod casadi;
#[path = "../mechanisms/mod.rs"]
mod mechanisms;

use linkwork::prelude::*;
use linkwork::{Frames, discrete};
use linkwork_models::{AnymalB, CartPole, FourBar, FurutaPendulum, PandaArm, SimpleHumanoid, Solo12, Ur5};
use mechanisms::{Awkward, Balloon, Wing};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A function with its arguments as C and Rust write them, and its results one after another.
struct Entry {
    name: &'static str,
    arguments: &'static str,
    results: Vec<Vec<f64>>,
    returned: bool,
}

/// A mechanism as C knows it.
struct Case {
    /// What identifiers and files begin with.
    prefix: &'static str,
    parameters: Vec<f64>,
    /// Tables as C writes them, and the arrays that they name.
    tables: [&'static str; 2],
    time: Option<f64>,
    /// Arguments by name.
    given: Vec<(&'static str, Vec<f64>)>,
    entries: Vec<Entry>,
    /// How far results may be off, of the largest number of each.
    tolerance: f64,
}

fn numbers(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|k| (seed + 1.7 * k as f64).sin()).collect()
}

/// The functions of every mechanism.
macro_rules! functions {
    ($m:ident($($t:ident)?), $q:ident, $v:ident, $a:ident, $tau:ident) => {
        vec![
            entry!("neutral", "", $m.neutral()),
            entry!("mass_matrix", "q", $m.mass_matrix($($t,)? &$q)),
            entry!("bias_forces", "q, v", $m.bias_forces($($t,)? &$q, &$v)),
            entry!("inverse_dynamics", "q, v, a", $m.inverse_dynamics($($t,)? &$q, &$v, &$a)),
            scalar!("kinetic_energy", "q, v", $m.kinetic_energy($($t,)? &$q, &$v)),
            scalar!("potential_energy", "q", $m.potential_energy($($t,)? &$q)),
            entry!("generalized_momentum", "q, v", $m.generalized_momentum($($t,)? &$q, &$v)),
            entry!("momentum_rate", "q, v", $m.momentum_rate($($t,)? &$q, &$v)),
            scalar!("dissipated_power", "q, v", $m.dissipated_power($($t,)? &$q, &$v)),
            scalar!("total_mass", "", $m.total_mass()),
            entry!("center_of_mass", "q", $m.center_of_mass($($t,)? &$q)),
            entry!("momentum", "q, v", $m.momentum($($t,)? &$q, &$v)),
            entry!("integrate", "q, v", $m.integrate(&$q, &$v)),
            entry!("difference", "q, moved", $m.difference(&$q, &$m.integrate(&$q, &$a))),
            entry!("tangent_rate", "v, a", $m.tangent_rate(&$v, &$a)),
        ]
    };
}

/// Those of trees.
macro_rules! of_trees {
    ($m:ident($($t:ident)?), $q:ident, $v:ident, $a:ident, $tau:ident, $u:ident) => {{
        let (by_q, by_v) = $m.inverse_dynamics_derivatives($($t,)? &$q, &$v, &$a);
        let (a_by_q, a_by_v, by_tau) = $m.forward_dynamics_derivatives($($t,)? &$q, &$v, &$tau);
        let (by_state, by_input) = $m.linearize($($t,)? &$q, &$v, &$u);
        vec![
            entry!("forward_dynamics", "q, v, tau", $m.forward_dynamics($($t,)? &$q, &$v, &$tau)),
            entry!("generalized_forces", "q, u", $m.generalized_forces($($t,)? &$q, &$u)),
            scalar!("control_power", "q, v, u", $m.control_power($($t,)? &$q, &$v, &$u)),
            entry!("mass_matrix_inverse", "q", $m.mass_matrix_inverse($($t,)? &$q)),
            entry!("coriolis_matrix", "q, v", $m.coriolis_matrix($($t,)? &$q, &$v)),
            entry!("inverse_dynamics_derivatives", "q, v, a", by_q, by_v),
            entry!("forward_dynamics_derivatives", "q, v, tau", a_by_q, a_by_v, by_tau),
            entry!("linearize", "q, v, u", by_state, by_input),
        ]
    }};
}

macro_rules! entry {
    ($name:literal, $arguments:literal, $($value:expr),+) => {
        Entry {
            name: $name,
            arguments: $arguments,
            results: vec![$($value.as_slice().to_vec()),+],
            returned: false,
        }
    };
}

macro_rules! scalar {
    ($name:literal, $arguments:literal, $value:expr) => {
        Entry { name: $name, arguments: $arguments, results: vec![vec![$value]], returned: true }
    };
}

/// A case with a state, of the mechanism and its sizes.
macro_rules! case {
    ($prefix:literal, $kind:ident, $m:expr, [$($p:expr),*], time($($t:ident = $time:expr)?), $functions:ident) => {{
        let m = &$m;
        $(let $t: f64 = $time;)?
        let some = |n: usize, seed: f64| numbers(n, seed);
        let q = m.integrate(&m.neutral(), &vector::<{ $kind::NV }>(&some($kind::NV, 0.3)));
        let v = vector::<{ $kind::NV }>(&some($kind::NV, 1.1));
        let a = vector::<{ $kind::NV }>(&some($kind::NV, 2.2));
        let tau = vector::<{ $kind::NV }>(&some($kind::NV, 0.7)) * 10.0;
        let u = vector::<{ $kind::NU }>(&some($kind::NU, 0.9));
        let moved = m.integrate(&q, &a);
        let mut entries = functions!(m($($t)?), q, v, a, tau);
        entries.extend($functions!(m($($t)?), q, v, a, tau, u));
        let time: Option<f64> = [$($t)?].first().copied();
        entries.extend(frames(m, time, q, v, a));
        let _ = (&u, &tau);
        Case {
            prefix: $prefix,
            parameters: vec![$($p),*],
            tables: [""; 2],
            time,
            given: vec![
                ("q", q.as_slice().to_vec()),
                ("v", v.as_slice().to_vec()),
                ("a", a.as_slice().to_vec()),
                ("tau", tau.as_slice().to_vec()),
                ("u", u.as_slice().to_vec()),
                ("moved", moved.as_slice().to_vec()),
            ],
            entries,
            tolerance: 1e-11,
        }
    }};
}

/// How the end of a step changes with its length, by central differences of sixth order.
fn by_length<const NQ: usize, const NV: usize>(
    end: impl Fn(f64) -> (SVector<f64, NQ>, SVector<f64, NV>),
    difference: impl Fn(&SVector<f64, NQ>, &SVector<f64, NQ>) -> SVector<f64, NV>,
) -> Vec<f64> {
    let d = 1e-4;
    let (start, _) = end(0.0);
    let at = |x: f64| {
        let (q, v) = end(x);
        [difference(&start, &q).as_slice(), v.as_slice()].concat()
    };
    let sides: Vec<[Vec<f64>; 2]> = [1.0, 2.0, 3.0].iter().map(|k| [at(k * d), at(-k * d)]).collect();
    let slope = |i: usize| {
        let part = |k: usize, weight: f64| weight * (sides[k][0][i] - sides[k][1][i]);
        (part(0, 45.0) + part(1, -9.0) + part(2, 1.0)) / (60.0 * d)
    };
    (0..2 * NV).map(slope).collect()
}

/// Steps and their Jacobians.
macro_rules! steps {
    ($kind:ident, $m:expr, $case:ident) => {{
        const NX: usize = 2 * $kind::NV;
        let (m, state) = (&$m, &$case.given);
        let t = $case.time.unwrap_or(0.0);
        let (q, v, u) = (vector(&state[0].1), vector(&state[1].1), vector(&state[4].1));
        let mut entries = Vec::new();
        macro_rules! by {
            ($method:ident, $step:literal, $transition:literal) => {{
                let (next_q, next_v) =
                    discrete::step(m, &$method::step(0.01), t, &q, &v, &u).expect("a step");
                let found = discrete::transition(m, &$method::step(0.01), t, &q, &v, &u).expect("a step");
                let (a, b) = (found.a::<NX>(), found.b::<NX>());
                entries.push(entry!($step, "q, v, u, 0.01", next_q, next_v));
                let mut all = entry!($transition, "q, v, u, 0.01", next_q, next_v, a, b);
                if $case.time.is_none() {
                    let end =
                        |x: f64| discrete::step(m, &$method::step(0.01 + x), t, &q, &v, &u).expect("a step");
                    all.results.push(by_length(end, |a, b| m.difference(a, b)));
                }
                entries.push(all);
            }};
        }
        by!(SemiImplicitEuler, "semi_implicit_euler_step", "semi_implicit_euler_transition");
        by!(Rk4, "rk4_step", "rk4_transition");
        entries
    }};
}

macro_rules! nothing {
    ($($t:tt)*) => {
        Vec::new()
    };
}

fn vector<const N: usize>(numbers: &[f64]) -> linkwork::nalgebra::SVector<f64, N> {
    linkwork::nalgebra::SVector::from_fn(|k, _| numbers[k])
}

/// The first frame and the last one.
fn frames<M, const NQ: usize, const NV: usize>(
    m: &M,
    time: Option<f64>,
    q: linkwork::nalgebra::SVector<f64, NQ>,
    v: linkwork::nalgebra::SVector<f64, NV>,
    a: linkwork::nalgebra::SVector<f64, NV>,
) -> Vec<Entry>
where
    M: Frames<NQ, NV, Scalar = f64>,
{
    let (t, last) = (time.unwrap_or(0.0), M::FRAMES.len() - 1);
    let placement = |frame| {
        let x = m.placement_of(frame, t, &q).expect("there is such a frame");
        [x.rotation.matrix().as_slice(), x.translation.vector.as_slice()].concat()
    };
    let entry = |name, arguments, result| Entry { name, arguments, results: vec![result], returned: false };
    let some = "there is such a frame";
    vec![
        entry("frame_placement 0", "q", placement(0)),
        entry("frame_placement last", "q", placement(last)),
        entry("frame_velocity last", "q, v", m.velocity_of(last, t, &q, &v).expect(some).as_slice().to_vec()),
        entry(
            "frame_acceleration last",
            "q, v, a",
            m.acceleration_of(last, t, &q, &v, &a).expect(some).as_slice().to_vec(),
        ),
        entry("frame_jacobian last", "q", m.jacobian_of(last, t, &q).expect(some).as_slice().to_vec()),
    ]
}

/// A program that prints the results of all entries, a line each.
fn program(case: &Case, scalar: &str) -> String {
    let p = case.prefix;
    let list = |numbers: &[f64]| {
        let texts: Vec<String> = numbers.iter().map(|x| format!("({scalar}){x:?}")).collect();
        texts.join(", ")
    };
    let mut text = format!(
        "#include \"{p}.h\"\n#include <stdio.h>\n\nstatic void show(int n, const {scalar} *x) {{\n    for (int k = 0; k < n; ++k) {{\n        printf(\"%.17g \", (double)x[k]);\n    }}\n}}\n\nint main(void) {{\n"
    );
    let own = match case.parameters.is_empty() {
        true => "",
        false => {
            let [arrays, tables] = case.tables;
            let _ =
                writeln!(text, "{arrays}    static const {p} self = {{{}{tables}}};", list(&case.parameters));
            "&self, "
        }
    };
    for (name, numbers) in case.given.iter().filter(|(_, numbers)| !numbers.is_empty()) {
        let _ = writeln!(text, "    static const {scalar} {name}[] = {{{}}};", list(numbers));
    }
    for (name, _) in case.given.iter().filter(|(_, numbers)| numbers.is_empty()) {
        let _ = writeln!(text, "    static const {scalar} {name}[1] = {{0}};");
    }
    let most = case.entries.iter().flat_map(|e| &e.results).map(Vec::len).max().unwrap_or(1).max(1);
    for k in 0..6 {
        let _ = writeln!(text, "    static {scalar} r{k}[{most}];");
    }
    for name in ["r1", "r2", "r3", "r4", "r5", "tau", "u"] {
        let _ = writeln!(text, "    (void){name};");
    }
    for entry in &case.entries {
        let (name, frame) = match entry.name.split_once(' ') {
            Some((name, "0")) => (name, "0, ".to_string()),
            Some((name, _)) => (name, format!("{}_FRAMES - 1, ", p.to_uppercase())),
            None => (entry.name, String::new()),
        };
        let timeless = ["neutral", "total_mass", "integrate", "difference", "tangent_rate"];
        let is_timeless = timeless.contains(&name) || name == "standard_parameters";
        let time = case.time.filter(|_| !is_timeless).map_or(String::new(), |t| format!("({scalar}){t:?}, "));
        let comma = if entry.arguments.is_empty() { "" } else { ", " };
        let mut arguments = format!("{own}{frame}{time}{}{comma}", entry.arguments);
        if entry.returned {
            let arguments = arguments.trim_end_matches(", ");
            let _ = writeln!(text, "    r0[0] = {p}_{name}({arguments});\n    show(1, r0);");
        } else {
            let names: Vec<String> = (0..entry.results.len()).map(|k| format!("r{k}")).collect();
            arguments += &names.join(", ");
            let _ = writeln!(text, "    {p}_{name}({arguments});");
            for (k, result) in entry.results.iter().enumerate() {
                let _ = writeln!(text, "    show({}, r{k});", result.len());
            }
        }
        text.push_str("    printf(\"\\n\");\n");
    }
    text.push_str("    return 0;\n}\n");
    text
}

fn compilers() -> Vec<&'static str> {
    let works = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
    let known: Vec<&str> = ["gcc", "clang"].into_iter().filter(works).collect();
    if known.is_empty() { ["cc"].into_iter().filter(works).collect() } else { known }
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c").join(name);
    std::fs::create_dir_all(&folder).expect("a folder of the tests'");
    folder
}

/// Runs `linkwork export c`.
fn export(folder: &Path, arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_linkwork"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["export", "c", "--out"])
        .arg(folder)
        .args(arguments)
        .output()
        .expect("the command starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// What a compiled program prints, which is compiled without a warning.
fn printed(compiler: &str, folder: &Path, p: &str, main: &str, flags: &[&str]) -> Vec<Vec<f64>> {
    let (source, executable) = (folder.join("main.c"), folder.join(format!("main_{compiler}")));
    std::fs::write(&source, main).expect("a file of the tests'");
    let strict = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"];
    let compiled = Command::new(compiler)
        .current_dir(folder)
        .args(strict)
        .args(flags)
        .arg("-o")
        .arg(&executable)
        .args([format!("{p}.c"), "main.c".to_string()])
        .arg("-lm")
        .output()
        .expect("the compiler starts");
    assert!(compiled.status.success(), "{p}: {}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new(&executable).output().expect("the program starts");
    assert!(run.status.success(), "{p}: {}", run.status);
    let text = String::from_utf8_lossy(&run.stdout).into_owned();
    let line = |line: &str| line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    text.lines().map(line).collect()
}

fn compare(case: &Case, found: &[Vec<f64>], tolerance: f64) {
    assert_eq!(found.len(), case.entries.len(), "{}", case.prefix);
    for (entry, found) in case.entries.iter().zip(found) {
        let expected = entry.results.concat();
        assert_eq!(found.len(), expected.len(), "{}: {}", case.prefix, entry.name);
        let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            assert!(
                (found - expected).abs() <= tolerance * largest,
                "{}: {}[{k}] is {found} in C and {expected} in Rust",
                case.prefix,
                entry.name
            );
        }
    }
}

/// Exports, compiles and compares, once as plain as can be and once for this processor.
fn agrees(case: &Case, arguments: &[&str]) {
    let compilers = compilers();
    if compilers.is_empty() {
        println!("skipped: there is no C compiler");
        return;
    }
    let folder = folder(case.prefix);
    export(&folder, &[&["--prefix", case.prefix], arguments].concat());
    for compiler in compilers {
        for flags in [&["-O0"][..], &["-O1", "-march=native"]] {
            let found = printed(compiler, &folder, case.prefix, &program(case, "double"), flags);
            compare(case, &found, case.tolerance);
        }
    }
}

#[test]
fn arms() {
    let mut case = case!("arm", Ur5, Ur5, [], time(), of_trees);
    case.entries.extend(steps!(Ur5, Ur5, case));
    agrees(&case, &["../../models/urdf/ur5.urdf"]);
    let case = case!("panda_arm", PandaArm, PandaArm, [], time(), of_trees);
    agrees(&case, &["../../models/src/arm7.rs", "--struct", "PandaArm"]);
}

#[test]
fn quadrupeds() {
    let mut case = case!("solo12", Solo12, Solo12, [], time(), of_trees);
    case.entries.extend(steps!(Solo12, Solo12, case));
    agrees(&case, &["../../models/urdf/solo12.urdf", "--with", "base = free"]);
    let case = case!("anymal", AnymalB, AnymalB, [], time(), of_trees);
    agrees(&case, &["../../models/src/quadruped.rs", "--struct", "AnymalB"]);
}

#[test]
fn a_humanoid() {
    let case = case!("humanoid", SimpleHumanoid, SimpleHumanoid, [], time(), of_trees);
    agrees(&Case { tolerance: 1e-9, ..case }, &["../../models/src/humanoid.rs"]);
}

#[test]
fn declared_mechanisms() {
    let m = CartPole { cart_mass: 1.2, pole_mass: 0.3, pole_length: 0.8, rail_damping: 0.4 };
    let mut case = case!("cart_pole", CartPole, m, [1.2, 0.3, 0.8, 0.4], time(), of_trees);
    case.entries.extend(steps!(CartPole, m, case));
    agrees(&case, &["../../models/src/cart_pole.rs"]);
    let m = FurutaPendulum { g: 9.8, arm_mass: 0.7, arm_length: 0.5, mass: 0.3, length: 0.9 };
    let case = case!("furuta", FurutaPendulum, m, [9.8, 0.7, 0.5, 0.3, 0.9], time(), nothing);
    agrees(&case, &["../../models/src/furuta_pendulum.rs"]);
}

#[test]
fn names_that_c_does_not_have() {
    let m = Awkward { int: 1.2, class: 0.3, r#type: 0.8, NAN: 4.0 };
    let mut case = case!("awkward", Awkward, m, [1.2, 0.3, 0.8, 4.0], time(), of_trees);
    let given = |name: &str| {
        let (_, numbers) = case.given.iter().find(|(known, _)| *known == name).expect("an argument");
        numbers.clone()
    };
    let (q, v, a) = (vector(&given("q")), vector(&given("v")), vector(&given("a")));
    let (tau, u) = (vector(&given("tau")), vector(&given("u")));
    let (qq, qv, vv, qa) = m.inverse_dynamics_second_derivatives(&q, &v, &a, &tau);
    case.entries.extend([
        scalar!("short", "q", m.short(&q)),
        entry!("load", "q, v, u", m.load(&q, &v, &u)),
        scalar!("hamiltonian", "q, v", m.hamiltonian(&q, &v)),
        entry!("joint_torque_regressor", "q, v, a", m.joint_torque_regressor(&q, &v, &a)),
        entry!("centroidal_momentum_matrix", "q", m.centroidal_momentum_matrix(&q)),
        entry!("mass_matrix_packed", "q", m.mass_matrix_packed(&q)),
        entry!("inverse_dynamics_by_parameters", "q, v, a", m.inverse_dynamics_by_parameters(&q, &v, &a)),
        entry!("inverse_dynamics_second_derivatives", "q, v, a, tau", qq, qv, vv, qa),
    ]);
    case.entries.extend(steps!(Awkward, m, case));
    agrees(&case, &["tests/mechanisms/mod.rs", "--struct", "Awkward"]);
}

#[test]
fn what_is_driven_in_time() {
    let m = Balloon { mass: 3.0, buoyancy: 2.5 };
    let mut case = case!("balloon", Balloon, m, [3.0, 2.5], time(t = 0.7), of_trees);
    case.entries.extend(steps!(Balloon, m, case));
    agrees(&case, &["tests/mechanisms/mod.rs", "--struct", "Balloon"]);
}

/// Figures of [`Wing`], and the same as C writes them.
fn tables(smooth: bool, extrapolated: bool) -> ([Table<1>; 1], [Table<2>; 1], [Table<3>; 1]) {
    let drag = Table::new([&[-1.0, 0.2, 0.5, 2.0]], &[0.3, -0.1, 0.4, 0.2]);
    let lift = Table::new([&[-0.2, 0.1, 0.5], &[-1.0, 1.0]], &[0.1, 0.2, 0.7, -0.3, 0.4, 0.9]);
    let moment = Table::new(
        [&[0.0, 1.0], &[-1.0, 0.0, 1.5], &[0.0, 0.3]],
        &[0.1, 0.2, 0.7, -0.3, 0.4, 0.9, 0.15, 0.25, 0.75, -0.35, 0.45, 0.95],
    );
    fn shaped<const N: usize>(
        table: Result<Table<N>, linkwork::TableError>,
        smooth: bool,
        on: bool,
    ) -> [Table<N>; 1] {
        let table = table.expect("a table");
        let table = if smooth { table.smooth() } else { table };
        [if on { table.extrapolated() } else { table }]
    }
    (
        shaped(drag, smooth, extrapolated),
        shaped(lift, smooth, extrapolated),
        shaped(moment, smooth, extrapolated),
    )
}

const ARRAYS: &str = "    static const double d0[] = {-1.0, 0.2, 0.5, 2.0}, d[] = {0.3, -0.1, 0.4, 0.2};
    static const double l0[] = {-0.2, 0.1, 0.5}, l1[] = {-1.0, 1.0}, l[] = {0.1, 0.2, 0.7, -0.3, 0.4, 0.9};
    static const double m0[] = {0.0, 1.0}, m1[] = {-1.0, 0.0, 1.5}, m2[] = {0.0, 0.3};
    static const double m[] = {0.1, 0.2, 0.7, -0.3, 0.4, 0.9, 0.15, 0.25, 0.75, -0.35, 0.45, 0.95};
";

/// Tables within the grid and beyond it, of every shape.
#[test]
fn tables_are_looked_up_alike() {
    let written = [
        ", {{l0, l1, 0}, {3, 2, 0}, l, 0, 0}, {{d0, 0, 0}, {4, 0, 0}, d, 0, 0}, {{m0, m1, m2}, {2, 3, 2}, m, 0, 0}",
        ", {{l0, l1, 0}, {3, 2, 0}, l, 0, 1}, {{d0, 0, 0}, {4, 0, 0}, d, 0, 1}, {{m0, m1, m2}, {2, 3, 2}, m, 0, 1}",
        ", {{l0, l1, 0}, {3, 2, 0}, l, 1, 0}, {{d0, 0, 0}, {4, 0, 0}, d, 1, 0}, {{m0, m1, m2}, {2, 3, 2}, m, 1, 0}",
        ", {{l0, l1, 0}, {3, 2, 0}, l, 1, 1}, {{d0, 0, 0}, {4, 0, 0}, d, 1, 1}, {{m0, m1, m2}, {2, 3, 2}, m, 1, 1}",
    ];
    for (k, (prefix, c)) in
        ["wing", "wing_on", "wing_smooth", "wing_smooth_on"].into_iter().zip(written).enumerate()
    {
        let ([drag], [lift], [moment]) = tables(k > 1, k % 2 == 1);
        let m = Wing { mass: 2.0, lift, drag, moment };
        let mut case = case!("wing", Wing, m, [2.0], time(), of_trees);
        case.prefix = prefix;
        case.tables = [ARRAYS, c];
        // Slopes by the length of a step are compared with differences, which are not exact where slopes jump.
        case.tolerance = 1e-9;
        case.entries.extend(steps!(Wing, m, case));
        agrees(&case, &["tests/mechanisms/mod.rs", "--struct", "Wing"]);
    }
}

/// Functions that solve for forces of constraints are not there, which the header and the command say; the others are.
#[test]
fn closed_loops_keep_what_needs_no_solution() {
    let m = FourBar { g: 9.8, density: 1.0, a: 1.0, b: 2.0, c: 2.5, d: 3.0 };
    let mut case = case!("four_bar", FourBar, m, [9.8, 1.0, 1.0, 2.0, 2.5, 3.0], time(), nothing);
    let q = vector(&case.given[0].1);
    case.entries.push(entry!("constraint_jacobian", "q", m.constraint_jacobian(&q)));
    case.entries.push(entry!("constraint_residuals", "q", m.constraint_residuals(&q)));
    agrees(&case, &["../../models/src/four_bar.rs"]);
    if !compilers().is_empty() {
        let header = std::fs::read_to_string(folder("four_bar").join("four_bar.h")).expect("the header");
        assert!(header.contains("Not in C:") && !header.contains("four_bar_forward_dynamics("), "{header}");
    }
}

#[test]
fn in_single_precision() {
    let case = case!("single", Ur5, Ur5, [], time(), of_trees);
    let Some(compiler) = compilers().into_iter().next() else {
        println!("skipped: there is no C compiler");
        return;
    };
    let folder = folder("single");
    export(&folder, &["--prefix", "single", "--scalar", "float", "../../models/urdf/ur5.urdf"]);
    let flags = ["-O2", "-Wdouble-promotion", "-Wfloat-conversion"];
    let found = printed(compiler, &folder, "single", &program(&case, "float"), &flags);
    compare(&case, &found, 2e-3);
}
