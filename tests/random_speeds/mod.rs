//! Checks of random mechanisms with random generalized speeds. All functions equal those in joint velocities,
//! transformed by Kane's definition `u = Y(q) v`, and derivatives equal finite differences.

use super::random_tree::{Tree, random_trees};
use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::eval::eval;
use linkwork_compiler::expr::sample::sample_of_symbol;
use linkwork_compiler::expr::{Expr, Graph, Symbol};
use linkwork_compiler::kinematics::{configuration_rate, random_configuration};
use linkwork_compiler::mechanism::{Chart, Model, Quantity};
use linkwork_compiler::{compile, parse_source_and_import};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::Path;
use support::random::{Random, property_test_config};

/// Options of the attribute whose generated functions are compared.
const WORDS: &str = "derivatives, momentum_derivatives, centroidal, hamilton, regressor, sensitivities";
/// Tolerance of results, relative to the largest entry.
const TOLERANCE: f64 = 1e-10;
/// Tolerance of derivatives against finite differences of order six.
const DIFFERENCES: f64 = 1e-7;

type Vector = Vec<f64>;

/// State of a mechanism with all other arguments of the generated functions.
#[derive(Clone, Default)]
struct StateArguments {
    q: Vector,
    v: Vector,
    a: Vector,
    tau: Vector,
    u: Vector,
    given: Vector,
}

impl StateArguments {
    fn state_value_of_symbol(&self, s: Symbol) -> f64 {
        match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => self.q[k],
            Quantity::Velocity(k) => self.v[k],
            Quantity::Acceleration(k) => self.a[k],
            Quantity::Force(k) => self.tau[k],
            Quantity::Input(k) => self.u[k],
            Quantity::Given(_, k) | Quantity::Momentum(k) => self.given[k],
            _ => sample_of_symbol(s, 3),
        }
    }
}

/// Compiled mechanism: its model and its generated functions.
struct CompiledMechanism<'g> {
    model: Model<'g>,
    output: DerivationOutput,
}

impl<'g> CompiledMechanism<'g> {
    fn compile_source(
        (arguments, item): &(String, String),
        graph: &'g Graph,
    ) -> Result<CompiledMechanism<'g>, Vec<String>> {
        let parse_tokens = |text: &str| text.parse().expect("the generated source is Rust");
        let mut cx = Diagnostics::new();
        let source =
            parse_source_and_import(parse_tokens(arguments), parse_tokens(item), Path::new(""), &mut cx);
        let found = source.and_then(|source| compile(&source, graph, &mut cx));
        match found {
            Some((model, output)) => {
                let _ = cx.full_message_texts();
                Ok(CompiledMechanism { model, output })
            }
            None => Err(cx.full_message_texts()),
        }
    }

    fn run_function(&self, name: &str, state: &StateArguments) -> Vector {
        let function = self.output.functions.iter().find(|f| f.name == name);
        let function = function.unwrap_or_else(|| panic!("there is a function `{name}`"));
        function.program.interpret_program(&|s| state.state_value_of_symbol(s))
    }

    /// Returns the rates of the configuration at the joint velocities `v`.
    fn configuration_rates(&self, q: &[f64], v: &[f64]) -> Vector {
        let native = Model { speeds: None, ..self.model.clone() };
        let rates: Vec<Expr<'_>> =
            (0..native.nq()).map(|k| configuration_rate(native.configuration_space(), k)).collect();
        let state = StateArguments { q: q.to_vec(), v: v.to_vec(), ..StateArguments::default() };
        eval(&rates, &|s| state.state_value_of_symbol(s))
    }
}

/// Returns the matrices of generalized speeds at a configuration, as lists of rows: `Y` of `u = Y v` and `Z`
/// of `v = Z u`.
fn speed_transformation_matrices(model: &Model<'_>, q: &[f64]) -> [Vec<Vector>; 2] {
    let speeds = model.speeds.as_ref().expect("there are speeds");
    let state = StateArguments { q: q.to_vec(), ..StateArguments::default() };
    [&speeds.velocity_to_speed_matrix, &speeds.rates]
        .map(|m| m.iter().map(|row| eval(row, &|s| state.state_value_of_symbol(s))).collect())
}

