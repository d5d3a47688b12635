//! Random mechanisms with one prescribed motion for each velocity: sums of coordinates, displacements between
//! points, or their rates, are functions of time. Accelerations follow from the prescribed motions alone, and
//! the multipliers are the residuals of Kane's equations.

use crate::kane::{self, PrescribedQuantity, State};
use crate::random::Random;
use crate::spec::{AttachmentPoint, GeneratorSettings, MechanismSpec, random_mechanism_spec};
use crate::words;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::{compile, parse_source_and_import};
use std::fmt::Write;
use std::path::Path;

/// Maximum difference, relative to the largest entry of the same kind.
const TOLERANCE: f64 = 1e-7;
/// Minimum pivot, relative to the largest entry. Mechanisms with smaller pivots are skipped.
const REGULAR: f64 = 1e-2;
const TIME: f64 = 0.4;

/// Prescribed motion: the quantity follows `c₀ + c₁ t + c₂ t²`, or its rate follows the rate of this
/// polynomial.
struct PrescribedMotion {
    measure: PrescribedQuantity,
    path: [f64; 3],
    by_rate: bool,
}

/// Checks the mechanism of a seed. Returns false if its prescribed motions are nearly dependent.
pub fn check_driven_mechanism(seed: u64) -> bool {
    let style = GeneratorSettings { bodies: 4, limbs: 0, decades: 0.3, noise: None };
    let mut spec = random_mechanism_spec(9_000_000 + seed, style);
    for body in &mut spec.bodies {
        // No prescribed motion constrains the coordinate of a slider.
        body.slider = None;
    }
    let (nq, nv) = kane::coordinate_and_velocity_counts(&spec);
    let mut random = Random::new(seed ^ 0xd41e);
    let drives: Vec<PrescribedMotion> = random_prescribed_motions(&spec, nv, &mut random);
    let mut list =
        |n: usize, bound: f64| -> Vec<f64> { (0..n).map(|_| random.uniform_number(bound)).collect() };
    let (mut q, v, tau) = (list(nq, 1.2), list(nv, 1.0), list(nv, 3.0));
    normalise_quaternions(&spec, &mut q);
    if !kane::are_cables_outside_surfaces(&spec, &q) || drives.len() != nv {
        return false;
    }
    let zero = vec![0.0; nv];
    let partial_rates_of_quantities = |k: usize| -> Vec<f64> {
        let unit: Vec<f64> = (0..nv).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
        let state = State::new(&q, &unit, &zero);
        drives
            .iter()
            .map(|drive| {
                kane::series_of_prescribed_quantity(&spec, &state, &drive.measure).first_time_derivative().re
            })
            .collect()
    };
    // Stored by rows.
    let columns: Vec<Vec<f64>> = (0..nv).map(partial_rates_of_quantities).collect();
    let jacobian: Vec<Vec<f64>> = (0..nv).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
    let state = State::new(&q, &v, &zero);
    let missing = drives.iter().map(|drive| {
        2.0 * drive.path[2]
            - kane::series_of_prescribed_quantity(&spec, &state, &drive.measure).second_time_derivative().re
    });
    let Some(a) = solve_linear_system(jacobian, missing.collect()) else { return false };
    let forces = kane::inverse_dynamics(&spec, &State::new(&q, &v, &a));
    let left = forces.iter().zip(&tau).map(|(force, tau)| force.re - tau);
    let Some(lambda) = solve_linear_system(columns, left.collect()) else { return false };
    for words in ["", ", derivatives", ", formulation = speeds"] {
        compare_with_oracle(&spec, &drives, words, (&q, &v, &tau), (&a, &lambda), seed);
    }
    true
}

fn normalise_quaternions(spec: &MechanismSpec, q: &mut [f64]) {
    let mut first = 0;
    for body in &spec.bodies {
        let (own, _) = body.kind.coordinate_and_velocity_counts();
        if own >= 4 {
            let quaternion = &mut q[first + own - 4..first + own];
            let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
            quaternion.iter_mut().for_each(|x| *x /= length);
        }
        first += own;
    }
}

/// Returns a prescribed motion for every velocity: of coordinates of a joint, some in combination with
/// others, or of points of its body if the joint has no coordinates.
fn random_prescribed_motions(spec: &MechanismSpec, nv: usize, random: &mut Random) -> Vec<PrescribedMotion> {
    let mut drives = Vec::new();
    let mut before: Vec<(usize, usize)> = Vec::new();
    for (k, body) in spec.bodies.iter().enumerate() {
        let (_, own) = body.kind.coordinate_and_velocity_counts();
        for i in 0..own {
            let plain = !body.kind.suffixes_of_actuatable_coordinates().is_empty();
            let is_way = !plain || random.index_below(4) == 0;
            let measure = if is_way {
                let mut at = [0.0; 3];
                at.iter_mut().for_each(|x| *x = 1.2 * random.uniform_number(1.0));
                let carrier = body.parent.filter(|_| random.index_below(2) == 0);
                PrescribedQuantity::Way(
                    AttachmentPoint { body: Some(k), at },
                    AttachmentPoint { body: carrier, at: [0.3; 3] },
                    random.index_below(3),
                )
            } else {
                let mut list = vec![(1.0, k, i)];
                if let Some(more) = before.len().checked_sub(1).map(|last| random.index_below(last + 1)) {
                    let (body, coordinate) = before[more];
                    list.push((random.uniform_number(0.8), body, coordinate));
                }
                before.push((k, i));
                PrescribedQuantity::Coordinates(list)
            };
            let path = [0.0; 3].map(|_| random.uniform_number(1.0));
            let by_rate = !is_way && random.index_below(3) == 0;
            drives.push(PrescribedMotion { measure, path, by_rate });
        }
    }
    debug_assert_eq!(drives.len(), nv);
    // Holonomic constraints precede velocity constraints.
    drives.sort_by_key(|drive| drive.by_rate);
    drives
}

