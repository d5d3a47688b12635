//! Mechanisms with rare combinations of features, compared with d'Alembert's principle on positions alone.
//! Every body is replaced by a few particles with the same mass, centre of mass and inertia. Sixth-order
//! differences of positions along a motion give accelerations and partial velocities of the particles and of
//! the lengths of elements. The compiler's velocities, accelerations, constraints and derivatives are not
//! used.

use crate::combinations::ROWS;
use crate::random::Random;
use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::{compile, parse_source_and_import};
use std::fmt::Write;
use std::path::Path;

/// Time step of the finite differences, s.
const H: f64 = 4e-3;
/// Maximum difference, relative to the magnitude of the compared values.
const TOLERANCE: f64 = 1e-7;

/// Body or particle: name, mass, centre of mass, moments of inertia about its own axes.
pub type BodyOrParticle = (&'static str, f64, [f64; 3], [f64; 3]);

/// Law of an element that acts along a scalar expression of the language.
#[derive(Clone, Copy)]
pub enum Law {
    Spring(f64, f64),
    Dashpot(f64),
    Inerter(f64),
    Push(f64),
    /// Central force with the potential `−c / s` at the distance `s`.
    Central(f64),
    /// Time-dependent spring with the potential `½ k s²` times the square of time.
    Growing(f64),
}

/// Source of a test mechanism, and the model of it that the oracle evaluates.
pub struct CombinedMechanism {
    pub name: &'static str,
    pub gravity: [f64; 3],
    /// One letter for each joint or coordinate: `s` scalar, `b` ball, `f` free.
    pub charts: &'static str,
    pub item: &'static str,
    pub masses: &'static [BodyOrParticle],
    pub elements: &'static [(Law, &'static str)],
}

#[test]
fn random_force_laws_obey_dalemberts_principle() {
    const SKIPPED: &str = ", skip_passes = [frames, regroup, parallel, limbs]";
    for row in ROWS {
        let constrained = row.item.contains("#[constraint") || row.item.contains("closing");
        let speeds = constrained.then_some(", formulation = speeds");
        for more in ["", ", derivatives", SKIPPED].into_iter().chain(speeds) {
            check_combined_mechanism(row, more);
        }
    }
}

#[derive(Clone)]
struct State {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    tau: Vec<f64>,
}

struct CompiledTestMechanism<'a> {
    row: &'a CombinedMechanism,
    output: &'a DerivationOutput,
    name: String,
}

fn check_combined_mechanism(row: &CombinedMechanism, more: &str) {
    let mut item = row.item.trim_end().trim_end_matches('}').to_string();
    for (name, ..) in row.masses {
        let _ = writeln!(item, "#[output(r({name} / ground))] o_{name}: Vector,");
        if !is_particle(row, name) {
            for axis in ["x", "y", "z"] {
                let _ = writeln!(item, "#[output(r({name}.at({axis}) / ground))] {axis}_{name}: Vector,");
            }
        }
    }
    for (k, (_, expression)) in row.elements.iter().enumerate() {
        let _ = writeln!(item, "#[output({expression})] s{k}: Scalar,");
    }
    item.push('}');
    let arguments = format!("gravity = {:?}{more}", row.gravity);
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let parse_tokens = |text: &str| text.parse().expect("Rust");
    let source =
        parse_source_and_import(parse_tokens(&arguments), parse_tokens(&item), Path::new(""), &mut cx);
    let compiled = source.as_ref().and_then(|source| compile(source, &graph, &mut cx));
    let Some((model, output)) = compiled else {
        panic!("{}: {}", row.name, cx.full_message_texts().join("\n"));
    };
    let case = CompiledTestMechanism { row, output: &output, name: format!("{}{more}", row.name) };
    let mut random = Random::new(7);
    for _ in 0..2 {
        let mut list =
            |n: usize, bound: f64| -> Vec<f64> { (0..n).map(|_| random.uniform_number(bound)).collect() };
        let (nq, nv) = (model.nq(), model.nv());
        let mut q = list(nq, 0.9);
        let mut first = 0;
        for chart in row.charts.chars() {
            let n = match chart {
                's' => 1,
                'b' => 4,
                _ => 7,
            };
            if n > 1 {
                let quaternion = &mut q[first + n - 4..first + n];
                quaternion[3] += 1.5;
                let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
                quaternion.iter_mut().for_each(|x| *x /= length);
            }
            first += n;
        }
        assert_eq!(first, nq, "{}: {:?}", row.name, model.configuration);
        let state = State { t: 0.4, q, v: list(nv, 0.8), a: list(nv, 1.5), tau: list(nv, 2.0) };
        case.check_inverse_dynamics_forces(&state);
        case.check_constraint_rates_and_biases(&state);
        case.check_equations_of_motion(&state);
        case.check_derivatives(&state);
    }
}

