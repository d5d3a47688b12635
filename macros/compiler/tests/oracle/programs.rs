//! Comparison of the generated programs with Kane's equations.

use crate::jet::{C, complex_from_real};
use crate::kane::{self, State};
use crate::random::Random;
use crate::spec::MechanismSpec;
use crate::words;
use linkwork_compiler::catalogue::CalledFunction;
use linkwork_compiler::derive::{DerivationOutput, Function};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::{Quantity, SuppliedQuantity};
use linkwork_compiler::{compile, parse_source_and_import};
use std::path::Path;

/// Maximum difference, relative to the terms whose sum a result is.
const TOLERANCE: f64 = 1e-10;
/// Imaginary step of complex-step differentiation; its square is negligible.
const STEP: f64 = 1e-40;

/// Step of sixth-order finite differences.
const H: f64 = 3e-3;

/// State and generalized forces at which programs are compared with the oracle.
struct EvaluationPoint {
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    tau: Vec<f64>,
    lambda: Vec<f64>,
    /// Rates of configuration, velocity and acceleration: the direction of second derivatives.
    along: [Vec<f64>; 3],
}

impl EvaluationPoint {
    fn new(spec: &MechanismSpec, seed: u64) -> EvaluationPoint {
        let (nq, nv) = kane::coordinate_and_velocity_counts(spec);
        let mut random = Random::new(seed ^ 0x5eed);
        let mut list =
            |n: usize, bound: f64| -> Vec<f64> { (0..n).map(|_| random.uniform_number(bound)).collect() };
        let (mut q, v, a, tau) = (list(nq, 1.5), list(nv, 1.0), list(nv, 2.0), list(nv, 3.0));
        let (lambda, along) = (list(nv, 1.0), [list(nv, 0.5), list(nv, 0.5), list(nv, 0.5)]);
        let mut first = 0;
        for body in &spec.bodies {
            let (own, _) = body.kind.coordinate_and_velocity_counts();
            if own >= 4 {
                normalise_quaternion(&mut q[first + own - 4..first + own]);
            }
            first += own + usize::from(body.slider.is_some());
        }
        EvaluationPoint { q, v, a, tau, lambda, along }
    }
}

fn normalise_quaternion(q: &mut [f64]) {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.iter_mut().for_each(|x| *x /= length);
}

/// Compiles a mechanism and compares every function of its dynamics with the oracle.
pub fn check_mechanism(spec: &MechanismSpec, seed: u64) {
    let point = EvaluationPoint::new(spec, seed);
    // The length of a cable that starts inside its obstacle is undefined.
    if !kane::are_cables_outside_surfaces(spec, &point.q) {
        return;
    }
    // With inerters on cables around cylinders, second derivatives may be too long.
    let checked = check_functions_with_derivatives(spec, ", second_derivatives", &point, seed)
        || check_functions_with_derivatives(spec, ", derivatives", &point, seed);
    assert!(checked || kane::coordinate_and_velocity_counts(spec).1 > 40, "seed {seed}");
}

/// Compares the functions of a mechanism, with the derivatives of the option `word`, with the oracle. Returns
/// false if the derivatives are too long.
fn check_functions_with_derivatives(
    spec: &MechanismSpec,
    word: &str,
    point: &EvaluationPoint,
    seed: u64,
) -> bool {
    let (arguments, item) = words::mechanism_source(spec, "Random", word);
    let parse_tokens = |text: &str| text.parse().expect("the generated source is Rust");
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let source =
        parse_source_and_import(parse_tokens(&arguments), parse_tokens(&item), Path::new(""), &mut cx);
    let compiled = source.as_ref().and_then(|source| compile(source, &graph, &mut cx));
    let Some((model, output)) = compiled else {
        assert!(graph.is_full(), "seed {seed}: {}\n{arguments}\n{item}", cx.full_message_texts().join("\n"));
        return false;
    };
    assert_eq!((model.nq(), model.nv()), kane::coordinate_and_velocity_counts(spec), "seed {seed}\n{item}");
    let case = CompiledTestMechanism {
        spec,
        output: &output,
        point,
        name: format!("seed {seed}\n{arguments}\n{item}"),
    };
    case.check_dynamics();
    case.check_derivatives();
    // Second derivatives take longest, so they are tested for fewer seeds.
    if seed.is_multiple_of(5) && word.contains("second") {
        case.check_second_derivatives();
    }
    true
}

struct CompiledTestMechanism<'a> {
    spec: &'a MechanismSpec,
    output: &'a DerivationOutput,
    point: &'a EvaluationPoint,
    name: String,
}

