//! Model passes change no generated function. Every variant of a model has the equations, energies, momenta
//! and frames of the model, on random trees with joints of every kind and on the robots.

mod random_limbs;
mod random_robot;
mod random_tree;

use linkwork_compiler::derive::{DerivationOutput, PreparedFunctions, limb_lanes};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::eval::eval;
use linkwork_compiler::expr::{Expr, Graph, Mat3, Vec3};
use linkwork_compiler::kinematics::{self, Joint};
use linkwork_compiler::lower::lower;
use linkwork_compiler::mechanics::passive::passive_forces;
use linkwork_compiler::mechanics::{self, aba, crba, energy, forces, frames, ldl, momentum, rnea};
use linkwork_compiler::mechanism::{Model, Quantity};
use linkwork_compiler::passes::{
    ModelVariant, PassSelection, characteristic_link_sizes, model_variants, variants_in_common_axes,
};
use linkwork_compiler::syntax::RequestedFunctions;
use linkwork_compiler::vectorise::{VectorisedMechanism, find_limb_groups};
use linkwork_compiler::{compile_with_passes, derive_with_options, parse_source_and_import};
use proptest::prelude::*;
use random_limbs::random_creatures;
use random_robot::random_robots;
use random_tree::random_trees;
use std::path::Path;
use support::model::{check_model_or_panic, check_model_or_return_errors, random_symbol_values};
use support::random::property_test_config;

/// Tolerance between results with and without passes, relative to the largest entry.
const TOLERANCE: f64 = 1e-10;

const CHOICES: [PassSelection; 4] = [
    PassSelection { frames: true, regroup: false, parallel: false, lanes: true, free_parameters: false },
    PassSelection { frames: false, regroup: true, parallel: true, lanes: true, free_parameters: false },
    PassSelection { frames: true, regroup: true, parallel: true, lanes: true, free_parameters: false },
    PassSelection { frames: true, regroup: true, parallel: true, lanes: true, free_parameters: true },
];

fn assert_near(what: &str, seed: u64, tolerance: f64, new: &[f64], old: &[f64]) {
    assert_eq!(new.len(), old.len(), "{what}");
    let scale = old.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    for (k, (a, b)) in new.iter().zip(old).enumerate() {
        assert!((a - b).abs() <= tolerance * scale, "{what}, entry {k}: {a} and {b} (seed {seed})");
    }
}

/// Returns all functions of a model as expressions. Functions that depend on the axes of links come last.
fn expressions_of_all_model_functions<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
) -> Vec<(&'static str, Vec<Expr<'g>>)> {
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let (mass, moment) = energy::mass_and_moment(model, joints);
    vec![
        ("mass matrix", crba::mass_matrix(model, joints).concat()),
        ("mass matrix in lanes", crba::mass_matrix_in_lanes(model, joints, 4).concat()),
        ("bias", rnea::inverse_dynamics(model, joints, &v, None)),
        ("inverse dynamics", rnea::inverse_dynamics(model, joints, &v, Some(&a))),
        ("kinetic energy", vec![energy::kinetic_energy(model, joints, &v)]),
        ("potential energy", vec![energy::potential_energy(model, joints)]),
        ("mass and moment", [vec![mass], moment.0.to_vec()].concat()),
        ("generalized momentum", momentum::generalized_momentum(model, joints, &v)),
        ("momentum rate", momentum::momentum_rate_without_inputs(model, joints, &v)),
        ("momentum", frames::spatial_components(&momentum::centroidal_momentum(model, joints, &v))),
        ("inputs", forces::generalized_forces_of_inputs(model, joints)),
        ("frames", frame_placements(model, joints)),
    ]
}

/// Returns rotation and position of all named frames in the ground frame.
fn frame_placements<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let g = model.graph;
    let mut world: Vec<(Mat3<'g>, Vec3<'g>)> = Vec::new();
    for joint in joints {
        let (r, p) = joint.parent.map_or((Mat3::identity(g), Vec3::zero(g)), |parent| world[parent.0]);
        world.push((r * joint.rotation.rotation_matrix(), p + r * joint.translation));
    }
    let mut all = Vec::new();
    for frame in &model.frames {
        let (r, p) = frame.link.map_or((Mat3::identity(g), Vec3::zero(g)), |link| world[link.0]);
        all.extend((r * frame.pose.rotation.rotation_matrix()).0.concat());
        all.extend((p + r * frame.pose.translation).0);
    }
    all
}

