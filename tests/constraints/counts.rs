//! What constrained dynamics costs, in operations.

use linkwork_compiler::compile;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::read;
use std::fmt::Write;
use std::path::Path;

/// Multiplications, additions and divisions of the constrained dynamics.
fn operations(item: &str) -> usize {
    let tokens = |text: &str| text.parse().expect("the generated source is Rust");
    let mut cx = Diagnostics::new();
    let source = read(tokens("gravity = -9.81 * y"), tokens(item), Path::new(""), &mut cx);
    let graph = Graph::new();
    let output = source.and_then(|source| compile(&source, &graph, &mut cx));
    let (_, output) = output.unwrap_or_else(|| panic!("{}\n{item}", cx.messages().join("\n")));
    let found = output.functions.iter().find(|f| f.name == "__constrained_dynamics");
    found.expect("it has constraints").program.counts.total()
}

/// The mechanism with `n` windows of the IFToMM benchmark A02.
fn windows(n: usize) -> String {
    let mut item = String::from("struct Windows {\n");
    for k in 0..=n {
        let _ = writeln!(
            item,
            "#[body(mass = 1, com = 0.5 * y, inertia = rod(1, 1, y))] post{k}: Body,
            #[joint(ground.at({k} * x) -> post{k}, about = z)] foot{k}: Pin,"
        );
        if k < n {
            let _ = writeln!(
                item,
                "#[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))] beam{k}: Body,
                #[joint(post{k}.at(y) -> beam{k}, about = z)] head{k}: Pin,"
            );
        }
        if k > 0 {
            let before = k - 1;
            let _ = writeln!(item, "#[joint(beam{before}.at(x) -> post{k}.at(y), about = z)] close{k}: Pin,");
        }
    }
    item + "}"
}

/// The elimination keeps the zeros of a chain of loops: each window costs as much as the one before.
#[test]
fn a_chain_of_loops_costs_in_proportion_to_its_length() {
    let counts: Vec<usize> = (1..=10).map(|n| operations(&windows(n))).collect();
    let steps: Vec<usize> = counts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let (least, most) = (steps[2..].iter().min(), steps[2..].iter().max());
    assert_eq!(least, most, "{counts:?}");
    assert!(counts[0] <= 300, "{counts:?}");
}