fn is_particle(row: &CombinedMechanism, name: &str) -> bool {
    row.item.contains(&format!("{name}: Particle"))
}

fn rotate_by_quaternion(quaternion: &[f64], u: [f64; 3]) -> [f64; 3] {
    let (p, w) = ([quaternion[0], quaternion[1], quaternion[2]], quaternion[3]);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let first = cross(p, u);
    let second = cross(p, first);
    std::array::from_fn(|i| u[i] + 2.0 * (w * first[i] + second[i]))
}

/// Rotates a quaternion by a rotation vector `φ` in body axes: `q ⊗ exp(φ)`.
fn rotate_quaternion(q: &mut [f64], phi: [f64; 3]) {
    let angle = phi.iter().map(|x| x * x).sum::<f64>().sqrt();
    let part = if angle < 1e-12 { 0.5 } else { (angle / 2.0).sin() / angle };
    let [x, y, z] = phi.map(|p| p * part);
    let w = (angle / 2.0).cos();
    let [a, b, c, d] = [q[0], q[1], q[2], q[3]];
    q[0] = d * x + a * w + b * z - c * y;
    q[1] = d * y - a * z + b * w + c * x;
    q[2] = d * z + a * y - b * x + c * w;
    q[3] = d * w - a * x - b * y - c * z;
}

/// Returns the first derivative `(45 (f₁ − f₋₁) − 9 (f₂ − f₋₂) + f₃ − f₋₃) / 60 h`.
fn sixth_order_difference(f: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let [a, b, c, d, e, g] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0].map(|k| f(k * H));
    let finite_difference =
        |i: usize| (g[i] - a[i] - 9.0 * (e[i] - b[i]) + 45.0 * (d[i] - c[i])) / (60.0 * H);
    (0..a.len()).map(finite_difference).collect()
}

fn second_derivative(f: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let [a, b, c, d, e, g, m] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 0.0].map(|k| f(k * H));
    let weighted_sum_of_outer_samples =
        |i: usize| 2.0 * (a[i] + g[i]) - 27.0 * (b[i] + e[i]) + 270.0 * (c[i] + d[i]);
    (0..a.len()).map(|i| (weighted_sum_of_outer_samples(i) - 490.0 * m[i]) / (180.0 * H * H)).collect()
}

