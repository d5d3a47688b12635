//! Operations of the generated functions, exactly: a change of the compiler that costs or saves some is seen here.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::lower::{Op, Program};
use linkwork_compiler::{compile, read};
use std::path::Path;

/// The programs of some functions.
fn programs(arguments: &str, item: &str, functions: &[&str]) -> Vec<Program> {
    programs_and_nodes(arguments, item, functions).0
}

/// The programs of some functions, and how many expressions were made on the way.
fn programs_and_nodes(arguments: &str, item: &str, functions: &[&str]) -> (Vec<Program>, usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tokens = |text: &str| text.parse().expect("the source is Rust");
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let source = read(tokens(arguments), tokens(item), folder, &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.messages().join("\n"));
    };
    let find = |name: &&str| {
        let f = output.functions.iter().find(|f| f.name == *name).expect("the function is generated");
        f.program.clone()
    };
    (functions.iter().map(find).collect(), graph.len())
}

fn chain(n: usize, symbolic: bool) -> String {
    let mut item = String::from("pub struct Chain {");
    for k in 0..n {
        let (m, l) = if symbolic {
            item.push_str(&format!("m{k}: f64, l{k}: f64,"));
            (format!("m{k}"), format!("l{k}"))
        } else {
            ("2.0".to_string(), "0.5".to_string())
        };
        let parent = match k {
            0 => "ground".to_string(),
            _ if symbolic => format!("b{}.at(l{} * x)", k - 1, k - 1),
            _ => format!("b{}.at(0.5 * x)", k - 1),
        };
        let axis = ["z", "y"][k % 2];
        item.push_str(&format!(
            "#[body(mass = {m}, com = {l} / 2 * x, inertia = cylinder({m}, 0.05, {l}, x))] b{k}: Body,
             #[joint({parent} -> b{k}, about = {axis})] j{k}: Pin,"
        ));
    }
    item.push('}');
    item
}

const MAIN: [&str; 4] = ["inverse_dynamics", "bias_forces", "mass_matrix", "forward_dynamics"];

fn totals(arguments: &str, item: &str) -> [usize; 4] {
    let all = programs(arguments, item, &MAIN);
    std::array::from_fn(|k| all[k].counts.total())
}

/// With alike limbs as lanes: multiplications, additions and divisions together, each on all lanes at once, sums over lanes
/// among the additions; and the instructions that are left of them when products are fused into sums.
#[test]
fn robots_in_lanes() {
    for (name, totals, instructions) in [
        ("solo12", [326, 295, 142, 783], [226, 202, 110, 551]),
        ("simple_humanoid", [1141, 1081, 1250, 2819], [757, 712, 869, 1938]),
    ] {
        let arguments = format!("urdf = \"../models/urdf/{name}.urdf\", base = free");
        let programs = programs(&arguments, "pub struct Robot;", &MAIN).into_iter();
        let in_lanes: Vec<_> = programs.map(|p| p.in_lanes.expect("its limbs are alike")).collect();
        let fused = |program: &Program| {
            let operations = program.instructions.iter().filter(|op| !matches!(op, Op::Lane(..)));
            operations.count() - program.counts.calls
        };
        let found = |k: usize| (in_lanes[k].counts.total(), fused(&in_lanes[k]));
        for k in 0..MAIN.len() {
            assert_eq!(found(k), (totals[k], instructions[k]), "{name}: {}", MAIN[k]);
        }
    }
}

/// Multiplications, additions and divisions together; sines and cosines apart.
#[test]
fn robots() {
    let free = ", base = free";
    let locked = ", lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]";
    for (name, options, expected) in [
        ("cartpole", "", [15, 5, 2, 18]),
        ("ur5", "", [277, 246, 145, 513]),
        ("panda", locked, [575, 550, 345, 1131]),
        ("panda", ", mimic = independent", [648, 621, 447, 1316]),
        ("kinova", "", [632, 609, 504, 1272]),
        ("solo12", free, [1090, 1005, 541, 2415]),
        ("simple_humanoid", free, [1967, 1878, 2338, 4781]),
    ] {
        let arguments = format!("urdf = \"../models/urdf/{name}.urdf\"{options}");
        assert_eq!(totals(&arguments, "pub struct Robot;"), expected, "{name}{options}: {MAIN:?}");
    }
}

/// Chains of pins about alternating axes, with numbers and with parameters. Inverse and forward dynamics grow with the
/// number of joints, the mass matrix with its square.
#[test]
fn chains() {
    let mut before: Option<[usize; 4]> = None;
    for (n, numbers, parameters) in [
        (1, [1, 0, 0, 1], [9, 0, 8, 10]),
        (2, [31, 20, 5, 30], [55, 34, 29, 59]),
        (4, [172, 153, 62, 265], [235, 206, 127, 356]),
        (8, [446, 422, 388, 1122], [591, 558, 547, 1354]),
        (16, [990, 958, 1760, 2764], [1303, 1262, 2155, 3137]),
        (32, [2078, 2030, 7384, 6052], [2727, 2670, 8443, 6817]),
        (64, [4254, 4174, 30152, 12628], [5575, 5486, 33307, 14177]),
    ] {
        let found = totals("gravity = -9.81 * z", &chain(n, false));
        assert_eq!(found, numbers, "{n} joints with numbers: {MAIN:?}");
        let symbolic = totals("gravity = -9.81 * z", &chain(n, true));
        assert_eq!(symbolic, parameters, "{n} joints with parameters: {MAIN:?}");
        // The factorisation gives way to articulated bodies beyond some length, so growth shows from eight on.
        if let Some(before) = before.filter(|_| n >= 16) {
            for k in [0, 1] {
                assert!(found[k] < before[k] * 5 / 2, "{} grows linearly", MAIN[k]);
            }
            assert!(found[3] < before[3] * 4, "forward dynamics does not grow with the cube");
            assert!(
                found[2] > before[2] * 3 && found[2] < before[2] * 5,
                "the mass matrix grows with the square"
            );
        }
        before = Some(found);
    }
}

/// From sixteen joints to sixty-four what inverse and forward dynamics cost is a straight line, and what the mass matrix
/// and the derivatives cost a parabola: three lengths tell all others, up to a few operations. The expressions
/// that the compiler makes for all functions together grow with the square at most.
#[test]
fn curves_of_growth() {
    let lines = ["inverse_dynamics", "bias_forces", "forward_dynamics"];
    let parabolas = ["mass_matrix", "inverse_dynamics_derivatives", "coriolis_matrix"];
    let all = [&lines[..], &parabolas].concat();
    let at = |n: usize| {
        let (programs, nodes) =
            programs_and_nodes("gravity = -9.81 * z, derivatives", &chain(n, false), &all);
        let mut totals: Vec<f64> = programs.iter().map(|p| p.counts.total() as f64).collect();
        totals.push(nodes as f64);
        totals
    };
    let [a, b, c] = [16, 20, 24].map(at);
    for n in [32, 48, 64] {
        let (found, s) = (at(n), (n as f64 - 16.0) / 4.0);
        for (k, name) in all.iter().enumerate() {
            let bend = c[k] - 2.0 * b[k] + a[k];
            assert!(k >= lines.len() || bend == 0.0, "{name} is a line");
            let expected = a[k] + s * (b[k] - a[k]) + s * (s - 1.0) / 2.0 * bend;
            assert!((found[k] - expected).abs() <= 1e-3 * expected, "{name} of {n}: {}", found[k]);
        }
        let growth = found[all.len()] / a[all.len()];
        assert!(growth < (n as f64 / 16.0).powi(2), "{n}: {growth} times the expressions of 16");
    }
}
