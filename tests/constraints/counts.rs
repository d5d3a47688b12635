//! Checks of the numbers of operations in generated code for constrained dynamics.

use linkwork_compiler::compile;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::parse_source_and_import;
use quote::ToTokens;
use std::fmt::Write;
use std::path::Path;
use syn::{Item, Meta};

/// Returns the number of multiplications, additions and divisions of the constrained dynamics.
fn count_operations(arguments: &str, item: &str) -> usize {
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let mut cx = Diagnostics::new();
    let source = parse_source_and_import(parse_tokens(arguments), parse_tokens(item), Path::new(""), &mut cx);
    let graph = Graph::new();
    let output = source.and_then(|source| compile(&source, &graph, &mut cx));
    let (_, output) = output.unwrap_or_else(|| panic!("{}\n{item}", cx.full_message_texts().join("\n")));
    let found = output.functions.iter().find(|f| f.name == "__constrained_dynamics");
    found.expect("it has constraints").program.counts.total_operations()
}

/// Returns the source of the mechanism with `n` windows of the IFToMM benchmark A02.
fn windows_source(n: usize) -> String {
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

/// The elimination preserves the zeros of a chain of loops: each window adds the same number of operations.
#[test]
fn elimination_of_loop_chains_grows_linearly() {
    let counts: Vec<usize> =
        (1..=10).map(|n| count_operations("gravity = -9.81 * y", &windows_source(n))).collect();
    let steps: Vec<usize> = counts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let (least, most) = (steps[2..].iter().min(), steps[2..].iter().max());
    assert_eq!(least, most, "{counts:?}");
    assert!(counts[0] <= 300, "{counts:?}");
}

/// Returns the mechanism in the file `name` of the models: the arguments of its attribute, and its struct.
fn model_source(name: &str) -> (String, String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../models/src/{name}.rs"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let file = syn::parse_file(&text).expect("it is Rust");
    let mechanism = file.items.into_iter().find_map(|item| {
        let Item::Struct(mut item) = item else { return None };
        let k = item.attrs.iter().position(|a| a.path().is_ident("mechanism"))?;
        let arguments = match item.attrs.remove(k).meta {
            Meta::List(list) => list.tokens.to_string(),
            _ => String::new(),
        };
        Some((arguments, item.to_token_stream().to_string()))
    });
    mechanism.expect("it has a mechanism")
}

/// Returns the source of a platform on legs of variable length with ball joints.
fn platform_source(legs: usize) -> String {
    let mut item = String::from(
        "struct Platform {
        #[body(mass = 30, inertia = diagonal(1.5, 1.5, 2.5))] platform: Body,
        #[joint(ground -> platform)] pose: Free,\n",
    );
    for k in 0..legs {
        let (foot, head) = (6 * k + 1, 5 * k + 2);
        let _ = writeln!(
            item,
            "#[body(mass = 2, com = 0.3 * z, inertia = rod(2, 0.6, z))] lower{k}: Body,
            #[body(mass = 2, com = -0.3 * z, inertia = rod(2, 0.6, z))] upper{k}: Body,
            #[joint(ground.at(0.8 * (cos(1 * {foot}) * x + sin(1 * {foot}) * y)) -> lower{k}, about = (x, \
                y))] foot{k}: Universal,
            #[joint(lower{k} -> upper{k}, along = z)] slide{k}: Sleeve,
            #[joint(upper{k} -> platform.at(0.5 * (cos(1 * {head}) * x + sin(1 * {head}) * y)))] head{k}: \
                Ball,"
        );
    }
    item + "}"
}

/// The numbers of operations of the models are exact, which shows every change that the compiler makes to
/// them.
#[test]
fn operation_counts_of_constrained_models_are_exact() {
    let expected = [
        ("four_bar", 181),
        ("slider_crank", 148),
        ("andrews_squeezer", 485),
        ("windows", 342),
        ("bricard_linkage", 1329),
        ("five_bar", 268),
        ("rolling_disk", 539),
        ("ball_in_bowl", 897),
        ("chaplygin_sleigh", 60),
        ("bicycle", 3049),
        ("rattleback", 791),
    ];
    let found = expected.map(|(name, _)| {
        let (arguments, item) = model_source(name);
        (name, count_operations(&arguments, &item))
    });
    assert_eq!(found, expected);
    let platforms = [3, 4, 5, 6].map(|legs| count_operations("gravity = -9.81 * z", &platform_source(legs)));
    let bounds = [1640, 2590, 3860, 5890];
    assert!(
        platforms.iter().zip(&bounds).all(|(found, bound)| found <= bound),
        "{platforms:?}, at most {bounds:?}"
    );
}