impl CompiledTestMechanism<'_> {
    /// Returns the state after `q ⊕ (v h + a h² / 2)`, with consistent velocities.
    fn state_after_time(&self, s: &State, h: f64) -> State {
        let mut out = s.clone();
        let (mut q0, mut v0) = (0, 0);
        let taylor_displacement_of_coordinate = |k: usize| s.v[k] * h + s.a[k] * h * h / 2.0;
        for chart in self.row.charts.chars() {
            match chart {
                's' => out.q[q0] += taylor_displacement_of_coordinate(v0),
                'b' => rotate_quaternion(
                    &mut out.q[q0..q0 + 4],
                    [
                        taylor_displacement_of_coordinate(v0),
                        taylor_displacement_of_coordinate(v0 + 1),
                        taylor_displacement_of_coordinate(v0 + 2),
                    ],
                ),
                _ => {
                    let (v, w) = (&s.v[v0..v0 + 3], &s.v[v0 + 3..v0 + 6]);
                    let spin =
                        [w[1] * v[2] - w[2] * v[1], w[2] * v[0] - w[0] * v[2], w[0] * v[1] - w[1] * v[0]];
                    let body = std::array::from_fn(|i| {
                        taylor_displacement_of_coordinate(v0 + i) + spin[i] * h * h / 2.0
                    });
                    let d = rotate_by_quaternion(&s.q[q0 + 3..q0 + 7], body);
                    (0..3).for_each(|i| out.q[q0 + i] += d[i]);
                    rotate_quaternion(
                        &mut out.q[q0 + 3..q0 + 7],
                        [
                            taylor_displacement_of_coordinate(v0 + 3),
                            taylor_displacement_of_coordinate(v0 + 4),
                            taylor_displacement_of_coordinate(v0 + 5),
                        ],
                    );
                }
            }
            let (nq, nv) = match chart {
                's' => (1, 1),
                'b' => (4, 3),
                _ => (7, 6),
            };
            (q0, v0) = (q0 + nq, v0 + nv);
        }
        (0..s.v.len()).for_each(|k| out.v[k] += s.a[k] * h);
        out.t += h;
        out
    }

    /// Returns the state after a step of the configuration along one velocity. Time, velocities and
    /// accelerations are unchanged.
    fn state_displaced_along_velocity(&self, s: &State, k: usize, h: f64) -> State {
        let mut unit = s.clone();
        unit.v.fill(0.0);
        unit.a.fill(0.0);
        unit.v[k] = 1.0;
        let moved = self.state_after_time(&unit, h);
        State { q: moved.q, ..s.clone() }
    }

    fn has_function(&self, name: &str) -> bool {
        self.output.functions.iter().any(|f| f.name == name)
    }

    /// Returns the result of a function. The scalar program and the program with lanes must agree.
    fn run_function(&self, name: &str, s: &State) -> Vec<f64> {
        let f = self.output.functions.iter().find(|f| f.name == name);
        let f = f.unwrap_or_else(|| panic!("{}: no {name}", self.name));
        let state_value_of_symbol = |symbol| match Quantity::from_symbol(symbol) {
            Quantity::Configuration(k) => s.q[k],
            Quantity::Velocity(k) => s.v[k],
            Quantity::Acceleration(k) => s.a[k],
            Quantity::Force(k) => s.tau[k],
            Quantity::Time => s.t,
            other => panic!("{}: {name} takes {other:?}", self.name),
        };
        let plain = f.program.interpret_program(&state_value_of_symbol);
        if let Some(lanes) = f.program.simd.as_deref() {
            self.assert_close_entries(
                &format!("lanes of {name}"),
                &lanes.interpret_program(&state_value_of_symbol),
                &plain,
                1.0,
            );
        }
        plain
    }

    fn assert_close_entries(&self, what: &str, found: &[f64], expected: &[f64], scale: f64) {
        assert_eq!(found.len(), expected.len(), "{what} of {}", self.name);
        let size = expected.iter().fold(scale.max(1.0), |m, x| m.max(x.abs()));
        for (k, (a, b)) in found.iter().zip(expected).enumerate() {
            assert!(
                (a - b).abs() <= TOLERANCE * size,
                "{what}, entry {k}: {a} instead of {b} of {size}, {}",
                self.name
            );
        }
    }

    /// Returns the positions of all particles in order.
    fn particle_positions(&self, s: &State) -> Vec<f64> {
        let mut all = Vec::new();
        for (name, _, com, moments) in self.row.masses {
            let o = self.run_function(&format!("o_{name}"), s);
            if is_particle(self.row, name) {
                all.extend(o);
                continue;
            }
            let axes = ["x", "y", "z"].map(|axis| self.run_function(&format!("{axis}_{name}"), s));
            let ground_position_of_body_point = |p: [f64; 3]| {
                let coordinate_in_frame =
                    |i: usize| o[i] + (0..3).map(|k| (axes[k][i] - o[i]) * p[k]).sum::<f64>();
                [coordinate_in_frame(0), coordinate_in_frame(1), coordinate_in_frame(2)]
            };
            all.extend(ground_position_of_body_point(*com));
            for k in (0..3).filter(|_| *moments != [0.0; 3]) {
                for side in [-1.0, 1.0] {
                    let mut p = *com;
                    p[k] += side;
                    all.extend(ground_position_of_body_point(p));
                }
            }
        }
        all
    }

    /// Returns the masses of the particles that replace the bodies. Masses at a distance of 1 m from the
    /// centre may be negative; only their sum over a body is its mass.
    fn masses_of_replacing_particles(&self) -> Vec<f64> {
        let mut all = Vec::new();
        for (_, mass, _, moments) in self.row.masses {
            if *moments == [0.0; 3] {
                all.push(*mass);
                continue;
            }
            let half: f64 = moments.iter().sum::<f64>() / 2.0;
            let own = moments.map(|m| (half - m) / 2.0);
            all.push(mass - 2.0 * own.iter().sum::<f64>());
            own.iter().for_each(|m| all.extend([*m, *m]));
        }
        all
    }

    /// Returns the generalized forces `τ` of a motion, computed by d'Alembert's principle.
    fn generalized_forces(&self, s: &State) -> Vec<f64> {
        let lengths_of_elements = |s: &State| -> Vec<f64> {
            (0..self.row.elements.len()).map(|k| self.run_function(&format!("s{k}"), s)[0]).collect()
        };
        let accelerations = second_derivative(|h| self.particle_positions(&self.state_after_time(s, h)));
        let (now, rate, bend) = (
            lengths_of_elements(s),
            sixth_order_difference(|h| lengths_of_elements(&self.state_after_time(s, h))),
            second_derivative(|h| lengths_of_elements(&self.state_after_time(s, h))),
        );
        let weights = self.masses_of_replacing_particles();
        let generalized_force = |k: usize| {
            let partial = sixth_order_difference(|h| {
                self.particle_positions(&self.state_displaced_along_velocity(s, k, h))
            });
            let mut sum = 0.0;
            for (i, (a, p)) in accelerations.iter().zip(&partial).enumerate() {
                sum += weights[i / 3] * (a - self.row.gravity[i % 3]) * p;
            }
            let partial = sixth_order_difference(|h| {
                lengths_of_elements(&self.state_displaced_along_velocity(s, k, h))
            });
            for (e, (law, _)) in self.row.elements.iter().enumerate() {
                sum += partial[e]
                    * match *law {
                        Law::Spring(k, free) => k * (now[e] - free),
                        Law::Dashpot(c) => c * rate[e],
                        Law::Inerter(b) => b * bend[e],
                        Law::Push(f) => -f,
                        Law::Central(c) => c / (now[e] * now[e]),
                        Law::Growing(k) => k * now[e] * s.t * s.t,
                    };
            }
            sum
        };
        (0..s.v.len()).map(generalized_force).collect()
    }

    fn check_inverse_dynamics_forces(&self, s: &State) {
        self.assert_close_entries(
            "inverse dynamics",
            &self.run_function("inverse_dynamics", s),
            &self.generalized_forces(s),
            1.0,
        );
    }

    fn check_constraint_rates_and_biases(&self, s: &State) {
        if !self.has_function("constraint_jacobian") {
            return;
        }
        let jacobian = self.run_function("constraint_jacobian", s);
        let nv = s.v.len();
        let nc = jacobian.len() / nv;
        // Constraint rates are linear in the velocities.
        for k in 0..nv {
            let constraint_rates_at_changed_velocity = |h: f64| {
                let mut s = s.clone();
                s.v[k] += h;
                self.run_function("constraint_rates", &s)
            };
            self.assert_close_entries(
                "Jacobian",
                &jacobian[k * nc..(k + 1) * nc],
                &sixth_order_difference(constraint_rates_at_changed_velocity),
                1.0,
            );
        }
        let rates = self.run_function("constraint_rates", s);
        let residuals = sixth_order_difference(|h| {
            self.run_function("constraint_residuals", &self.state_after_time(s, h))
        });
        self.assert_close_entries("rates", &rates[..residuals.len()], &residuals, 1.0);
        let free = State { a: vec![0.0; nv], ..s.clone() };
        let bend = second_derivative(|h| {
            self.run_function("constraint_residuals", &self.state_after_time(&free, h))
        });
        self.assert_close_entries("bias", &self.run_function("constraint_bias", s)[..bend.len()], &bend, 1.0);
        if !self.row.charts.contains('b') && !self.row.charts.contains('f') {
            let change = sixth_order_difference(|h| {
                self.run_function("constraint_rates", &self.state_after_time(&free, h))
            });
            self.assert_close_entries("bias of all", &self.run_function("constraint_bias", s), &change, 1.0);
        }
    }

    /// Checks `M v̇ + h = τ + Jᵀ λ` and `J v̇ + b = 0`.
    fn check_equations_of_motion(&self, s: &State) {
        let nv = s.v.len();
        let constrained = self.has_function("constraint_jacobian");
        let found =
            self.run_function(if constrained { "__constrained_dynamics" } else { "forward_dynamics" }, s);
        let a = found[..nv].to_vec();
        let most = a.iter().fold(1.0_f64, |m, a| m.max(a.abs()));
        let mut forces = self.run_function("inverse_dynamics", &State { a: a.clone(), ..s.clone() });
        if constrained {
            let (jacobian, bias) =
                (self.run_function("constraint_jacobian", s), self.run_function("constraint_bias", s));
            let nc = bias.len();
            let left: Vec<f64> = (0..nc)
                .map(|i| bias[i] + (0..nv).map(|k| jacobian[k * nc + i] * a[k]).sum::<f64>())
                .collect();
            self.assert_close_entries("constraints on accelerations", &left, &vec![0.0; nc], most);
            let lambda = &found[nv..nv + nc];
            let most = lambda.iter().fold(most, |m, l| m.max(l.abs()));
            for (k, force) in forces.iter_mut().enumerate() {
                *force -= (0..nc).map(|i| jacobian[k * nc + i] * lambda[i]).sum::<f64>();
            }
            return self.assert_close_entries("forces of accelerations", &forces, &s.tau, most);
        }
        self.assert_close_entries("forces of accelerations", &forces, &s.tau, most);
    }

    fn check_derivatives(&self, s: &State) {
        if !self.has_function("inverse_dynamics_derivatives") {
            return;
        }
        let nv = s.v.len();
        let mut expected = Vec::new();
        for k in 0..nv {
            expected.extend(sixth_order_difference(|h| {
                self.run_function("inverse_dynamics", &self.state_displaced_along_velocity(s, k, h))
            }));
        }
        for k in 0..nv {
            expected.extend(sixth_order_difference(|h| {
                let mut s = s.clone();
                s.v[k] += h;
                self.run_function("inverse_dynamics", &s)
            }));
        }
        self.assert_close_entries(
            "derivatives",
            &self.run_function("inverse_dynamics_derivatives", s),
            &expected,
            10.0,
        );
    }
}
