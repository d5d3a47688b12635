//! Operations of the generated functions, exactly: a change of the compiler that costs or saves some is seen here.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::{compile, read};
use std::path::Path;

fn counts(arguments: &str, item: &str, functions: &[&str]) -> Vec<(usize, usize, usize)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tokens = |text: &str| text.parse().expect("the source is Rust");
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let source = read(tokens(arguments), tokens(item), folder, &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.messages().join("\n"));
    };
    functions
        .iter()
        .map(|name| {
            let f = output.functions.iter().find(|f| f.name == *name).expect("the function is generated");
            let c = f.program.counts;
            (c.mul, c.add, c.div)
        })
        .collect()
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
    let all = counts(arguments, item, &MAIN);
    std::array::from_fn(|k| all[k].0 + all[k].1 + all[k].2)
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
