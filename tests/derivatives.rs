//! First derivatives of the dynamics against reference values and against symbolic differentiation of the
//! equations, and their numbers of operations.

mod free_bodies;
mod random_limbs;
mod random_tree;
mod random_world;

use linkwork::mechanism;
use linkwork::nalgebra::SMatrix;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::eval::eval;
use linkwork_compiler::expr::{Expr, Graph};
use linkwork_compiler::kinematics;
use linkwork_compiler::lower::{Op, Program, lower};
use linkwork_compiler::mechanics::derivatives::{
    self, DerivationMethod, TrunkLimbPartition, analytic, invariance, symbolic,
};
use linkwork_compiler::mechanics::{self, crba, ldl, rnea};
use linkwork_compiler::mechanism::{Chart, Model, Quantity};
use linkwork_compiler::{compile, parse_source_and_import};
use proptest::prelude::*;
use random_limbs::random_creatures;
use random_tree::{random_trees, random_trees_with_elements};
use random_world::random_element_mechanisms;
use std::path::Path;
use support::compare::assert_close_relative_to_largest;
use support::model::{check_model_or_panic, check_model_or_return_errors, random_symbol_values};
use support::random::property_test_config;
use support::table::Record;

/// Tolerance relative to the largest entry of a reference value.
const REFERENCE: f64 = 1e-9;
/// Tolerance between two derivations of the same quantity.
const DERIVATION: f64 = 1e-10;

// ---- Robots against
// Pinocchio ------------------------------------------------------------------------------------

macro_rules! robot {
    ($robot:ident, $test:ident, $name:literal, $($options:tt)*) => {
        #[mechanism(urdf = $name, derivatives, packed $($options)*)]
        struct $robot;

        #[test]
        fn $test() {
            let name = $name.trim_start_matches("../models/urdf/").trim_end_matches(".urdf");
            let mut cases = 0;
            type Square = SMatrix<f64, { $robot::NV }, { $robot::NV }>;
            // The same matrices are passed to each call: entries that are always zero are never written.
            let (mut forces, mut motion) = ([Square::zeros(); 2], [Square::zeros(); 3]);
            for (i, case) in Record::load(&format!("robots/{name}.json")).records_with_key("cases").iter().enumerate() {
                if !case.has_key("Minv") {
                    continue;
                }
                cases += 1;
                let label_of_case = |what: &str| format!("{name}, case {i}: {what}");
                let (q, v, a, tau) = (&case.vector_with_key("q"), &case.vector_with_key("v"), &case.vector_with_key("a"), &case.vector_with_key("tau"));
                let assert_close_to_reference = |what: &str, actual: &[f64], expected: &[f64]| {
                    assert_close_relative_to_largest(&label_of_case(what), actual, expected, REFERENCE);
                };
                let expected_matrix = |key: &str| -> Square { case.matrix_with_key(key) };
                let (by_q, by_v) = $robot.inverse_dynamics_derivatives(q, v, a);
                assert_close_to_reference("∂τ/∂q", by_q.as_slice(), expected_matrix("dtau_dq").as_slice());
                assert_close_to_reference("∂τ/∂v", by_v.as_slice(), expected_matrix("dtau_dv").as_slice());
                let [given_q, given_v] = &mut forces;
                $robot.inverse_dynamics_derivatives_into(q, v, a, given_q, given_v);
                assert!(forces == [by_q, by_v], "{}", label_of_case("∂τ into matrices"));
                let (by_q, by_v, inverse) = $robot.forward_dynamics_derivatives(q, v, tau);
                let [given_q, given_v, given] = &mut motion;
                let a = $robot.forward_dynamics_derivatives_into(q, v, tau, given_q, given_v, given);
                let expected = $robot.forward_dynamics(q, v, tau);
                assert_close_to_reference("v̇ with its derivatives", a.as_slice(), expected.as_slice());
                assert!(motion == [by_q, by_v, inverse], "{}", label_of_case("∂v̇ into matrices"));
                assert_close_to_reference("∂v̇/∂q", by_q.as_slice(), expected_matrix("dddq_dq").as_slice());
                assert_close_to_reference("∂v̇/∂v", by_v.as_slice(), expected_matrix("dddq_dv").as_slice());
                let expected: Square = case.symmetric_matrix_with_key("Minv");
                assert_close_to_reference("M⁻¹ of forward dynamics", inverse.as_slice(), expected.as_slice());
                let found = $robot.mass_matrix_inverse(q);
                assert_close_to_reference("M⁻¹", found.as_slice(), expected.as_slice());
            }
            assert_eq!(cases, 2);
        }
    };
}