fn matrix_vector_product(m: &[Vector], v: &[f64]) -> Vector {
    m.iter().map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()).collect()
}

fn transposed_rows(m: &[Vector]) -> Vec<Vector> {
    (0..m[0].len()).map(|j| m.iter().map(|row| row[j]).collect()).collect()
}

/// Returns the rows of a matrix with `rows` rows from its column-major entries.
fn rows_of_matrix(e: &[f64], rows: usize) -> Vec<Vector> {
    (0..rows).map(|i| e.chunks(rows).map(|column| column[i]).collect()).collect()
}

fn matrix_product(a: &[Vector], b: &[Vector]) -> Vec<Vector> {
    let b = transposed_rows(b);
    a.iter().map(|row| matrix_vector_product(&b, row)).collect()
}

#[track_caller]
fn assert_close(what: &str, a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len(), "{what}");
    let scale = b.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() <= tolerance * scale, "{what}, entry {k}: {a} and {b}");
    }
}

/// Returns the derivative of a vector function at zero by central differences of order six.
fn derivative_at_zero(f: impl Fn(f64) -> Vector) -> Vector {
    let h = 4e-3;
    let mut sum = vec![0.0; f(0.0).len()];
    for (k, weight) in [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)] {
        for (sum, (up, down)) in sum.iter_mut().zip(f(k * h).iter().zip(f(-k * h))) {
            *sum += weight * (up - down) / h;
        }
    }
    sum
}

fn displaced_vector(x: &[f64], e: f64, d: &[f64]) -> Vector {
    x.iter().zip(d).map(|(x, d)| x + e * d).collect()
}

/// Returns random declarations of generalized speeds: combinations of neighbouring velocities with
/// coefficients that depend on coordinates, and angular velocities of bodies on ball joints in the axes of
/// their parents.
fn random_speed_declarations(plain: &Model<'_>, fields: &str, random: &mut Random) -> String {
    let names: Vec<&String> = plain
        .charts
        .iter()
        .filter_map(
            |chart| if let Chart::Plain(q, _) = chart { Some(&plain.configuration[q.0]) } else { None },
        )
        .collect();
    let mut text = String::new();
    let chosen: Vec<&&String> = names.iter().take(4).collect();
    for (k, name) in chosen.iter().enumerate() {
        let (next, other) = (chosen[(k + 1) % chosen.len()], chosen[(k + 2) % chosen.len()]);
        let [a, b, c] = std::array::from_fn(|_| random.uniform_number(0.4));
        let _ = writeln!(
            text,
            "#[speed((1.5 + {a:?} * sin({next})) * rate({name}) + {b:?} * cos({name}) * rate({next}) + {c:?} \
             * rate({other}))] speed{k}: Speed,"
        );
    }
    for k in 0..8 {
        if fields.contains(&format!("joint{k}: Ball,")) {
            let parent = fields
                .split(&format!("-> body{k}"))
                .next()
                .and_then(|before| before.rsplit("#[joint(").next());
            let parent = parent.and_then(|end| end.split(['.', ' ']).next()).unwrap_or("ground");
            for axis in ["x", "y", "z"] {
                let _ = writeln!(
                    text,
                    "#[speed(dot(omega(body{k} / {parent}), {parent}.{axis}))] turn{k}{axis}: Speed,"
                );
            }
        }
    }
    text
}

/// Checks a random tree with random generalized speeds. Returns `false`, without a check, for trees without
/// plain coordinates or ball joints, and for trees that do not compile.
fn check_tree_with_random_speeds(tree: &Tree, seed: u64) -> bool {
    let (arguments, item) = tree.tree_source();
    let arguments = format!("{arguments}, {WORDS}");
    let graph = Graph::new();
    let plain = CompiledMechanism::compile_source(&(arguments.clone(), item.clone()), &graph);
    // Other tests cover trees that the compiler rejects.
    let Ok(plain) = plain else { return false };
    let mut random = Random::new(seed);
    let speeds = random_speed_declarations(&plain.model, &item, &mut random);
    if speeds.is_empty() {
        return false;
    }
    let item = item.trim_end().trim_end_matches('}').to_string() + &speeds + "}";
    let with = CompiledMechanism::compile_source(&(arguments, item.clone()), &graph);
    let with = with.unwrap_or_else(|messages| panic!("{}\n{item}", messages.join("\n")));
    check_functions_in_speeds(&plain, &with, &mut random, seed);
    true
}