/// Checks that every variant of a model has the model's functions, and that forward dynamics inverts inverse
/// dynamics. Variants with common axes are compared only in functions that do not depend on the axes of
/// links.
fn check_variants(model: &Model<'_>, seed: u64) {
    let at = random_symbol_values(model, seed);
    let joints = kinematics::joints_of_model(model);
    let old: Vec<_> = expressions_of_all_model_functions(model, &joints)
        .into_iter()
        .map(|(name, e)| (name, eval(&e, &at)))
        .collect();
    let check_functions_of_variant = |variant: &ModelVariant<'_>, count: usize| {
        for ((name, new), (_, old)) in
            expressions_of_all_model_functions(&variant.model, &variant.joints).iter().zip(&old[..count])
        {
            assert_near(name, seed, TOLERANCE, &eval(new, &at), old);
        }
        check_forward_dynamics(variant, seed);
    };
    for passes in CHOICES {
        let variants = model_variants(model, passes);
        variants.iter().for_each(|variant| check_functions_of_variant(variant, old.len()));
        variants_in_common_axes(&variants)
            .iter()
            .for_each(|variant| check_functions_of_variant(variant, old.len() - 2));
    }
}

fn check_forward_dynamics(variant: &ModelVariant<'_>, seed: u64) {
    let (model, joints) = (&variant.model, &variant.joints);
    let at = random_symbol_values(model, seed);
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let tau = rnea::inverse_dynamics(model, joints, &v, Some(&a));
    let h = rnea::inverse_dynamics(model, joints, &v, None);
    let r: Vec<Expr<'_>> = tau.iter().zip(&h).map(|(t, h)| *t - *h).collect();
    let expected = eval(&a, &at);
    let mass = crba::mass_matrix(model, joints);
    let solved = eval(&ldl::solve_symmetric(mass, r.clone(), joints), &at);
    assert_near("factorisation", seed, 10.0 * TOLERANCE, &solved, &expected);
    let wrenches = rnea::link_wrenches(model, joints, &v, None);
    for articulated in [
        aba::inverse_mass_times_vector(model, joints, &r),
        aba::forward_dynamics(model, joints, wrenches, &tau),
    ] {
        let found = eval(&articulated.expect("no coordinate is coupled"), &at);
        assert_near("articulated bodies", seed, 10.0 * TOLERANCE, &found, &expected);
    }
}

/// Checks that the generated programs have the same results with and without passes, and no more operations
/// with passes.
fn check_passes_preserve_results(
    name: &str,
    model: &Model<'_>,
    new: &DerivationOutput,
    old: &DerivationOutput,
    tolerance: f64,
) {
    for seed in 0..3 {
        let at = random_symbol_values(model, seed);
        for (new, old) in new.functions.iter().zip(&old.functions) {
            let (a, b) = (new.program.interpret_program(&at), old.program.interpret_program(&at));
            assert_near(&format!("{name}: {}", new.name), seed, tolerance, &a, &b);
            if let Some(lanes) = &new.program.simd {
                assert_near(
                    &format!("{name}: {} in lanes", new.name),
                    seed,
                    tolerance,
                    &lanes.interpret_program(&at),
                    &b,
                );
            }
        }
    }
    if let Some(prepared) = &new.prepared {
        check_prepared_functions(name, model, prepared, old, tolerance);
    }
    for (new, old) in new.functions.iter().zip(&old.functions) {
        if ["mass_matrix", "inverse_dynamics"].contains(&new.name.as_str()) {
            let (after, before) =
                (new.program.counts.total_operations(), old.program.counts.total_operations());
            assert!(after <= before, "{name}: {}: {after} operations, {before} without passes", new.name);
        }
    }
}

const OFF: PassSelection =
    PassSelection { frames: false, regroup: false, parallel: false, lanes: false, free_parameters: false };

/// Checks that functions of prepared numbers have the results of the functions of parameters.
fn check_prepared_functions(
    name: &str,
    model: &Model<'_>,
    prepared: &PreparedFunctions,
    old: &DerivationOutput,
    tolerance: f64,
) {
    for seed in 0..3 {
        let at = random_symbol_values(model, seed);
        let numbers = prepared.numbers.interpret_program(&at);
        let symbol_value_with_prepared = |s| match Quantity::from_symbol(s) {
            Quantity::Prepared(k) => numbers[k],
            Quantity::Parameter(_) => f64::NAN,
            _ => at(s),
        };
        for (new, old) in prepared.functions.iter().zip(&old.functions) {
            let (a, b) = (
                new.program.interpret_program(&symbol_value_with_prepared),
                old.program.interpret_program(&at),
            );
            assert_near(&format!("{name}: {}, prepared", new.name), seed, tolerance, &a, &b);
        }
    }
}