/// Solves a linear system by elimination with complete pivoting. Returns `None` for a nearly singular matrix.
fn solve_linear_system(mut rows: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = rows.len();
    let largest = rows.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut order: Vec<usize> = (0..n).collect();
    for k in 0..n {
        let all = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let (i, j) = all.max_by(|a, b| rows[a.0][a.1].abs().total_cmp(&rows[b.0][b.1].abs()))?;
        if rows[i][j].abs() < REGULAR * largest.max(0.1) {
            return None;
        }
        rows.swap(k, i);
        right.swap(k, i);
        rows.iter_mut().for_each(|row| row.swap(k, j));
        order.swap(k, j);
        for i in k + 1..n {
            let factor = rows[i][k] / rows[k][k];
            let (upper, lower) = rows.split_at_mut(i);
            lower[0].iter_mut().zip(&upper[k]).for_each(|(x, own)| *x -= factor * own);
            right[i] -= factor * right[k];
        }
    }
    let mut found = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * found[order[j]]).sum();
        found[order[k]] = (right[k] - known) / rows[k][k];
    }
    Some(found)
}

fn compare_with_oracle(
    spec: &MechanismSpec,
    drives: &[PrescribedMotion],
    more: &str,
    (q, v, tau): (&[f64], &[f64], &[f64]),
    (a, lambda): (&[f64], &[f64]),
    seed: u64,
) {
    let (arguments, item) = words::mechanism_source(spec, "Driven", more);
    let mut item = item.trim_end().trim_end_matches('}').to_string();
    for (k, drive) in drives.iter().enumerate() {
        let coordinate_name = |(_, body, k): &(f64, usize, usize)| {
            format!("joint{body}{}", spec.bodies[*body].kind.suffixes_of_actuatable_coordinates()[*k])
        };
        let [start, speed, growth] = drive.path;
        let (kind, left, right) = match &drive.measure {
            PrescribedQuantity::Coordinates(list) if drive.by_rate => {
                let terms =
                    list.iter().map(|term| format!("({:?}) * rate({})", term.0, coordinate_name(term)));
                ("Nonholonomic", terms.collect::<Vec<_>>(), format!("{speed:?} + ({growth:?}) * 2 * t"))
            }
            measure => {
                let terms = match measure {
                    PrescribedQuantity::Coordinates(list) => list
                        .iter()
                        .map(|term| format!("({:?}) * {}", term.0, coordinate_name(term)))
                        .collect(),
                    PrescribedQuantity::Way(a, b, axis) => {
                        let axis = ["x", "y", "z"][*axis];
                        vec![format!(
                            "dot(r({} / {}), ground.{axis})",
                            words::attachment_point_text(a),
                            words::attachment_point_text(b)
                        )]
                    }
                };
                ("Holonomic", terms, format!("{start:?} + ({speed:?}) * t + ({growth:?}) * t * t"))
            }
        };
        let left = left.join(" + ");
        let _ = writeln!(item, "#[constraint({left} = {right})] drive{k}: {kind},");
    }
    item.push('}');
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let parse_tokens = |text: &str| text.parse().expect("the generated source is Rust");
    let source =
        parse_source_and_import(parse_tokens(&arguments), parse_tokens(&item), Path::new(""), &mut cx);
    let compiled = source.as_ref().and_then(|source| compile(source, &graph, &mut cx));
    let Some((model, output)) = compiled else {
        let messages = cx.full_message_texts();
        // Without sample configurations that satisfy the constraints, dependent speeds cannot be determined.
        assert!(
            more.contains("speeds") && messages.iter().all(|message| message.contains("do not determine")),
            "seed {seed}{more}: {}\n{item}",
            messages.join("\n")
        );
        return;
    };
    assert_eq!((model.freedom.velocities, model.constraints.len()), (0, v.len()), "seed {seed}\n{item}");
    let state_value_of_symbol = |symbol| match Quantity::from_symbol(symbol) {
        Quantity::Configuration(k) => q[k],
        Quantity::Velocity(k) => v[k],
        Quantity::Force(k) => tau[k],
        Quantity::Time => TIME,
        Quantity::Parameter(k) => mass_parameter_value(spec, &model.parameters[k]),
        other => panic!("seed {seed}: {other:?}"),
    };
    let passive = output.functions.iter().find(|f| f.name == "__passive_forces");
    let passive = passive.map_or(Vec::new(), |f| f.program.interpret_program(&state_value_of_symbol));
    let symbol_value_including_passive_forces = |s| match Quantity::from_symbol(s) {
        Quantity::PassiveForce(k) => passive[k],
        _ => state_value_of_symbol(s),
    };
    let f = output.functions.iter().find(|f| f.name == "__constrained_dynamics").expect("it is constrained");
    let found = f.program.interpret_program(&symbol_value_including_passive_forces);
    assert_close_entries(&format!("seed {seed}{more}: accelerations\n{item}"), &found[..v.len()], a);
    assert_close_entries(
        &format!("seed {seed}{more}: multipliers\n{item}"),
        &found[v.len()..2 * v.len()],
        lambda,
    );
}

/// Returns the value of a mass that is a parameter.
fn mass_parameter_value(spec: &MechanismSpec, name: &str) -> f64 {
    let body = name.strip_prefix("mass").and_then(|k| k.parse::<usize>().ok());
    spec.bodies[body.expect("masses alone are parameters")].mass
}

fn assert_close_entries(what: &str, found: &[f64], expected: &[f64]) {
    let size = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= TOLERANCE * size, "{what}: entry {k}: {a} instead of {b}");
    }
}
