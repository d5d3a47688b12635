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

const MAIN: [&str; 5] =
    ["inverse_dynamics", "bias_forces", "mass_matrix", "forward_dynamics", "kinetic_energy"];

#[test]
fn show() {
    for (name, options) in [
        ("cartpole", ""), ("ur5", ""), ("panda", ", mimic = independent"), ("panda", ", lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]"),
        ("kinova", ""), ("solo12", ", base = free, inertia = trust"), ("simple_humanoid", ", base = free, inertia = trust"),
    ] {
        let arguments = format!("urdf = \"../models/urdf/{name}.urdf\"{options}");
        let c = counts(&arguments, "pub struct Robot;", &MAIN);
        println!("{name}{options}: {:?}", c.iter().map(|(m, a, d)| m + a + d).collect::<Vec<_>>());
    }
    for n in [1, 2, 4, 8, 16, 32] {
        for symbolic in [false, true] {
            let c = counts("gravity = -9.81 * z", &chain(n, symbolic), &MAIN);
            println!("chain {n} {symbolic}: {:?}", c.iter().map(|(m, a, d)| m + a + d).collect::<Vec<_>>());
        }
    }
}
