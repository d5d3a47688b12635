//! Random URDF and SDF files with joints of every type, compared with poses computed by the definitions of
//! the format and with Kane's equations.

use crate::kane::State;
use crate::random::Random;
use crate::robot::Robot;
use crate::sdf;
use crate::test_seeds;
use linkwork_compiler::derive::{DerivationOutput, Function};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::{Graph, Symbol};
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::syntax::{self, BaseAttachment, FileFormat, FileInputSource, FileOptions, Name};
use linkwork_compiler::{derive, import, parse_source_and_import};
use std::path::Path;

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Imports a robot file. Returns the names of its coordinates, and its generated functions.
fn coordinate_names_and_functions(
    robot: &Robot,
    format: FileFormat,
    text: &str,
) -> (Vec<String>, DerivationOutput) {
    let mut cx = Diagnostics::new();
    let (arguments, item) = ("".parse().unwrap(), "struct Robot;".parse().unwrap());
    let mut source = parse_source_and_import(arguments, item, Path::new(""), &mut cx).expect("a struct");
    let place = source.mechanism.description.name.place.clone();
    let name_from_text = |text: &str| Name { text: text.to_string(), place: place.clone() };
    let options = FileOptions {
        base: if robot.free { BaseAttachment::Free } else { BaseAttachment::Fixed },
        inputs: FileInputSource::Joints,
        lock: robot.locked_joint_names().map(name_from_text).collect(),
        ..FileOptions::default_options_of_file(format, name_from_text("file"))
    };
    let imported = import::import_file(text, Path::new(""), &options, &mut cx);
    let imported = imported.unwrap_or_else(|| panic!("{:?}\n{text}", cx.full_message_texts()));
    let description = &mut source.mechanism.description;
    (description.bodies, description.joints) = (imported.bodies, imported.joints);
    description.gravity = Some(syntax::Expr::vector_at(GRAVITY, &place));
    let graph = Graph::new();
    let model = build_model(description, &graph, &mut cx);
    let output = model.as_ref().and_then(|model| derive(model, &mut cx));
    let output = output.unwrap_or_else(|| panic!("{:?}\n{text}", cx.full_message_texts()));
    (model.map(|model| model.configuration).unwrap_or_default(), output)
}

/// Returns the values of a function from the scalar program and from the program with lanes.
fn values_of_function(f: &Function, [q, v, a]: &[Vec<f64>; 3], tau: &[f64]) -> Vec<Vec<f64>> {
    let state_value_of_symbol = |symbol: Symbol| match Quantity::from_symbol(symbol) {
        Quantity::Configuration(k) => q[k],
        Quantity::Velocity(k) => v[k],
        Quantity::Acceleration(k) => a[k],
        Quantity::Force(k) => tau[k],
        other => panic!("{other:?}"),
    };
    [Some(&f.program), f.program.simd.as_deref()]
        .into_iter()
        .flatten()
        .map(|p| p.interpret_program(&state_value_of_symbol))
        .collect()
}

fn assert_near(what: &str, seed: u64, found: &[f64], expected: &[f64], text: &str) {
    let size = expected.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    let off = found.iter().zip(expected).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
    assert!(found.len() == expected.len() && off <= 1e-10 * size, "{what} of {seed}: {off}\n{text}");
}

/// Reference values of a motion: generalized forces, energies, centre of mass.
struct ReferenceMotionValues {
    forces: Vec<f64>,
    kinetic: f64,
    potential: f64,
    center: [f64; 3],
}

/// Computes the reference values with Kane's equations, from the partial velocities of every link.
fn reference_values(robot: &Robot, [q, v, a]: &[Vec<f64>; 3]) -> ReferenceMotionValues {
    let pieces = robot.moving_bodies(&State::new(q, v, a));
    let partial_velocities = |k: usize| {
        let unit: Vec<f64> = (0..v.len()).map(|j| f64::from(u8::from(j == k))).collect();
        robot.moving_bodies(&State::new(q, &unit, &vec![0.0; v.len()]))
    };
    let generalized_inertial_force = |k: usize| {
        pieces
            .iter()
            .zip(partial_velocities(k))
            .map(|(p, moved)| p.generalized_inertial_force(&moved, GRAVITY).re)
            .sum()
    };
    let mass: f64 = pieces.iter().map(|p| p.mass).sum();
    let moment = std::array::from_fn(|i| pieces.iter().map(|p| p.mass * p.p[i].0[0].re).sum::<f64>());
    ReferenceMotionValues {
        forces: (0..v.len()).map(generalized_inertial_force).collect(),
        kinetic: pieces.iter().map(|p| p.kinetic_energy().re).sum(),
        potential: -(0..3).map(|i| GRAVITY[i] * moment[i]).sum::<f64>(),
        center: moment.map(|m| m / mass),
    }
}

/// Files of two to seven links, some of which are locked, follow others or are in random order.
#[test]
fn random_urdf_files_have_the_dynamics_of_the_format() {
    let mut kinds = [0; 7];
    for seed in test_seeds(20) {
        let mut random = Random::new(4_000_000 + seed);
        let robot = Robot::random_robot(&[0, 1, 2, 3, 4, 5, 6], &mut random);
        robot.count_joint_types(&mut kinds);
        check_file_against_kane(&robot, FileFormat::Urdf, &robot.urdf_text(), seed, &mut random);
    }
    assert!(test_seeds(20).end < 20 || kinds.iter().all(|count| *count >= 3), "{kinds:?}");
}

/// Files of all versions of SDF, which use different frames for links and axes, describe the same motion.
#[test]
fn random_sdf_files_of_all_versions_have_equal_dynamics() {
    for seed in test_seeds(40) {
        let mut random = Random::new(4_500_000 + seed);
        let robot = Robot::random_robot(&sdf::OF_SDF, &mut random);
        let text = sdf::sdf_text(&robot, &mut random);
        check_file_against_kane(&robot, FileFormat::Sdf, &text, seed, &mut random);
    }
}

/// Compares the functions of a robot's file with Kane's equations at two states.
fn check_file_against_kane(robot: &Robot, format: FileFormat, text: &str, seed: u64, random: &mut Random) {
    let (names, output) = coordinate_names_and_functions(robot, format, text);
    assert_eq!(names, robot.coordinate_names(), "{text}");
    let find_function = |name: &str| output.functions.iter().find(|f| f.name == name).expect("a function");
    for _ in 0..2 {
        let state = robot.random_state(random);
        let expected = reference_values(robot, &state);
        let check_function = |name: &str, expected: &[f64]| {
            for found in values_of_function(find_function(name), &state, &[]) {
                assert_near(name, seed, &found, expected, text);
            }
        };
        check_function("inverse_dynamics", &expected.forces);
        check_function("kinetic_energy", &[expected.kinetic]);
        if robot.links.iter().enumerate().any(|(k, _)| robot.can_move_link(k)) {
            check_function("potential_energy", &[expected.potential]);
            check_function("center_of_mass", &expected.center);
        }
        for found in values_of_function(find_function("forward_dynamics"), &state, &expected.forces) {
            let size = state[2].iter().fold(1.0_f64, |size, a| size.max(a.abs()));
            let off = found.iter().zip(&state[2]).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
            assert!(off <= 1e-6 * size, "forward dynamics of {seed}: {off}\n{}", text);
        }
    }
}