robot!(CartPole, cartpole, "../models/urdf/cartpole.urdf",);
robot!(DoublePendulum, double_pendulum, "../models/urdf/double_pendulum.urdf",);
robot!(Ur5, ur5, "../models/urdf/ur5.urdf",);
robot!(Kinova, kinova, "../models/urdf/kinova.urdf",);
robot!(Gen3, gen3, "../models/urdf/gen3.urdf",);
robot!(Panda, panda, "../models/urdf/panda.urdf", , mimic = independent);
robot!(Solo12, solo12, "../models/urdf/solo12.urdf", , base = free);
robot!(Humanoid, simple_humanoid, "../models/urdf/simple_humanoid.urdf", , base = free);
robot!(G1, g1, "../models/urdf/g1.urdf", , base = free);

// ---- Two
// derivations ---------------------------------------------------------------------------------------------

fn assert_same_expressions(what: &str, model: &Model<'_>, seed: u64, a: &[Expr<'_>], b: &[Expr<'_>]) {
    let at = random_symbol_values(model, seed);
    assert_close_relative_to_largest(what, &eval(a, &at), &eval(b, &at), DERIVATION);
}

fn check_recursive_derivatives(model: &Model<'_>, seed: u64) {
    let joints = kinematics::joints_of_model(model);
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let tau = rnea::inverse_dynamics(model, &joints, &v, Some(&a));
    let expected = symbolic::configuration_and_velocity_derivatives(model, &tau);
    for lanes in [1, 2, 4, 8] {
        let found = derivatives::inverse_dynamics(model, &joints, &a, DerivationMethod::Recursion(lanes));
        assert_same_expressions("∂τ/∂q", model, seed, &found.by_q.concat(), &expected.by_q.concat());
        assert_same_expressions("∂τ/∂v", model, seed, &found.by_v.concat(), &expected.by_v.concat());
        let at = random_symbol_values(model, seed);
        let program = lower(&found.by_q.concat());
        assert_close_relative_to_largest(
            "program of ∂τ/∂q",
            &program.interpret_program(&at),
            &eval(&expected.by_q.concat(), &at),
            DERIVATION,
        );
    }
}

/// Checks that `C v` equals the terms of the bias forces that depend on the links' velocities, and that
/// `Ṁ = C + Cᵀ`.
fn check_coriolis_matrix<'g>(model: &Model<'g>, seed: u64, lanes: usize) {
    let joints = kinematics::joints_of_model(model);
    let v = mechanics::velocity_symbols(model);
    let still = vec![model.graph.zero(); model.nv()];
    let c = analytic::coriolis_matrix(model, &joints, &v, lanes);
    let bias_forces_at = |v: &[Expr<'g>]| rnea::inverse_dynamics(model, &joints, v, None);
    let (moving, resting) = (bias_forces_at(&v), bias_forces_at(&still));
    let zero = model.graph.zero();
    let product: Vec<Expr<'_>> =
        c.iter().map(|row| row.iter().zip(&v).fold(zero, |sum, (c, v)| sum + *c * *v)).collect();
    let expected: Vec<Expr<'_>> = moving.iter().zip(&resting).map(|(m, r)| *m - *r).collect();
    assert_same_expressions("C v", model, seed, &product, &expected);
    let mass = crba::mass_matrix(model, &joints).concat();
    let rate: Vec<Expr<'_>> =
        mass.iter().map(|m| kinematics::time_derivative(model.configuration_space(), *m)).collect();
    let n = model.nv();
    let sum: Vec<Expr<'_>> = (0..n * n).map(|k| c[k / n][k % n] + c[k % n][k / n]).collect();
    assert_same_expressions("Ṁ", model, seed, &sum, &rate);
}

fn check_mass_matrix_inverse<'g>(model: &Model<'g>, seed: u64) {
    let joints = kinematics::joints_of_model(model);
    let mass = crba::mass_matrix(model, &joints);
    let factor = derivatives::MatrixFactorisation::new(&mass, &joints);
    let a = mechanics::acceleration_symbols(model);
    let matrix_times_vector = |m: &crba::Matrix<'g>, x: &[Expr<'g>]| -> Vec<Expr<'g>> {
        let zero = model.graph.zero();
        m.iter().map(|row| row.iter().zip(x).fold(zero, |sum, (m, x)| sum + *m * *x)).collect()
    };
    let forces = matrix_times_vector(&mass, &a);
    assert_same_expressions("inverse", model, seed, &matrix_times_vector(&factor.inverse(), &forces), &a);
    assert_same_expressions("solution", model, seed, &factor.solve_factored(forces.clone()), &a);
    let trunk = TrunkLimbPartition::new(
        &joints,
        &mass,
        &TrunkLimbPartition::branching_descendant_flags(&joints, model.nv()),
    );
    let Some(trunk) = trunk else { return };
    let parts = derivatives::BlockInverseMassMatrix::new(&mass, &trunk);
    assert_same_expressions("solution in parts", model, seed, &parts.solve_by_trunk_and_limbs(&forces), &a);
    let (mut whole, factors) = (parts.trunk_and_limb_inverse_columns(), parts.limb_to_trunk_factors());
    for row in &mut whole {
        let columns: Vec<Expr<'_>> = trunk.velocities.iter().map(|t| row[*t]).collect();
        for (entry, factors) in row.iter_mut().zip(&factors) {
            *entry = columns.iter().zip(factors).fold(*entry, |sum, (h, g)| sum + *h * *g);
        }
    }
    assert_same_expressions("inverse in parts", model, seed, &whole.concat(), &factor.inverse().concat());
}