fn check_passes_on_robot(name: &str, options: &str) {
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let arguments = format!("urdf = \"../models/urdf/{name}.urdf\"{options}");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let source =
        parse_source_and_import(parse_tokens(&arguments), parse_tokens("pub struct Robot;"), folder, &mut cx)
            .expect("it is read");
    let (model, old) = compile_with_passes(&source, &graph, OFF, &mut cx).expect("it compiles");
    for passes in CHOICES {
        let (_, new) = compile_with_passes(&source, &graph, passes, &mut cx).expect("it compiles");
        check_passes_preserve_results(name, &model, &new, &old, 1e-12);
    }
}

#[test]
fn model_passes_preserve_robot_dynamics() {
    for (name, options) in [
        ("cartpole", ""),
        ("double_pendulum", ""),
        ("ur5", ""),
        ("kinova", ""),
        ("panda", ""),
        ("panda", ", mimic = independent"),
        ("solo12", ", base = free, inertia = trust"),
        ("simple_humanoid", ", base = free, inertia = trust"),
    ] {
        check_passes_on_robot(name, options);
    }
}

/// Checks that every variant of a model with identical limbs has the model's functions when the limbs are
/// lanes. Forces between limbs may have different expressions in each limb; then no lanes exist.
fn check_limb_variants(model: &Model<'_>, interacts: bool, seed: u64) {
    const TOLERANCE: f64 = 1e-11;
    let at = random_symbol_values(model, seed);
    let joints = &kinematics::joints_of_model(model);
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let mass = eval(&crba::mass_matrix(model, joints).concat(), &at);
    let bias = eval(&rnea::inverse_dynamics(model, joints, &v, None), &at);
    let tau = eval(&rnea::inverse_dynamics(model, joints, &v, Some(&a)), &at);
    let expected = eval(&a, &at);
    let symbol_value_with_tau = |s| match Quantity::from_symbol(s) {
        Quantity::Force(k) => tau[k],
        _ => at(s),
    };
    let all = CHOICES.into_iter().flat_map(|passes| model_variants(model, passes)).collect::<Vec<_>>();
    for variant in all.iter().chain(&variants_in_common_axes(&all)) {
        let groups = find_limb_groups(&variant.model, &variant.joints);
        assert!(!groups.is_empty(), "the limbs are alike");
        let Some(limbs) = VectorisedMechanism::new(&variant.model, &variant.joints, &groups, || {
            passive_forces(&variant.model, true)
        }) else {
            // Limbs with numeric values always become lanes; expressions of parameters may have a different
            // structure in each limb.
            assert!(interacts || !model.parameters.is_empty(), "limbs become lanes");
            continue;
        };
        assert!(limbs.joints.len() < variant.joints.len());
        assert_near(
            "inverse dynamics",
            seed,
            TOLERANCE,
            &eval(&limb_lanes::inverse_dynamics(&limbs, true), &at),
            &tau,
        );
        assert_near("bias", seed, TOLERANCE, &eval(&limb_lanes::inverse_dynamics(&limbs, false), &at), &bias);
        if variant.for_inverse_dynamics {
            continue;
        }
        for most in [1, 4, 8] {
            let found = eval(&limb_lanes::mass_matrix(&limbs, most), &at);
            assert_near("mass matrix", seed, TOLERANCE, &found, &mass);
        }
        let found = limb_lanes::forward_dynamics(&limbs, &limbs).expect("no coordinate is coupled");
        assert_near(
            "forward dynamics",
            seed,
            100.0 * TOLERANCE,
            &eval(&found, &symbol_value_with_tau),
            &expected,
        );
        // The lowered program has the same results.
        let program = lower(&limb_lanes::inverse_dynamics(&limbs, true));
        assert_near("program", seed, TOLERANCE, &program.interpret_program(&at), &tau);
    }
}

proptest! {
    #![proptest_config(property_test_config(150))]

    #[test]
    fn identical_limbs_as_lanes_preserve_the_dynamics(creature in random_creatures(3), seed in 0_u64..1000) {
        let source = creature.creature_source();
        let interacts = source.1.contains(" between");
        // Models with an element between a limb and itself are rejected.
        let variants = check_model_or_return_errors(&source, |_, model| check_limb_variants(model,
            interacts, seed));
        let refused = variants.is_err();
        prop_assert!(!refused || interacts);
    }

    #[test]
    fn noisy_coefficients_cost_no_accuracy_in_passes(robot in random_robots(8), seed in 0_u64..1000) {
        check_model_or_panic(&robot.robot_source(), |_, model| check_accuracy_of_variants(model, seed));
    }
}

