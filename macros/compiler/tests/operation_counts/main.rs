//! Operation counts of generated functions. Twenty-four counts are exact: those of a small chain with
//! parameters, of a robot, and of a robot whose limbs are SIMD lanes. All other counts are upper bounds with
//! a margin of two per cent for changes of the cost model.

use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::lower::{Op, Program};
use linkwork_compiler::{compile, parse_source_and_import};
use std::path::Path;

/// Compiles a mechanism and returns the programs of the named functions.
fn compile_named_programs(arguments: &str, item: &str, functions: &[&str]) -> Vec<Program> {
    programs_and_nodes(arguments, item, functions).0
}

/// Returns the programs of these functions, and the number of expressions in the graph.
fn programs_and_nodes(arguments: &str, item: &str, functions: &[&str]) -> (Vec<Program>, usize) {
    call_with_compiled_output(arguments, item, |output, graph| {
        let program_of_function_name = |name: &&str| {
            let f = output.functions.iter().find(|f| f.name == *name).expect("the function is generated");
            f.program.clone()
        };
        (functions.iter().map(program_of_function_name).collect(), graph.len())
    })
}

/// Compiles a mechanism and passes the result, with its graph of expressions, to a function.
fn call_with_compiled_output<R>(
    arguments: &str,
    item: &str,
    f: impl FnOnce(&DerivationOutput, &Graph) -> R,
) -> R {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let source = parse_source_and_import(parse_tokens(arguments), parse_tokens(item), folder, &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.full_message_texts().join("\n"));
    };
    f(&output, &graph)
}

fn chain_source(n: usize, symbolic: bool) -> String {
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

fn main_operation_counts(arguments: &str, item: &str) -> [usize; 4] {
    let all = compile_named_programs(arguments, item, &MAIN);
    std::array::from_fn(|k| all[k].counts.total_operations())
}

/// Checks that no operation count exceeds its bound.
fn assert_within_bounds(found: &[usize], bounds: &[usize], what: &str) {
    assert!(found.iter().zip(bounds).all(|(n, most)| n <= most), "{what}: {found:?}, at most {bounds:?}");
}

/// Returns the number of instructions after fusion of products and sums, without sines and cosines.
fn count_fused_instructions(program: &Program) -> usize {
    let operations = program.instructions.iter().filter(|op| !matches!(op, Op::Lane(..) | Op::Join(..)));
    operations.count() - program.counts.calls
}

/// Returns the operations of the main functions of a robot, without sines and cosines, and the number of
/// instructions after fusion. With `lanes`, the programs with lanes for identical limbs are counted.
fn robot_operation_counts(name: &str, options: &str, lanes: bool) -> [[usize; 4]; 2] {
    let arguments = format!("urdf = \"../../models/urdf/{name}.urdf\"{options}");
    let all = compile_named_programs(&arguments, "pub struct Robot;", &MAIN);
    let all: Vec<&Program> =
        all.iter().map(|p| if lanes { p.simd.as_deref().expect("its limbs are alike") } else { p }).collect();
    [
        std::array::from_fn(|k| all[k].counts.total_operations()),
        std::array::from_fn(|k| count_fused_instructions(all[k])),
    ]
}

#[test]
fn operation_counts_of_small_mechanisms_are_exact() {
    assert_eq!(
        robot_operation_counts("ur5", "", false),
        [[229, 170, 93, 356], [149, 117, 70, 243]],
        "{MAIN:?}"
    );
    assert_eq!(
        robot_operation_counts("solo12", ", base = free", true),
        [[323, 292, 139, 757], [205, 187, 101, 499]],
        "{MAIN:?}"
    );
    assert_eq!(
        main_operation_counts("gravity = -9.81 * z", &chain_source(2, false)),
        [31, 20, 4, 29],
        "{MAIN:?}"
    );
    assert_eq!(
        main_operation_counts("gravity = -9.81 * z", &chain_source(2, true)),
        [55, 33, 29, 58],
        "{MAIN:?}"
    );
}

#[test]
fn operation_counts_of_robots_are_exact() {
    let free = ", base = free";
    let locked = ", lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]";
    for (name, options, lanes, total, fused) in [
        ("cartpole", "", false, [15, 5, 2, 18], [11, 5, 2, 13]),
        ("panda", locked, false, [590, 570, 350, 1160], [390, 370, 250, 760]),
        ("panda", ", mimic = independent", false, [660, 640, 450, 1430], [440, 410, 330, 940]),
        ("kinova", "", false, [650, 620, 490, 1250], [410, 390, 310, 780]),
        ("gen3", "", false, [850, 820, 790, 1850], [540, 530, 530, 1190]),
        ("gen3", ", snap = 1e-4", false, [600, 570, 370, 1180], [400, 380, 260, 780]),
        ("solo12", free, false, [1090, 1000, 510, 2270], [710, 660, 360, 1530]),
        ("simple_humanoid", free, false, [2000, 1910, 2380, 4850], [1250, 1190, 1640, 3210]),
        ("simple_humanoid", free, true, [1160, 1100, 1280, 2870], [730, 690, 890, 1880]),
    ] {
        let [totals, instructions] = robot_operation_counts(name, options, lanes);
        assert_within_bounds(&totals, &total, &format!("{name}{options}, operations of {MAIN:?}"));
        assert_within_bounds(&instructions, &fused, &format!("{name}{options}, instructions of {MAIN:?}"));
    }
}

/// Instructions of contact functions for four legs. Contact velocities of the legs are evaluated in lanes. A
/// step with fixed contact modes calls these functions.
#[test]
fn operation_counts_of_legged_contacts_are_exact() {
    let item = "pub struct Robot {
        #[contact(FL_FOOT, ground.plane(z), friction = 0.7)] front_left: Contact,
        #[contact(FR_FOOT, ground.plane(z), friction = 0.7)] front_right: Contact,
        #[contact(HL_FOOT, ground.plane(z), friction = 0.7)] hind_left: Contact,
        #[contact(HR_FOOT, ground.plane(z), friction = 0.7)] hind_right: Contact,
    }";
    let functions =
        ["contact_rates", "contact_jacobian", "contact_bias", "__contact_responses", "__contact_derivatives"];
    let arguments = "urdf = \"../../models/urdf/solo12.urdf\", base = free, gravity = -9.81 * z, limits = \
                     ignore, derivatives";
    let all = compile_named_programs(arguments, item, &functions);
    let in_lanes: Vec<usize> = all
        .iter()
        .map(|p| count_fused_instructions(p.simd.as_deref().expect("its limbs are alike")))
        .collect();
    assert_within_bounds(
        &in_lanes,
        &[92, 126, 199, 1142, 1083],
        &format!("instructions in lanes of {functions:?}"),
    );
    let alone: Vec<usize> = all.iter().map(count_fused_instructions).collect();
    assert_within_bounds(&alone, &[254, 262, 485, 3486, 3777], &format!("instructions of {functions:?}"));
}