/// Checks that the derivatives of the acceleration of a free base that follow from invariance solve the
/// differentiated equations of motion. Returns the indices of these columns, by `q` and by `v`.
fn check_invariant_columns(model: &Model<'_>, seed: u64) -> [Vec<usize>; 2] {
    let joints = kinematics::joints_of_model(model);
    let mass = crba::mass_matrix(model, &joints);
    let a = mechanics::acceleration_symbols(model);
    let tau = rnea::inverse_dynamics(model, &joints, &mechanics::velocity_symbols(model), Some(&a));
    let forces = symbolic::configuration_and_velocity_derivatives(model, &tau);
    let known = invariance::columns_determined_by_invariance(model, &joints);
    for (forces, columns) in [(&forces.by_q, &known.by_q), (&forces.by_v, &known.by_v)] {
        for (k, column) in columns {
            let inertia = mass
                .iter()
                .map(|row| row.iter().zip(column).fold(model.graph.zero(), |sum, (m, x)| sum - *m * *x));
            let found: Vec<Expr<'_>> = inertia.collect();
            let expected: Vec<Expr<'_>> = forces.iter().map(|row| row[*k]).collect();
            assert_same_expressions("forces on a free base", model, seed, &found, &expected);
        }
    }
    known.invariant_column_indices()
}

/// Returns the configuration after a step of size `h` along velocity `k`, correct to second order in `h`.
fn displaced_configuration(model: &Model<'_>, q: &[f64], k: usize, h: f64) -> Vec<f64> {
    let symbol_value_at_unit_velocity = |s| match Quantity::from_symbol(s) {
        Quantity::Configuration(i) => q[i],
        Quantity::Velocity(i) => f64::from(u8::from(i == k)),
        _ => 0.0,
    };
    let rates: Vec<Expr<'_>> =
        (0..model.nq()).map(|i| kinematics::configuration_rate(model.configuration_space(), i)).collect();
    let mut moved: Vec<f64> =
        q.iter().zip(eval(&rates, &symbol_value_at_unit_velocity)).map(|(q, rate)| q + h * rate).collect();
    for first in model.charts.iter().filter_map(Chart::first_quaternion_index) {
        let length = moved[first.range_of_entries(4)].iter().map(|c| c * c).sum::<f64>().sqrt();
        moved[first.range_of_entries(4)].iter_mut().for_each(|c| *c /= length);
    }
    moved
}