/// Checks that every variant of a model has the same functions up to rounding, and that no length of a
/// variant exceeds those of the model by more than a factor of 10.
fn check_accuracy_of_variants(model: &Model<'_>, seed: u64) {
    let at = random_symbol_values(model, seed);
    let joints = kinematics::joints_of_model(model);
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let mass = eval(&crba::mass_matrix(model, &joints).concat(), &at);
    let tau = eval(&rnea::inverse_dynamics(model, &joints, &v, Some(&a)), &at);
    let expected = eval(&a, &at);
    let symbol_value_with_tau = |s| match Quantity::from_symbol(s) {
        Quantity::Force(k) => tau[k],
        _ => at(s),
    };
    let force_symbol = |k: usize| Quantity::Force(k).expr(model.graph);
    let acceleration_error = |variant: &Model<'_>, joints: &[Joint<'_>]| -> f64 {
        let h = rnea::inverse_dynamics(variant, joints, &v, None);
        let rest = h.iter().enumerate().map(|(k, h)| force_symbol(k) - *h).collect();
        let found = eval(
            &ldl::solve_symmetric(crba::mass_matrix(variant, joints), rest, joints),
            &symbol_value_with_tau,
        );
        found.iter().zip(&expected).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    let (n, own) = (model.nv(), acceleration_error(model, &joints));
    let extent: f64 = characteristic_link_sizes(model).iter().sum();
    let all = CHOICES.into_iter().flat_map(|passes| model_variants(model, passes)).collect::<Vec<_>>();
    // Joints share common axes if they are parallel within the rounding of files.
    let common = variants_in_common_axes(&all);
    let both =
        all.iter().map(|variant| (variant, 1e-12)).chain(common.iter().map(|variant| (variant, 5e-12)));
    for (variant, tolerance) in both {
        for link in &variant.model.links {
            let place = link.placement.translation.constant_components().expect("they are numbers");
            assert!(place.iter().all(|c| c.abs() <= 10.0 * extent), "{place:?} of {extent} (seed {seed})");
        }
        let found = eval(&rnea::inverse_dynamics(&variant.model, &variant.joints, &v, Some(&a)), &at);
        assert_near("inverse dynamics", seed, tolerance, &found, &tau);
        if variant.for_inverse_dynamics {
            continue;
        }
        let found = eval(&crba::mass_matrix(&variant.model, &variant.joints).concat(), &at);
        for (k, (found, entry)) in found.iter().zip(&mass).enumerate() {
            let size = (mass[k / n * (n + 1)] * mass[k % n * (n + 1)]).sqrt();
            assert!((found - entry).abs() <= tolerance * size, "{found} and {entry} of {size} (seed {seed})");
        }
        // Light links on heavy ones lose digits, with and without the passes.
        let error = acceleration_error(&variant.model, &variant.joints);
        assert!(
            error <= 100.0 * tolerance + 1000.0 * own,
            "accelerations off by {error:e}, {own:e} without (seed {seed})"
        );
    }
}

proptest! {
    #![proptest_config(property_test_config(40))]

    #[test]
    fn passes_preserve_the_dynamics_of_all_forms(tree in random_trees(4), seed in 0_u64..1000) {
        check_model_or_panic(&tree.tree_source(), |_, model| check_variants(model, seed));
    }

    /// Robots of pins and sleeves, most of them parallel to the joint before.
    #[test]
    fn common_axes_of_parallel_joints_preserve_the_dynamics(
        joints in prop::collection::vec((0..3_usize, 0..4_usize, any::<bool>(), -1.0..1.0_f64), 2..6),
        seed in 0_u64..1000,
    ) {
        let mut fields = String::new();
        let mut axis = "z";
        for (k, (kind, turn, backwards, length)) in joints.iter().enumerate() {
            axis = ["x", "y", axis, axis][*turn];
            let parent = if k == 0 { "ground".to_string() } else { format!("b{}", k - 1) };
            let sign = if *backwards { "-" } else { "" };
            let (motion, joint) = match kind {
                0 => ("along", "Sleeve"),
                _ => ("about", "Pin"),
            };
            fields += &format!(
                "#[body(mass = 1.5, com = [0.1, {length}, 0.2], inertia = cuboid(1.5, 0.3, 0.2, \
                 0.1).rotated(x(0.4)))]
                 b{k}: Body,
                 #[joint(
                     {parent}.at([{length}, 0.3, 0.2]).rotated({axis}({length})) -> b{k},
                     {motion} = {sign}{axis}
                 )]
                 j{k}: {joint},"
            );
        }
        let item = format!("pub struct Arm {{ {fields} }}");
        check_model_or_panic(&("gravity = [1, 2, -9]".to_string(), item), |_, model| check_variants(model,
            seed));
    }

    #[test]
    fn program_passes_preserve_functions(tree in random_trees(6), seed in 0_u64..1000) {
        let _ = seed;
        check_model_or_panic(&tree.tree_source(), |_, model| {
            let mut cx = Diagnostics::new();
            let prepare = RequestedFunctions { prepare: true, ..RequestedFunctions::default() };
            let new = derive_with_options(model, prepare, PassSelection::default(), &mut cx);
            let old = derive_with_options(model, RequestedFunctions::default(), OFF, &mut cx);
            check_passes_preserve_results(
                "tree", model, &new.expect("it moves"), &old.expect("it moves"), 1e-8,
            );
        });
    }
}