/// Chains of pins about alternating axes, with numbers and with parameters. Inverse and forward dynamics grow
/// linearly with the number of joints, the mass matrix grows quadratically.
#[test]
fn operation_counts_of_chains_grow_linearly() {
    let mut before: Option<[usize; 4]> = None;
    for (n, numbers, parameters) in [
        (1, [1, 0, 0, 1], [9, 0, 8, 10]),
        (4, [180, 160, 60, 270], [240, 210, 130, 370]),
        (8, [450, 430, 400, 1140], [610, 570, 560, 1380]),
        (16, [1000, 970, 1800, 2810], [1330, 1290, 2190, 3190]),
        (32, [2110, 2060, 7540, 6160], [2790, 2730, 8620, 6940]),
        (64, [4310, 4230, 30760, 12850], [5690, 5600, 33980, 14430]),
    ] {
        let found = main_operation_counts("gravity = -9.81 * z", &chain_source(n, false));
        assert_within_bounds(&found, &numbers, &format!("{n} joints with numbers: {MAIN:?}"));
        let symbolic = main_operation_counts("gravity = -9.81 * z", &chain_source(n, true));
        assert_within_bounds(&symbolic, &parameters, &format!("{n} joints with parameters: {MAIN:?}"));
        // Beyond some length, articulated bodies replace the factorisation, so growth is tested from eight
        // joints on.
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

/// Checks how operation counts grow from sixteen to sixty-four joints: linearly for inverse and forward
/// dynamics, quadratically for the mass matrix and derivatives. The number of expressions for all functions
/// grows at most quadratically.
#[test]
fn operation_counts_grow_with_the_expected_power() {
    let lines = ["inverse_dynamics", "bias_forces", "forward_dynamics"];
    let parabolas = ["mass_matrix", "inverse_dynamics_derivatives", "coriolis_matrix"];
    let all = [&lines[..], &parabolas].concat();
    let chain_operation_and_node_counts = |n: usize| {
        let (programs, nodes) =
            programs_and_nodes("gravity = -9.81 * z, derivatives", &chain_source(n, false), &all);
        let mut totals: Vec<f64> = programs.iter().map(|p| p.counts.total_operations() as f64).collect();
        totals.push(nodes as f64);
        totals
    };
    let [a, b, c] = [16, 20, 24].map(chain_operation_and_node_counts);
    for n in [32, 48, 64] {
        let (found, s) = (chain_operation_and_node_counts(n), (n as f64 - 16.0) / 4.0);
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

/// Returns a planar chain of particles on rods; the angles of all preceding rods determine each position.
fn particle_chain_source(n: usize) -> String {
    let mut item = String::from("pub struct Placed {");
    let (mut x, mut z) = (Vec::new(), Vec::new());
    for k in 1..=n {
        let length = 0.3 + 0.01 * k as f64;
        x.push(format!("{length:.2} * sin(a{k})"));
        z.push(format!("{length:.2} * cos(a{k})"));
        item.push_str(&format!(
            "a{k}: Coordinate,
             #[particle(mass = {:.1}, at = ({}) * x - ({}) * z)] p{k}: Particle,",
            1.0 + 0.1 * k as f64,
            x.join(" + "),
            z.join(" + ")
        ));
    }
    item.push('}');
    item
}

/// Common terms of the particles are summed once. The mass matrix takes `3/2 n²` operations, the
/// factorisation takes the `n³/3` of a full matrix, and all other functions grow linearly.
#[test]
fn absolute_coordinate_chains_have_expected_operation_counts() {
    let lines = [
        ("bias_forces", 16, -10),
        ("inverse_dynamics", 22, -24),
        ("kinetic_energy", 12, -2),
        ("generalized_momentum", 13, -4),
        ("momentum_rate", 15, -4),
    ];
    for n in [16, 24, 32, 48_i64] {
        let names: Vec<&str> =
            lines.iter().map(|line| line.0).chain(["mass_matrix", "forward_dynamics"]).collect();
        let all = compile_named_programs("gravity = -9.81 * z", &particle_chain_source(n as usize), &names);
        let found: Vec<i64> = all.iter().map(|program| program.counts.total_operations() as i64).collect();
        for ((name, slope, start), found) in lines.iter().zip(&found) {
            assert_eq!(*found, slope * n + start, "{name} of {n} particles");
        }
        assert_eq!(found[5], (3 * n * n + 11 * n) / 2, "mass matrix of {n} particles");
        assert!(found[6] < n * n * n / 3 + 6 * n * n, "forward dynamics of {n} particles: {}", found[6]);
    }
}

/// Checks that a mechanism just below the size limit for comparing candidates takes fewer expressions to
/// compile than one of twice the size.
#[test]
fn comparing_candidates_costs_less_than_doubling_the_size() {
    let chain_declaration = |n: usize| {
        let mut item = String::from("pub struct Chain {");
        for k in 0..n {
            let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at(0.4 * z)", k - 1) };
            item.push_str(&format!(
                "#[body(mass = 2, com = 0.2 * z, inertia = diagonal(0.03, 0.04, 0.02))] b{k}: Body,
                 #[joint({parent} -> b{k}, about = {})] j{k}: Pin,",
                ["y", "x", "z"][k % 3]
            ));
        }
        item.push('}');
        item
    };
    let [one, two] =
        [16, 32].map(|n| programs_and_nodes("gravity = -9.81 * z", &chain_declaration(n), &MAIN).1);
    assert!(4 * one < 3 * two, "16 spatial pins take {one} expressions, 32 take {two}");
}

/// Returns the operations of the main functions of a prepared mechanism.
fn prepared_operation_counts(arguments: &str) -> [usize; 4] {
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let item = "pub struct Robot;".parse().expect("the source is Rust");
    let source =
        parse_source_and_import(arguments.parse().expect("the source is Rust"), item, folder, &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.full_message_texts().join("\n"));
    };
    let functions = output.prepared.expect("it is asked for").functions;
    MAIN.map(|name| {
        functions.iter().find(|f| f.name == name).expect("it is there").program.counts.total_operations()
    })
}

/// After preparation, a robot with mass properties as parameters takes hardly more operations than with the
/// coefficients of the file, unless its bodies are symmetric. Zeros in a file save operations only as
/// numbers: the UR5, whose bodies are symmetric, takes twice as many.
#[test]
fn prepared_mass_parameters_add_few_operations() {
    let locked = ", lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]";
    for (name, options, parameters) in [
        ("panda", locked, "inertial"),
        ("kinova", "", "inertial"),
        ("panda", locked, "inertial(\"panda_hand\")"),
    ] {
        let file = format!("urdf = \"../../models/urdf/{name}.urdf\"{options}");
        let plain: [usize; 4] = robot_operation_counts(name, options, false)[0];
        let all = prepared_operation_counts(&format!("{file}, prepare, parameters = {parameters}"));
        let are_counts_within_ten_percent =
            |found: [usize; 4]| found.iter().zip(plain).all(|(n, plain)| 10 * n <= 11 * plain);
        assert!(are_counts_within_ten_percent(all), "{name}: {all:?}, of the file's figures {plain:?}");
    }
}

#[test]
fn loops_over_links_compute_the_derivatives_of_long_chains_only() {
    let has_loops = |n: usize| {
        call_with_compiled_output("derivatives", &chain_source(n, false), |output, _| {
            output.functions.iter().any(|f| f.loops.is_some())
        })
    };
    assert!(!has_loops(6));
    assert!(has_loops(20));
    let quadruped = r#"urdf = "../../models/urdf/solo12.urdf", base = free, derivatives"#;
    assert!(call_with_compiled_output(quadruped, "struct Solo;", |output, _| {
        output.functions.iter().all(|f| f.loops.is_none())
    }));
}