fn check_functions_in_speeds(
    plain: &CompiledMechanism<'_>,
    with: &CompiledMechanism<'_>,
    random: &mut Random,
    seed: u64,
) {
    let n = plain.model.nv();
    let mut random_vector =
        |count: usize| -> Vector { (0..count).map(|_| random.uniform_number(1.0)).collect() };
    let q = random_configuration(&plain.model, seed);
    let [y, z] = speed_transformation_matrices(&with.model, &q);
    let identity: Vec<Vector> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    assert_close("inverse", &matrix_product(&y, &z).concat(), &identity.concat(), TOLERANCE);
    let ours = StateArguments {
        q: q.clone(),
        v: random_vector(n),
        a: random_vector(n),
        tau: random_vector(n),
        u: random_vector(plain.model.nu()),
        given: random_vector(n),
    };
    let (to_rates, to_forces) = (transposed_rows(&z), transposed_rows(&y));
    let theirs = StateArguments {
        v: matrix_vector_product(&z, &ours.v),
        a: with.run_function("__rate_accelerations", &ours),
        tau: matrix_vector_product(&to_forces, &ours.tau),
        given: matrix_vector_product(&to_forces, &ours.given),
        ..ours.clone()
    };
    let rates_after = |e: f64| {
        let moved = displaced_vector(&q, e, &plain.configuration_rates(&q, &theirs.v));
        with.run_function(
            "rates_of_speeds",
            &StateArguments { q: moved, v: displaced_vector(&ours.v, e, &ours.a), ..ours.clone() },
        )
    };
    assert_close("accelerations of the joints", &theirs.a, &derivative_at_zero(rates_after), DIFFERENCES);
    let assert_same_function_results = |name: &str| {
        assert_close(name, &with.run_function(name, &ours), &plain.run_function(name, &theirs), TOLERANCE)
    };
    for name in
        ["kinetic_energy", "potential_energy", "momentum", "dissipated_power", "control_power", "hamiltonian"]
    {
        assert_same_function_results(name);
    }
    for name in ["inverse_dynamics", "generalized_forces", "generalized_momentum"] {
        assert_close(
            name,
            &with.run_function(name, &ours),
            &matrix_vector_product(&to_rates, &plain.run_function(name, &theirs)),
            TOLERANCE,
        );
    }
    let mass = matrix_product(
        &to_rates,
        &matrix_product(&rows_of_matrix(&plain.run_function("mass_matrix", &theirs), n), &z),
    );
    assert_close(
        "mass matrix",
        &with.run_function("mass_matrix", &ours),
        &transposed_rows(&mass).concat(),
        TOLERANCE,
    );
    let still = StateArguments { a: vec![0.0; n], ..ours.clone() };
    assert_close(
        "bias",
        &with.run_function("bias_forces", &ours),
        &with.run_function("inverse_dynamics", &still),
        TOLERANCE,
    );
    let forward = with.run_function("forward_dynamics", &ours);
    let moving = StateArguments { a: forward.clone(), ..ours.clone() };
    assert_close(
        "forward dynamics",
        &with.run_function("__rate_accelerations", &moving),
        &plain.run_function("forward_dynamics", &theirs),
        1e-8,
    );
    assert_close("forward dynamics", &with.run_function("inverse_dynamics", &moving), &ours.tau, 1e-8);
    let velocity = matrix_vector_product(&y, &plain.run_function("canonical_velocity", &theirs));
    assert_close("canonical velocity", &with.run_function("canonical_velocity", &ours), &velocity, 1e-8);
    let centroidal =
        matrix_product(&rows_of_matrix(&plain.run_function("centroidal_momentum_matrix", &theirs), 6), &z);
    assert_close(
        "centroidal",
        &with.run_function("centroidal_momentum_matrix", &ours),
        &transposed_rows(&centroidal).concat(),
        TOLERANCE,
    );
    check_rates_along_motion(plain, with, &ours, &theirs);
    check_derivatives(plain, with, &ours, &z);
}

