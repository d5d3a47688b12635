//! C code of `linkwork export c`, compiled by the system's C compiler and compared with the same functions in
//! Rust.

mod casadi;
mod compiled;
mod kernels;
#[path = "../mechanisms/mod.rs"]
mod mechanisms;

use compiled::{
    CallWithExpectedResults, ExportedMechanismCase, available_c_compilers, c_test_program,
    check_exported_code, compare_results, compile_and_run, export_c_code, test_folder,
};
use linkwork::prelude::*;
use linkwork::{Frames, discrete};
use linkwork_models::{AnymalB, CartPole, FourBar, FurutaPendulum, PandaArm, SimpleHumanoid, Solo12, Ur5};
use mechanisms::{Balloon, MechanismWithReservedNames, Wing};

fn deterministic_numbers(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|k| (seed + 1.7 * k as f64).sin()).collect()
}

/// Expands to calls of the functions that every mechanism has.
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

/// Expands to calls of the functions that tree mechanisms have.
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
        CallWithExpectedResults {
            name: $name,
            arguments: $arguments,
            results: vec![$($value.as_slice().to_vec()),+],
            returned: false,
        }
    };
}

macro_rules! scalar {
    ($name:literal, $arguments:literal, $value:expr) => {
        CallWithExpectedResults {
            name: $name,
            arguments: $arguments,
            results: vec![vec![$value]],
            returned: true,
        }
    };
}

/// Expands to a test case: a mechanism with its values at one state.
macro_rules! case {
    ($prefix:literal, $kind:ident, $m:expr, [$($p:expr),*], time($($t:ident = $time:expr)?), $functions:ident) => {{
        let m = &$m;
        $(let $t: f64 = $time;)?
        let sample_numbers = |n: usize, seed: f64| deterministic_numbers(n, seed);
        let displacement = vector_from_slice::<{ $kind::NV }>(&sample_numbers($kind::NV, 0.3));
        let q = m.integrate(&m.neutral(), &displacement);
        let v = vector_from_slice::<{ $kind::NV }>(&sample_numbers($kind::NV, 1.1));
        let a = vector_from_slice::<{ $kind::NV }>(&sample_numbers($kind::NV, 2.2));
        let tau = vector_from_slice::<{ $kind::NV }>(&sample_numbers($kind::NV, 0.7)) * 10.0;
        let u = vector_from_slice::<{ $kind::NU }>(&sample_numbers($kind::NU, 0.9));
        let moved = m.integrate(&q, &a);
        let mut entries = functions!(m($($t)?), q, v, a, tau);
        entries.extend($functions!(m($($t)?), q, v, a, tau, u));
        let time: Option<f64> = [$($t)?].first().copied();
        entries.extend(first_and_last_frame_calls(m, time, q, v, a));
        let _ = (&u, &tau);
        ExportedMechanismCase {
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

/// Returns the derivative of the end state of a step with respect to the step size, by central differences of
/// order six.
fn derivative_by_step_size<const NQ: usize, const NV: usize>(
    end: impl Fn(f64) -> (SVector<f64, NQ>, SVector<f64, NV>),
    difference: impl Fn(&SVector<f64, NQ>, &SVector<f64, NQ>) -> SVector<f64, NV>,
) -> Vec<f64> {
    let d = 1e-4;
    let (start, _) = end(0.0);
    let change_of_end_state = |x: f64| {
        let (q, v) = end(x);
        [difference(&start, &q).as_slice(), v.as_slice()].concat()
    };
    let sides: Vec<[Vec<f64>; 2]> =
        [1.0, 2.0, 3.0].iter().map(|k| [change_of_end_state(k * d), change_of_end_state(-k * d)]).collect();
    let central_difference_of_entry = |i: usize| {
        let weighted_difference = |k: usize, weight: f64| weight * (sides[k][0][i] - sides[k][1][i]);
        (weighted_difference(0, 45.0) + weighted_difference(1, -9.0) + weighted_difference(2, 1.0))
            / (60.0 * d)
    };
    (0..2 * NV).map(central_difference_of_entry).collect()
}

/// Expands to calls of discrete steps and of their Jacobians.
macro_rules! steps {
    ($kind:ident, $m:expr, $case:ident) => {{
        const NX: usize = 2 * $kind::NV;
        let (m, state) = (&$m, &$case.given);
        let t = $case.time.unwrap_or(0.0);
        let (q, v, u) =
            (vector_from_slice(&state[0].1), vector_from_slice(&state[1].1), vector_from_slice(&state[4].1));
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
                    let state_after_step =
                        |x: f64| discrete::step(m, &$method::step(0.01 + x), t, &q, &v, &u).expect("a step");
                    all.results.push(derivative_by_step_size(state_after_step, |a, b| m.difference(a, b)));
                }
                entries.push(all);
            }};
        }
        by!(SemiImplicitEuler, "semi_implicit_euler_step", "semi_implicit_euler_transition");
        by!(Rk4, "rk4_step", "rk4_transition");
        entries
    }};
}