/// No rotation is computed between links whose pins are parallel; constant rotations are merged. Links whose
/// axes are not parallel are unchanged.
#[test]
fn parallel_joints_need_no_rotations() {
    let arm_with_axes = |axes: [&str; 3]| {
        let [a, b, c] = axes;
        let body = "#[body(mass = 1.5, com = [0.1, 0.2, 0.3], inertia = cuboid(1.5, 0.3, 0.2, 0.1))]";
        format!(
            "pub struct Arm {{ {body} a: Body, #[joint(ground -> a, about = {a})] first: Pin,
             {body} b: Body, #[joint(a.at(0.4 * x) -> b, about = {b})] second: Pin,
             {body} c: Body, #[joint(b.at(0.4 * x) -> c, about = {c})] third: Pin }}"
        )
    };
    let rotating_joints_in_common_axes = |axes| {
        let mut turning = Vec::new();
        check_model_or_panic(&(String::new(), arm_with_axes(axes)), |_, model| {
            let variant =
                variants_in_common_axes(&model_variants(model, PassSelection::default())).into_iter().next();
            let Some(variant) = variant else { return };
            turning = variant
                .joints
                .iter()
                .map(|joint| joint.rotation.rotation_matrix().entries_if_all_constant().is_none())
                .collect();
        });
        turning
    };
    assert_eq!(rotating_joints_in_common_axes(["z", "z", "z"]), [false, false, false]);
    assert_eq!(rotating_joints_in_common_axes(["z", "y", "-y"]), [true, false, false]);
    // The third joint rotates relative to the axes that the first two share.
    assert_eq!(rotating_joints_in_common_axes(["z", "z", "x"]), [false, false, true]);
    assert_eq!(rotating_joints_in_common_axes(["z", "y", "z"]), [false; 0]);
}

/// Checks that nearly zero lengths between axes, as exporters write them, are not multiplied by large masses
/// and lose no digits. Nearly parallel axes must not place a frame far away.
#[test]
fn nearly_zero_lengths_cost_no_accuracy() {
    let mut fields = String::new();
    for k in 0..6 {
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}", k - 1) };
        let arm = ["[3e-13, 0, 0.2]", "[0, 2e-11, 0.1]", "[1e-9, 0.3, 0]"][k % 3];
        let tilt = [0.0, 3.7e-6, 1e-9][k % 3];
        fields += &format!(
            "#[body(mass = 3, com = [0.1, 0.02, -0.05], inertia = cuboid(3, 0.3, 0.2, 0.1))] b{k}: Body,
             #[joint({parent}.at({arm}).rotated(x({tilt:e})) -> b{k}, about = {})] j{k}: Pin,",
            ["z", "z", "x"][k % 3]
        );
    }
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let item = format!("pub struct Robot {{ {fields} }}");
    let source = parse_source_and_import(
        parse_tokens("gravity = -9.81 * y"),
        parse_tokens(&item),
        Path::new(""),
        &mut cx,
    )
    .expect("it is read");
    let (model, old) = compile_with_passes(&source, &graph, OFF, &mut cx).expect("it compiles");
    for passes in CHOICES {
        let (_, new) = compile_with_passes(&source, &graph, passes, &mut cx).expect("it compiles");
        check_passes_preserve_results("next to zero", &model, &new, &old, 1e-11);
    }
}