impl CompiledTestMechanism<'_> {
    /// Returns the results of a function, from its scalar program and from its program with lanes.
    fn run_function(&self, name: &str) -> Vec<Vec<f64>> {
        let function: &Function = self
            .output
            .functions
            .iter()
            .find(|f| f.name == name)
            .unwrap_or_else(|| panic!("no function {name}"));
        let state_value_of_symbol = |s| match Quantity::from_symbol(s) {
            Quantity::Parameter(k) => self.spec.bodies[k].mass,
            Quantity::Configuration(k) => self.point.q[k],
            Quantity::Velocity(k) => self.point.v[k],
            Quantity::Acceleration(k) => self.point.a[k],
            Quantity::Force(k) => self.point.tau[k],
            Quantity::Given(SuppliedQuantity::Factor, k) => self.point.lambda[k],
            _ => f64::NAN,
        };
        // The results of called functions are inputs of their callers.
        let called = CalledFunction::ALL.map(|called| {
            let function = self.output.functions.iter().find(|f| f.name == called.function_name());
            function.map_or_else(Vec::new, |f| f.program.interpret_program(&state_value_of_symbol))
        });
        let symbol_value_including_called_results = |s| match Quantity::from_symbol(s) {
            Quantity::PassiveForce(k) => called[0][k],
            Quantity::PassiveDerivative(k) => called[1][k],
            _ => state_value_of_symbol(s),
        };
        let program = &function.program;
        [Some(program), program.simd.as_deref()]
            .into_iter()
            .flatten()
            .map(|p| p.interpret_program(&symbol_value_including_called_results))
            .collect()
    }

    fn assert_close_entries(&self, what: &str, expected: &[f64], scale: f64) {
        for actual in self.run_function(what) {
            assert_eq!(actual.len(), expected.len(), "{what} of {}", self.name);
            for (k, (a, b)) in actual.iter().zip(expected).enumerate() {
                assert!(
                    (a - b).abs() <= TOLERANCE * scale,
                    "{what}, entry {k}: {a} and {b} of {scale}, {}",
                    self.name
                );
            }
        }
    }

    fn check_dynamics(&self) {
        let EvaluationPoint { q, v, a, tau, .. } = &self.point;
        let state = State::new(q, v, a);
        let (columns, bias) = kane::mass_and_bias(self.spec, &state.q, &state.v);
        let mass: Vec<f64> = columns.iter().flatten().map(|x| x.re).collect();
        let bias: Vec<f64> = bias.iter().map(|x| x.re).collect();
        let largest_magnitude = |list: &[f64]| list.iter().fold(1e-300_f64, |m, x| m.max(x.abs()));
        let (heavy, strong) = (largest_magnitude(&mass), largest_magnitude(&bias));
        self.assert_close_entries("mass_matrix", &mass, heavy);
        self.assert_close_entries("bias_forces", &bias, heavy + strong);
        let forces: Vec<f64> = kane::inverse_dynamics(self.spec, &state).iter().map(|x| x.re).collect();
        self.assert_close_entries("inverse_dynamics", &forces, heavy * 2.0 + strong);
        let nv = v.len();
        let kinetic: f64 = (0..nv)
            .flat_map(|i| (0..nv).map(move |j| (i, j)))
            .map(|(i, j)| 0.5 * v[i] * mass[j * nv + i] * v[j])
            .sum();
        self.assert_close_entries("kinetic_energy", &[kinetic], heavy);
        // The error of accelerations is measured by the residual force of each row, relative to the terms of
        // its sum.
        for actual in self.run_function("forward_dynamics") {
            for i in 0..nv {
                let terms: Vec<f64> = (0..nv).map(|j| mass[j * nv + i] * actual[j]).collect();
                let size: f64 =
                    terms.iter().map(|x| x.abs()).sum::<f64>() + tau[i].abs() + bias[i].abs() + strong;
                let rest = terms.iter().sum::<f64>() + bias[i] - tau[i];
                let reach = largest_magnitude(&actual) * heavy;
                assert!(
                    rest.abs() <= TOLERANCE * size.max(reach),
                    "forward dynamics, row {i}: {rest} is left of {size}, {}",
                    self.name
                );
            }
        }
    }

    fn check_derivatives(&self) {
        let EvaluationPoint { q, v, a, .. } = &self.point;
        let nv = v.len();
        let state = State::new(q, v, a);
        let imaginary_parts_over_step =
            |list: Vec<C>| -> Vec<f64> { list.iter().map(|x| x.im / STEP).collect() };
        let mut expected = Vec::new();
        for k in 0..nv {
            let stepped = State {
                q: kane::configuration_after_imaginary_step(self.spec, &state.q, k, STEP),
                ..state.clone()
            };
            expected.extend(imaginary_parts_over_step(kane::inverse_dynamics(self.spec, &stepped)));
        }
        for k in 0..nv {
            let mut stepped = state.clone();
            stepped.v[k] = complex_from_real(v[k]) + C::new(0.0, STEP);
            expected.extend(imaginary_parts_over_step(kane::inverse_dynamics(self.spec, &stepped)));
        }
        let scale = expected.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        self.assert_close_entries("inverse_dynamics_derivatives", &expected, scale);
    }

    /// Compares the product of second derivatives and a direction with sixth-order differences along it of
    /// derivatives by imaginary steps. The order of differentiation is also exchanged.
    fn check_second_derivatives(&self) {
        let EvaluationPoint { q, v, a, lambda, along, .. } = &self.point;
        let (nv, state) = (v.len(), State::new(q, v, a));
        let expected: Vec<f64> =
            (0..3 * nv).map(|entry| self.mixed_derivative(&state, entry, 0.5 * H)).collect();
        // Halving the step changes the result by about 64 times the remaining error. The error is large if
        // points connected by a spring nearly coincide.
        let doubt =
            (0..3 * nv).map(|entry| (self.mixed_derivative(&state, entry, H) - expected[entry]).abs());
        let doubt = doubt.fold(0.0, f64::max) / 16.0;
        // The rounding error of differences is relative to the differentiated values.
        let sizes = ["mass_matrix", "bias_forces", "inverse_dynamics_derivatives"]
            .map(|name| self.run_function(name).concat());
        let scale = sizes.iter().flatten().chain(&expected).fold(1.0_f64, |m, x| m.max(x.abs()));
        for found in self.run_function("inverse_dynamics_second_derivatives") {
            let second_derivative_entry = |b: usize, i: usize, j: usize| found[b * nv * nv + j * nv + i];
            for i in 0..nv {
                let row_product = |b: usize, along: &[f64]| {
                    (0..nv).map(|j| second_derivative_entry(b, i, j) * along[j]).sum::<f64>()
                };
                let column_product =
                    |b: usize| (0..nv).map(|j| second_derivative_entry(b, j, i) * along[0][j]).sum::<f64>();
                let products = [
                    row_product(0, &along[0]) + row_product(1, &along[1]) + row_product(3, &along[2]),
                    column_product(1) + row_product(2, &along[1]),
                    column_product(3),
                ];
                for (kind, product) in products.iter().enumerate() {
                    let expected = expected[kind * nv + i];
                    assert!(
                        (product - expected).abs() <= TOLERANCE * scale + doubt,
                        "second derivatives, row {i} of kind {kind}: {product} and {expected} of {scale} \
                         with {lambda:?}, {}",
                        self.name
                    );
                }
            }
        }
    }

    /// Returns a mixed second derivative of the power of the generalized forces with given factors: once with
    /// respect to one entry of `q`, `v` or `a`, once along the direction. It is the mean of both orders of
    /// differentiation, by finite differences with steps of `size`.
    fn mixed_derivative(&self, state: &State, entry: usize, size: f64) -> f64 {
        let EvaluationPoint { lambda, along, .. } = &self.point;
        let nv = lambda.len();
        let mut unit = [vec![0.0; nv], vec![0.0; nv], vec![0.0; nv]];
        unit[entry / nv][entry % nv] = 1.0;
        let power_derivative_along = |state: &State, along: &[Vec<f64>; 3]| {
            let all = (0..nv).fold(state.q.clone(), |q, k| {
                kane::configuration_after_imaginary_step(self.spec, &q, k, STEP * along[0][k])
            });
            let add_imaginary_step = |list: &[C], rates: &[f64]| -> Vec<C> {
                list.iter().zip(rates).map(|(x, rate)| x + C::new(0.0, STEP * rate)).collect()
            };
            let stepped = State {
                q: all,
                v: add_imaginary_step(&state.v, &along[1]),
                a: add_imaginary_step(&state.a, &along[2]),
            };
            kane::power_of_forces(self.spec, &stepped, lambda).im / STEP
        };
        let difference_quotient = |outer: &[Vec<f64>; 3], inner: &[Vec<f64>; 3]| {
            let power_derivative_at_displacement = |h: f64| {
                let add_real_step = |list: &[C], rates: &[f64]| -> Vec<C> {
                    list.iter().zip(rates).map(|(x, rate)| x + complex_from_real(h * rate)).collect()
                };
                let q = kane::displaced_configuration(self.spec, &state.q, &outer[0], h);
                power_derivative_along(
                    &State {
                        q,
                        v: add_real_step(&state.v, &outer[1]),
                        a: add_real_step(&state.a, &outer[2]),
                    },
                    inner,
                )
            };
            let central_difference =
                |h: f64| power_derivative_at_displacement(h) - power_derivative_at_displacement(-h);
            (central_difference(size) * 45.0 - central_difference(2.0 * size) * 9.0
                + central_difference(3.0 * size))
                / (60.0 * size)
        };
        (difference_quotient(along, &unit) + difference_quotient(&unit, along)) * 0.5
    }
}