/// Checks generated functions that are rates along the motion, with and without declared speeds.
fn check_rates_along_motion(
    plain: &CompiledMechanism<'_>,
    with: &CompiledMechanism<'_>,
    ours: &StateArguments,
    theirs: &StateArguments,
) {
    let n = plain.model.nv();
    let way = plain.configuration_rates(&ours.q, &theirs.v);
    let state_after = |e: f64| StateArguments {
        q: displaced_vector(&ours.q, e, &way),
        v: displaced_vector(&ours.v, e, &ours.a),
        ..ours.clone()
    };
    let rate = derivative_at_zero(|e| with.run_function("generalized_momentum", &state_after(e)));
    let lacking: Vector =
        with.run_function("inverse_dynamics", ours).iter().zip(&rate).map(|(tau, rate)| rate - tau).collect();
    assert_close("momentum rate", &with.run_function("momentum_rate", ours), &lacking, DIFFERENCES);
    let matrix_of = |name: &str, state: &StateArguments, rows: usize| {
        rows_of_matrix(&with.run_function(name, state), rows)
    };
    let still = StateArguments { a: vec![0.0; n], ..ours.clone() };
    let state_with_fixed_speeds = |e: f64| StateArguments { v: ours.v.clone(), ..state_after(e) };
    let bias = derivative_at_zero(|e| {
        matrix_vector_product(
            &matrix_of("centroidal_momentum_matrix", &state_with_fixed_speeds(e), 6),
            &ours.v,
        )
    });
    assert_close(
        "centroidal bias",
        &with.run_function("centroidal_momentum_bias", &still),
        &bias,
        DIFFERENCES,
    );
    // `Ṁ − 2 C` is skew-symmetric for the Coriolis matrix `C`.
    let mass_rate =
        rows_of_matrix(&derivative_at_zero(|e| with.run_function("mass_matrix", &state_after(e))), n);
    let coriolis = matrix_of("coriolis_matrix", ours, n);
    let skew_entry = |i: usize, j: usize| mass_rate[i][j] - 2.0 * coriolis[i][j];
    let sums: Vector = (0..n * n).map(|k| skew_entry(k / n, k % n) + skew_entry(k % n, k / n)).collect();
    assert_close("skew", &sums, &vec![0.0; n * n], DIFFERENCES * 10.0);
}

/// Checks the derivatives with respect to the configuration (along unit generalized speeds) and to the
/// speeds.
fn check_derivatives(
    plain: &CompiledMechanism<'_>,
    with: &CompiledMechanism<'_>,
    ours: &StateArguments,
    z: &[Vector],
) {
    let n = plain.model.nv();
    let speed_to_velocity_column = |i: usize| -> Vector { z.iter().map(|row| row[i]).collect() };
    let derivative_by_coordinate = |name: &str, i: usize| {
        let way = plain.configuration_rates(&ours.q, &speed_to_velocity_column(i));
        derivative_at_zero(|e| {
            with.run_function(name, &StateArguments { q: displaced_vector(&ours.q, e, &way), ..ours.clone() })
        })
    };
    let unit_vector = |i: usize| -> Vector { (0..n).map(|j| f64::from(u8::from(i == j))).collect() };
    let derivative_by_speed = |name: &str, i: usize| {
        derivative_at_zero(|e| {
            with.run_function(
                name,
                &StateArguments { v: displaced_vector(&ours.v, e, &unit_vector(i)), ..ours.clone() },
            )
        })
    };
    let expected_derivatives = |name: &str| -> Vector {
        let q = (0..n).flat_map(|i| derivative_by_coordinate(name, i));
        q.chain((0..n).flat_map(|i| derivative_by_speed(name, i))).collect()
    };
    for (function, name) in
        [("inverse_dynamics_derivatives", "inverse_dynamics"), ("momentum_rate_derivatives", "momentum_rate")]
    {
        assert_close(function, &with.run_function(function, ours), &expected_derivatives(name), DIFFERENCES);
    }
    // `∂u̇/∂x = −M⁻¹ ∂τ/∂x` at fixed accelerations: the function returns the factors of this product.
    let outputs = with.run_function("forward_dynamics_derivatives", ours);
    let inverse = rows_of_matrix(&outputs[2 * n * n..3 * n * n], n);
    let found: Vector = outputs[..2 * n * n]
        .chunks(n)
        .flat_map(|forces| matrix_vector_product(&inverse, forces).into_iter().map(|a| -a))
        .collect();
    assert_close(
        "forward derivatives",
        &found,
        &expected_derivatives("forward_dynamics"),
        DIFFERENCES * 100.0,
    );
    let changes: Vector = (0..n).flat_map(|i| derivative_by_coordinate("rates_of_speeds", i)).collect();
    assert_close("changes of rates", &with.run_function("__rate_changes", ours), &changes, DIFFERENCES);
}