/// Compares the derivatives of forward dynamics with central differences. Columns that follow from invariance
/// are replaced by their known values. Returns the largest deviation relative to the largest derivative, and
/// the number of known columns.
fn deviation_from_differences(model: &Model<'_>, seed: u64) -> (f64, usize) {
    const STEP: f64 = 1e-5;
    let joints = kinematics::joints_of_model(model);
    let mass = crba::mass_matrix(model, &joints);
    let tau: Vec<Expr<'_>> = (0..model.nv()).map(|k| Quantity::Force(k).expr(model.graph)).collect();
    let bias = rnea::inverse_dynamics(model, &joints, &mechanics::velocity_symbols(model), None);
    let rest: Vec<Expr<'_>> = tau.iter().zip(&bias).map(|(t, h)| *t - *h).collect();
    let motion = ldl::solve_symmetric(mass.clone(), rest, &joints);
    let mut found =
        derivatives::linearize_forward_dynamics(model, &joints, &mass, &tau, DerivationMethod::Recursion(1));
    let known = invariance::columns_determined_by_invariance(model, &joints);
    known.insert_invariant_columns(&mut found.forces);
    let at = random_symbol_values(model, seed);
    let q: Vec<f64> = (0..model.nq()).map(|k| at(Quantity::Configuration(k).symbol())).collect();
    let n = model.nv();
    let inverse = eval(&found.inverse.concat(), &at);
    let (mut worst, mut scale) = (0.0_f64, 1.0_f64);
    let largest_error = |forces: &crba::Matrix<'_>, known: &[usize], by_q: bool| {
        let forces = eval(&forces.concat(), &at);
        let mut worst = (0.0_f64, 1.0_f64);
        for k in 0..n {
            let column: Vec<f64> = (0..n).map(|i| forces[i * n + k]).collect();
            let negated_product_row = |i: usize| -(0..n).map(|j| inverse[i * n + j] * column[j]).sum::<f64>();
            let column: Vec<f64> =
                if known.contains(&k) { column } else { (0..n).map(negated_product_row).collect() };
            let motion_at_displacement = |h: f64| {
                let q = if by_q { displaced_configuration(model, &q, k, h) } else { q.clone() };
                let displaced_symbol_value = |s| match Quantity::from_symbol(s) {
                    Quantity::Configuration(i) => q[i],
                    Quantity::Velocity(i) if i == k && !by_q => at(s) + h,
                    _ => at(s),
                };
                eval(&motion, &displaced_symbol_value)
            };
            for ((found, after), before) in
                column.iter().zip(motion_at_displacement(STEP)).zip(motion_at_displacement(-STEP))
            {
                let error = (found - (after - before) / (2.0 * STEP)).abs();
                worst = (worst.0.max(error), worst.1.max(found.abs()));
            }
        }
        worst
    };
    let [by_q, by_v] = known.invariant_column_indices();
    for (error, size) in
        [largest_error(&found.forces.by_q, &by_q, true), largest_error(&found.forces.by_v, &by_v, false)]
    {
        (worst, scale) = (worst.max(error), scale.max(size));
    }
    (worst / scale, by_q.len() + by_v.len())
}

#[test]
fn derivatives_include_forces_from_the_ground() {
    let columns_determined_by_invariance = |element: &str| {
        let mut found = None;
        let fields = format!(
            "#[body(mass = 2, inertia = diagonal(1, 2, 3))] hull: Body, #[joint(ground -> hull)] pose: Free,
             #[body(mass = 1, com = x)] arm: Body, #[joint(hull.at(y) -> arm, about = z)] elbow: Pin, \
                 {element}"
        );
        let source = ("gravity = -9.81 * z".to_string(), format!("struct Boat {{ {fields} }}"));
        check_model_or_panic(&source, |_, model| found = Some(check_invariant_columns(model, 3)));
        found.expect("it compiles")
    };
    let (all, none) = (|| [vec![3, 4, 5], vec![0, 1, 2]], Vec::new);
    assert_eq!(columns_determined_by_invariance(""), all());
    assert_eq!(
        columns_determined_by_invariance(
            "#[acts(on = elbow, stiffness = 3, free_angle = 1)] spring: Spring,"
        ),
        all()
    );
    assert_eq!(
        columns_determined_by_invariance(
            "#[acts(between = (hull, arm.at(z)), damping = 3)] inside: Dashpot,"
        ),
        all()
    );
    let spring = "#[acts(between = (ground.at(3 * x), arm.at(z)), stiffness = 3)] mooring: Spring,";
    assert_eq!(columns_determined_by_invariance(spring), [none(), vec![0, 1, 2]]);
    let dashpot = "#[acts(between = (ground.at(3 * x), arm.at(z)), damping = 3)] mooring: Dashpot,";
    assert_eq!(columns_determined_by_invariance(dashpot), [none(), none()]);
    // Invariance does not hold for an inerter between bodies, which has inertia but no weight, nor for a load
    // that moves along an axis of the ground.
    let inerter = "#[acts(between = (ground.at(3 * x), arm.at(z)), inertance = 3)] mooring: Inerter,";
    assert_eq!(columns_determined_by_invariance(inerter), [none(), none()]);
    assert_eq!(
        columns_determined_by_invariance("#[acts(on = elbow, inertance = 3)] inside: Inerter,"),
        all()
    );
    let other =
        "#[body(mass = 2, inertia = diagonal(1, 2, 3))] ship: Body, #[joint(ground -> ship)] course: Free,";
    let inerter = "#[acts(between = (ship.at(x), arm.at(z)), inertance = 3)] towing: Inerter,";
    assert_eq!(columns_determined_by_invariance(other), [vec![3, 4, 5, 10, 11, 12], vec![0, 1, 2, 7, 8, 9]]);
    assert_eq!(columns_determined_by_invariance(&format!("{other} {inerter}")), [none(), none()]);
    let particle_declaration = |axis: &str| {
        format!(
            "way: Coordinate, #[particle(mass = 1, at = hull.at(way * {axis} + 0.3 * y))] load: Particle,"
        )
    };
    assert_eq!(columns_determined_by_invariance(&particle_declaration("ground.x")), [none(), none()]);
    assert_eq!(columns_determined_by_invariance(&particle_declaration("x")), all());
}