/// Calls of products of a row vector with the Jacobians of inverse and forward dynamics.
macro_rules! products {
    ($kind:ident, $m:expr, $case:ident $(, $t:expr)?) => {{
        let (m, state) = (&$m, &$case.given);
        let (q, v) = (vector_from_slice(&state[0].1), vector_from_slice(&state[1].1));
        let (a, tau) = (vector_from_slice(&state[2].1), vector_from_slice(&state[3].1));
        let w: SVector<f64, { $kind::NV }> = a;
        let (by_q, by_v) = m.inverse_dynamics_derivatives($($t,)? &q, &v, &a);
        let by_a = m.mass_matrix($($t,)? &q);
        let (a_by_q, a_by_v, by_tau) = m.forward_dynamics_derivatives($($t,)? &q, &v, &tau);
        [
            entry!(
                "inverse_dynamics_vjp",
                "q, v, a, a",
                by_q.transpose() * w,
                by_v.transpose() * w,
                by_a.transpose() * w
            ),
            entry!(
                "forward_dynamics_vjp",
                "q, v, tau, a",
                a_by_q.transpose() * w,
                a_by_v.transpose() * w,
                by_tau.transpose() * w
            ),
        ]
    }};
}

macro_rules! nothing {
    ($($t:tt)*) => {
        Vec::new()
    };
}

fn vector_from_slice<const N: usize>(numbers: &[f64]) -> linkwork::nalgebra::SVector<f64, N> {
    linkwork::nalgebra::SVector::from_fn(|k, _| numbers[k])
}

/// Returns the calls of the functions of frames for the first and the last frame, with the results of Rust.
fn first_and_last_frame_calls<M, const NQ: usize, const NV: usize>(
    m: &M,
    time: Option<f64>,
    q: linkwork::nalgebra::SVector<f64, NQ>,
    v: linkwork::nalgebra::SVector<f64, NV>,
    a: linkwork::nalgebra::SVector<f64, NV>,
) -> Vec<CallWithExpectedResults>
where
    M: Frames<NQ, NV, Scalar = f64>,
{
    let (t, last) = (time.unwrap_or(0.0), M::FRAMES.len() - 1);
    let frame_placement = |frame| {
        let x = m.placement_of(frame, t, &q).expect("there is such a frame");
        [x.rotation.matrix().as_slice(), x.translation.vector.as_slice()].concat()
    };
    let single_result_entry = |name, arguments, result| CallWithExpectedResults {
        name,
        arguments,
        results: vec![result],
        returned: false,
    };
    let some = "there is such a frame";
    vec![
        single_result_entry("frame_placement 0", "q", frame_placement(0)),
        single_result_entry("frame_placement last", "q", frame_placement(last)),
        single_result_entry(
            "frame_velocity last",
            "q, v",
            m.velocity_of(last, t, &q, &v).expect(some).as_slice().to_vec(),
        ),
        single_result_entry(
            "frame_acceleration last",
            "q, v, a",
            m.acceleration_of(last, t, &q, &v, &a).expect(some).as_slice().to_vec(),
        ),
        single_result_entry(
            "frame_jacobian last",
            "q",
            m.jacobian_of(last, t, &q).expect(some).as_slice().to_vec(),
        ),
    ]
}

#[test]
fn c_code_of_arms_agrees_with_rust() {
    let mut case = case!("arm", Ur5, Ur5, [], time(), of_trees);
    case.entries.extend(steps!(Ur5, Ur5, case));
    check_exported_code(&case, &["../../models/urdf/ur5.urdf"]);
    let case = case!("panda_arm", PandaArm, PandaArm, [], time(), of_trees);
    check_exported_code(&case, &["../../models/src/arm7.rs", "--struct", "PandaArm"]);
}