proptest! {
    #![proptest_config(property_test_config(12))]
    #[test]
    fn random_speeds_transform_all_functions(tree in random_trees(4), seed in 0..50_u64) {
        prop_assume!(check_tree_with_random_speeds(&tree, seed));
    }
}

/// Returns the printed equations of a mechanism with these fields.
fn printed_equations(arguments: &str, fields: &str) -> String {
    let graph = Graph::new();
    let source = (arguments.to_string(), format!("pub struct Printed {{ {fields} }}"));
    let found = CompiledMechanism::compile_source(&source, &graph)
        .unwrap_or_else(|messages| panic!("{}", messages.join("\n")));
    found.output.equations.plain
}

/// Three hinges that rotate a body by Euler angles about its centre of mass.
const BODY: &str = "a: f64, b: f64, c: f64,
    #[body(mass = 0, inertia = 0)] first: Body, #[body(mass = 0, inertia = 0)] second: Body,
    #[body(mass = 1, inertia = diagonal(a, b, c))] rotor: Body,
    #[joint(ground -> first, about = z)] psi: Pin,
    #[joint(first -> second, about = x)] theta: Pin,
    #[joint(second -> rotor, about = z)] phi: Pin,";

/// The printed equations are Euler's, in the form of Kane and Levinson (1985) and other textbooks.
#[test]
fn rigid_body_in_body_axes_prints_eulers_equations() {
    let speeds = "#[speed(rate(psi) * sin(theta) * sin(phi) + rate(theta) * cos(phi))] wx: Speed,
        #[speed(rate(psi) * sin(theta) * cos(phi) - rate(theta) * sin(phi))] wy: Speed,
        #[speed(dot(omega(rotor / ground), rotor.z))] wz: Speed,";
    let text = printed_equations("", &format!("{BODY} {speeds}"));
    for line in [
        "theta' = cos(phi) wx - sin(phi) wy\n",
        "a wx' + (c - b) wy wz = 0\n",
        "b wy' + (a - c) wx wz = 0\n",
        "c wz' + (b - a) wx wy = 0\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
    assert!(!text.contains("psi''"), "{text}");
}

/// Printed equations of a rolling disk are Kane's equations.
#[test]
fn rolling_disk_prints_kanes_equations() {
    let fields = "m: f64, g: f64, radius: f64,
        #[body(mass = 0, inertia = 0)] upright: Body, #[body(mass = 0, inertia = 0)] turned: Body,
        #[body(mass = 0, inertia = 0)] leaning: Body,
        #[body(mass = m, inertia = disk(m, radius, y))] disk: Body,
        #[joint(ground -> upright, along = (x, y, z))] place: Stage,
        #[joint(upright -> turned, about = z)] heading: Pin,
        #[joint(turned -> leaning, about = x)] lean: Pin,
        #[joint(leaning -> disk, about = y)] roll: Pin,
        #[constraint(rolls(disk.circle(radius, y), ground.plane(z)))] contact: Rolling,
        #[speed(dot(omega(disk / ground), leaning.x))] u1: Speed,
        #[speed(dot(omega(disk / ground), leaning.y))] u2: Speed,
        #[speed(dot(omega(disk / ground), leaning.z))] u3: Speed,";
    let text = printed_equations("gravity = -g * z", fields);
    // About the lean axis only inertia acts: `I u3' + J u1 u2 − I u1 u3 tan(lean)` with `I = m r²/4`,
    // `J = m r²/2`.
    for line in [
        "heading' = u3/cos(lean)\n",
        "roll' = u2 - sin(lean) u3/cos(lean)\n",
        "1/2 m radius² (1/2 u3' + (u2 - 1/2 sin(lean) u3/cos(lean)) u1) = 0\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
}