proptest! {
    #![proptest_config(property_test_config(80))]

    #[test]
    fn recursive_and_symbolic_derivatives_agree(tree in random_trees(4), seed in 0_u64..1000) {
        check_model_or_panic(&tree.tree_source(), |_, model| {
            check_recursive_derivatives(model, seed);
            for lanes in [1, 4, 8] {
                check_coriolis_matrix(model, seed, lanes);
            }
            check_mass_matrix_inverse(model, seed);
            check_invariant_columns(model, seed);
        });
    }
}

proptest! {
    #![proptest_config(property_test_config(120))]

    /// Checks derivatives against finite differences on random mechanisms, in which elements of every kind
    /// act on free and on jointed bodies, and on the ground.
    #[test]
    fn derivatives_agree_with_finite_differences(
        (tree, world, creature) in (random_trees_with_elements(4), random_element_mechanisms(),
            random_creatures(2)),
        which in 0..6_usize,
        seed in 0_u64..1000,
    ) {
        let source = match which {
            0 => world.element_mechanism_source(),
            1 => creature.creature_source(),
            _ => tree.tree_source(),
        };
        let check_derivatives_of_model = |model: &Model<'_>| {
            if model.constraints.is_empty() {
                let (deviation, known) = deviation_from_differences(model, seed);
                assert!(deviation < 1e-6, "{deviation:e}, {known} columns are known (seed {seed})\n{}", source.1);
            }
        };
        // Mechanisms with an element between a body and itself, or with an element that moves nothing, are
        // rejected.
        let _ = check_model_or_return_errors(&source, |_, model| check_derivatives_of_model(model));
    }
}

// ---- Operations ----------------------------------------------------------------------------------------

/// Returns the numbers of operations of the derivatives of inverse dynamics, and of the inverse of the mass
/// matrix.
fn operation_totals(arguments: &str) -> [usize; 2] {
    derivative_programs(arguments).map(|program| program.counts.total_operations())
}

fn derivative_programs(arguments: &str) -> [Program; 2] {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let source =
        parse_source_and_import(parse_tokens(arguments), parse_tokens("struct Robot;"), folder, &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.full_message_texts().join("\n"));
    };
    ["inverse_dynamics_derivatives", "mass_matrix_inverse"].map(|name| {
        let f = output.functions.iter().find(|f| f.name == name).expect("the function is generated");
        f.program.clone()
    })
}

/// Numbers of operations with identical limbs as lanes. The first number counts multiplications, additions
/// and divisions, each of which acts on all lanes at once. The second counts the instructions that remain
/// after products are fused into sums.
#[test]
fn operation_counts_of_limb_lanes_are_exact() {
    let operation_counts_of_robot = |robot: &str| {
        let all =
            derivative_programs(&format!("urdf = \"../models/urdf/{robot}.urdf\", base = free, derivatives"));
        all.map(|program| {
            let program = program.simd.expect("its limbs are alike");
            let fused = program
                .instructions
                .iter()
                .filter(|op| !matches!(op, Op::Lane(..) | Op::Join(..) | Op::Call(..)));
            (program.counts.total_operations(), fused.count())
        })
    };
    // Each row has the derivatives of inverse dynamics, then the inverse of the mass matrix.
    let expected = [[(1303, 845), (794, 497)], [(6108, 4115), (6301, 3682)]];
    assert_eq!(["solo12", "simple_humanoid"].map(operation_counts_of_robot), expected);
}

#[test]
fn operation_counts_of_derivatives_are_exact() {
    let fingers = "lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]";
    let free = "base = free";
    for (robot, options, most) in [
        ("cartpole", "base = fixed", [24, 20]),
        ("ur5", "base = fixed", [800, 260]),
        ("panda", fingers, [2800, 700]),
        ("panda", "mimic = independent", [3600, 970]),
        ("kinova", "base = fixed", [3000, 730]),
        ("solo12", free, [4800, 2460]),
        ("simple_humanoid", free, [17_500, 11_700]),
    ] {
        let found =
            operation_totals(&format!("urdf = \"../models/urdf/{robot}.urdf\", {options}, derivatives"));
        println!("{robot}, {options}: {found:?}");
        assert!(found[0] <= most[0] && found[1] <= most[1], "{robot}: {found:?}, expected at most {most:?}");
    }
}