/// Compares the kernels of mechanisms with plain and curved configuration spaces, parameters and time.
#[test]
fn cuda_kernels_of_trees_agree_with_rust() {
    let mut case = case!("arm", Ur5, Ur5, [], time(), of_trees);
    case.entries.extend(steps!(Ur5, Ur5, case));
    case.entries.extend(products!(Ur5, Ur5, case));
    kernels::check_exported_kernels(&case, "double", &["../../models/urdf/ur5.urdf"]);
    case.tolerance = 2e-3;
    kernels::check_exported_kernels(&case, "float", &["../../models/urdf/ur5.urdf"]);
    let mut case = case!("solo12", Solo12, Solo12, [], time(), of_trees);
    case.entries.extend(products!(Solo12, Solo12, case));
    kernels::check_exported_kernels(
        &case,
        "double",
        &["../../models/urdf/solo12.urdf", "--with", "base = free"],
    );
    let m = Balloon { mass: 3.0, buoyancy: 2.5 };
    let mut case = case!("balloon", Balloon, m, [3.0, 2.5], time(t = 0.7), of_trees);
    case.entries.extend(steps!(Balloon, m, case));
    case.entries.extend(products!(Balloon, m, case, 0.7));
    kernels::check_exported_kernels(&case, "double", &["tests/mechanisms/mod.rs", "--struct", "Balloon"]);
    let m = MechanismWithReservedNames { int: 1.2, class: 0.3, r#type: 0.8, NAN: 4.0 };
    let mut case = case!("awkward", MechanismWithReservedNames, m, [1.2, 0.3, 0.8, 4.0], time(), of_trees);
    case.entries.extend(products!(MechanismWithReservedNames, m, case));
    kernels::check_exported_kernels(
        &case,
        "double",
        &["tests/mechanisms/mod.rs", "--struct", "MechanismWithReservedNames"],
    );
    let ([drag], [lift], [moment]) = wing_tables(true, true);
    let m = Wing { mass: 2.0, lift, drag, moment };
    let mut case = case!("wing", Wing, m, [2.0], time(), of_trees);
    case.tables = [ARRAYS, TABLES[3]];
    kernels::check_exported_kernels(&case, "double", &["tests/mechanisms/mod.rs", "--struct", "Wing"]);
}

#[test]
fn c_code_of_quadrupeds_agrees_with_rust() {
    let mut case = case!("solo12", Solo12, Solo12, [], time(), of_trees);
    case.entries.extend(steps!(Solo12, Solo12, case));
    check_exported_code(&case, &["../../models/urdf/solo12.urdf", "--with", "base = free"]);
    let case = case!("anymal", AnymalB, AnymalB, [], time(), of_trees);
    check_exported_code(&case, &["../../models/src/quadruped.rs", "--struct", "AnymalB"]);
}

#[test]
fn c_code_of_a_humanoid_agrees_with_rust() {
    let case = case!("humanoid", SimpleHumanoid, SimpleHumanoid, [], time(), of_trees);
    check_exported_code(
        &ExportedMechanismCase { tolerance: 1e-9, ..case },
        &["../../models/src/humanoid.rs"],
    );
}

#[test]
fn c_code_of_declared_mechanisms_agrees_with_rust() {
    let m = CartPole { cart_mass: 1.2, pole_mass: 0.3, pole_length: 0.8, rail_damping: 0.4 };
    let mut case = case!("cart_pole", CartPole, m, [1.2, 0.3, 0.8, 0.4], time(), of_trees);
    case.entries.extend(steps!(CartPole, m, case));
    check_exported_code(&case, &["../../models/src/cart_pole.rs"]);
    let m = FurutaPendulum { g: 9.8, arm_mass: 0.7, arm_length: 0.5, mass: 0.3, length: 0.9 };
    let case = case!("furuta", FurutaPendulum, m, [9.8, 0.7, 0.5, 0.3, 0.9], time(), nothing);
    check_exported_code(&case, &["../../models/src/furuta_pendulum.rs"]);
}

#[test]
fn names_reserved_in_c_are_replaced() {
    let m = MechanismWithReservedNames { int: 1.2, class: 0.3, r#type: 0.8, NAN: 4.0 };
    let mut case = case!("awkward", MechanismWithReservedNames, m, [1.2, 0.3, 0.8, 4.0], time(), of_trees);
    let argument_values = |name: &str| {
        let (_, numbers) = case.given.iter().find(|(known, _)| *known == name).expect("an argument");
        numbers.clone()
    };
    let (q, v, a) = (
        vector_from_slice(&argument_values("q")),
        vector_from_slice(&argument_values("v")),
        vector_from_slice(&argument_values("a")),
    );
    let (tau, u) = (vector_from_slice(&argument_values("tau")), vector_from_slice(&argument_values("u")));
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
    case.entries.extend(steps!(MechanismWithReservedNames, m, case));
    check_exported_code(&case, &["tests/mechanisms/mod.rs", "--struct", "MechanismWithReservedNames"]);
}

#[test]
fn c_code_of_driven_mechanisms_agrees_with_rust() {
    let m = Balloon { mass: 3.0, buoyancy: 2.5 };
    let mut case = case!("balloon", Balloon, m, [3.0, 2.5], time(t = 0.7), of_trees);
    case.entries.extend(steps!(Balloon, m, case));
    check_exported_code(&case, &["tests/mechanisms/mod.rs", "--struct", "Balloon"]);
}

/// Returns the tables of the mechanism [`Wing`]; `ARRAYS` contains the same values in C.
fn wing_tables(smooth: bool, extrapolated: bool) -> ([Table<1>; 1], [Table<2>; 1], [Table<3>; 1]) {
    let drag = Table::new([&[-1.0, 0.2, 0.5, 2.0]], &[0.3, -0.1, 0.4, 0.2]);
    let lift = Table::new([&[-0.2, 0.1, 0.5], &[-1.0, 1.0]], &[0.1, 0.2, 0.7, -0.3, 0.4, 0.9]);
    let moment = Table::new(
        [&[0.0, 1.0], &[-1.0, 0.0, 1.5], &[0.0, 0.3]],
        &[0.1, 0.2, 0.7, -0.3, 0.4, 0.9, 0.15, 0.25, 0.75, -0.35, 0.45, 0.95],
    );
    fn table_with_options<const N: usize>(
        table: Result<Table<N>, linkwork::TableError>,
        smooth: bool,
        on: bool,
    ) -> [Table<N>; 1] {
        let table = table.expect("a table");
        let table = if smooth { table.smooth() } else { table };
        [if on { table.extrapolated() } else { table }]
    }
    (
        table_with_options(drag, smooth, extrapolated),
        table_with_options(lift, smooth, extrapolated),
        table_with_options(moment, smooth, extrapolated),
    )
}

const ARRAYS: &str = "    static const double d0[] = {-1.0, 0.2, 0.5, 2.0}, d[] = {0.3, -0.1, 0.4, 0.2};
    static const double l0[] = {-0.2, 0.1, 0.5}, l1[] = {-1.0, 1.0}, l[] = {0.1, 0.2, 0.7, -0.3, 0.4, 0.9};
    static const double m0[] = {0.0, 1.0}, m1[] = {-1.0, 0.0, 1.5}, m2[] = {0.0, 0.3};
    static const double m[] = {0.1, 0.2, 0.7, -0.3, 0.4, 0.9, 0.15, 0.25, 0.75, -0.35, 0.45, 0.95};
";

/// C initialisers of the tables: linear, extrapolated, smooth, and both smooth and extrapolated.
const TABLES: [&str; 4] = [
    ", {{l0, l1, 0}, {3, 2, 0}, l, 0, 0}, {{d0, 0, 0}, {4, 0, 0}, d, 0, 0}, {{m0, m1, m2}, {2, 3, 2}, m, 0, \
     0}",
    ", {{l0, l1, 0}, {3, 2, 0}, l, 0, 1}, {{d0, 0, 0}, {4, 0, 0}, d, 0, 1}, {{m0, m1, m2}, {2, 3, 2}, m, 0, \
     1}",
    ", {{l0, l1, 0}, {3, 2, 0}, l, 1, 0}, {{d0, 0, 0}, {4, 0, 0}, d, 1, 0}, {{m0, m1, m2}, {2, 3, 2}, m, 1, \
     0}",
    ", {{l0, l1, 0}, {3, 2, 0}, l, 1, 1}, {{d0, 0, 0}, {4, 0, 0}, d, 1, 1}, {{m0, m1, m2}, {2, 3, 2}, m, 1, \
     1}",
];

/// Checks tables of every dimension within the grid and beyond it.
#[test]
fn table_lookups_in_c_agree_with_rust() {
    for (k, (prefix, c)) in
        ["wing", "wing_on", "wing_smooth", "wing_smooth_on"].into_iter().zip(TABLES).enumerate()
    {
        let ([drag], [lift], [moment]) = wing_tables(k > 1, k % 2 == 1);
        let m = Wing { mass: 2.0, lift, drag, moment };
        let mut case = case!("wing", Wing, m, [2.0], time(), of_trees);
        case.prefix = prefix;
        case.tables = [ARRAYS, c];
        // Derivatives with respect to the step size are compared with differences, which are inexact where
        // the slope of a table is discontinuous.
        case.tolerance = 1e-9;
        case.entries.extend(steps!(Wing, m, case));
        check_exported_code(&case, &["tests/mechanisms/mod.rs", "--struct", "Wing"]);
    }
}

/// Checks a mechanism with a closed loop. Functions that solve for constraint forces are not exported, which
/// the header and the command report; all others are.
#[test]
fn closed_loops_export_functions_without_constraint_forces() {
    let m = FourBar { g: 9.8, density: 1.0, a: 1.0, b: 2.0, c: 2.5, d: 3.0 };
    let mut case = case!("four_bar", FourBar, m, [9.8, 1.0, 1.0, 2.0, 2.5, 3.0], time(), nothing);
    let q = vector_from_slice(&case.given[0].1);
    case.entries.push(entry!("constraint_jacobian", "q", m.constraint_jacobian(&q)));
    case.entries.push(entry!("constraint_residuals", "q", m.constraint_residuals(&q)));
    check_exported_code(&case, &["../../models/src/four_bar.rs"]);
    if !available_c_compilers().is_empty() {
        let header = std::fs::read_to_string(test_folder("four_bar").join("four_bar.h")).expect("the header");
        assert!(header.contains("Not in C:") && !header.contains("four_bar_forward_dynamics("), "{header}");
    }
}

#[test]
fn c_code_in_single_precision_agrees_with_rust() {
    let case = case!("single", Ur5, Ur5, [], time(), of_trees);
    let Some(compiler) = available_c_compilers().into_iter().next() else {
        println!("skipped: there is no C compiler");
        return;
    };
    let folder = test_folder("single");
    export_c_code(&folder, &["--prefix", "single", "--scalar", "float", "../../models/urdf/ur5.urdf"]);
    let flags = ["-O2", "-Wdouble-promotion", "-Wfloat-conversion"];
    let found = compile_and_run(compiler, &folder, "single", &c_test_program(&case, "float"), &flags);
    compare_results(&case, &found, 2e-3);
}

/// Checks that the generated code compiles for mechanisms whose names are those of helper functions, header
/// functions, arguments or types.
#[test]
fn c_code_compiles_for_any_mechanism_name() {
    let Some(compiler) = available_c_compilers().into_iter().next() else {
        println!("skipped: there is no C compiler");
        return;
    };
    let folder = test_folder("names");
    // Some names once clashed with helper functions of the generated code.
    for (k, name) in [
        "Ball", "Free", "SinCos", "MulAdd", "Lw", "LwBall", "Which", "Given", "Product", "Arg", "Q", "W",
        "Self_", "Index", "Isnan", "FloatT", "Sinf", "Memcpy", "By", "Ffsll",
    ]
    .into_iter()
    .enumerate()
    {
        let joint = ["Ball", "Free"][k % 2];
        let source = folder.join("names.rs");
        let text = format!(
            "#[mechanism(gravity = -9.81 * z, derivatives)]\npub struct {name} {{\n    pub mass: f64,\n    \
             #[body(mass = mass, com = 0.1 * x, inertia = diagonal(0.1, 0.2, 0.25))]\n    stone: Body,\n    \
             #[joint(ground -> stone)]\n    flight: {joint},\n}}\n"
        );
        std::fs::write(&source, text).expect("a file of the tests'");
        export_c_code(&folder, &[source.to_str().expect("a path"), "--casadi"]);
        let files =
            std::fs::read_dir(&folder).expect("the folder").map(|entry| entry.expect("an entry").path());
        for file in files.filter(|path| path.extension().is_some_and(|end| end == "c")) {
            let compiled = std::process::Command::new(compiler)
                .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only"])
                .arg(&file)
                .output()
                .expect("the compiler starts");
            assert!(compiled.status.success(), "{name}: {}", String::from_utf8_lossy(&compiled.stderr));
            std::fs::remove_file(&file).expect("the file is there");
        }
    }
}
