//! Lagrange multipliers and independent generalized speeds solve the same equations. The test cases are
//! random closed chains with planar and spatial joints, loops closed by every joint, and states on and off
//! the constraints. Both solutions are inserted into the equations.

use linkwork::__private::{Elimination, solution_with_predetermined_pivots};
use linkwork_compiler::expr::Expr;
use linkwork_compiler::expr::eval::eval;
use linkwork_compiler::expr::sample::sample_of_symbol;
use linkwork_compiler::kinematics::{self, random_configuration};
use linkwork_compiler::mechanics::{self, constraints, crba, rnea};
use linkwork_compiler::mechanism::{Model, Quantity};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::cell::Cell;
use std::fmt::Write;
use support::model::{check_model_or_return_errors, random_symbol_values};
use support::random::property_test_config;

/// Chain of bodies from the ground back to the ground, with the joint that closes it.
#[derive(Clone, Debug)]
struct ClosedChain {
    /// Axis and offset of each joint, and whether the joint slides.
    joints: Vec<([f64; 3], [f64; 3], bool)>,
    closing: usize,
    anchor: [f64; 3],
    planar: bool,
    /// Range of the masses in powers of ten, and the exponent of each mass.
    masses: (f64, [f64; 6]),
}

/// Types of joints that can close a loop, with their arguments.
const CLOSING: [(&str, &str); 7] = [
    ("Pin", ", about = z"),
    ("Ball", ""),
    ("Universal", ", about = (x, y)"),
    ("Sleeve", ", along = x"),
    ("Collar", ", about = z"),
    ("Slot", ", along = x, about = z"),
    ("Planar", ", about = z"),
];

impl ClosedChain {
    fn chain_source(&self, arguments: &str) -> (String, String) {
        let vector_text = |v: &[f64; 3]| format!("{:?} * x + {:?} * y + {:?} * z", v[0], v[1], v[2]);
        let mut item = String::from("struct Chain {\n");
        let mut parent = "ground".to_string();
        for (k, ((axis, offset, slide), share)) in self.joints.iter().zip(self.masses.1).enumerate() {
            let mass = 1.5 * 10_f64.powf(self.masses.0 * (share - 0.5));
            let axis = match self.planar {
                true => if *slide { "x" } else { "z" }.to_string(),
                false => format!("unit({})", vector_text(axis)),
            };
            let offset = if self.planar { [offset[0], offset[1], 0.0] } else { *offset };
            let (kind, key) = if *slide { ("Sleeve", "along") } else { ("Pin", "about") };
            let _ = writeln!(
                item,
                "#[body(mass = {mass:?}, com = {}, inertia = diagonal({mass:?} / 5, {mass:?} / 4, {mass:?} / \
                 3))] b{k}: Body,
                #[joint({parent}.at({}) -> b{k}, {key} = {axis})] j{k}: {kind},",
                vector_text(&offset.map(|x| x / 2.0)),
                vector_text(&offset)
            );
            parent = format!("b{k}");
        }
        let (kind, key) = CLOSING[if self.planar { 0 } else { self.closing % CLOSING.len() }];
        let anchor = if self.planar { [self.anchor[0], self.anchor[1], 0.0] } else { self.anchor };
        let _ = writeln!(
            item,
            "#[joint({parent}.at(0.4 * x) -> ground.at({}){key})] closing: {kind},\n}}",
            vector_text(&anchor)
        );
        (format!("gravity = -9.81 * y{arguments}"), item)
    }
}

fn random_chains() -> impl Strategy<Value = ClosedChain> {
    let random_direction = || prop::array::uniform3(-1.0..1.0_f64);
    let joint = (random_direction(), random_direction(), prop::bool::weighted(0.2))
        .prop_filter("a direction needs a length", |(axis, ..)| {
            axis.iter().map(|x| x * x).sum::<f64>() > 0.1
        });
    let masses = (prop_oneof![Just(0.0), Just(3.0), Just(12.0)], prop::array::uniform6(0.0..1.0_f64));
    let anchor = prop::array::uniform3(0.2..1.0_f64);
    (prop::collection::vec(joint, 3..=6), any::<usize>(), anchor, any::<bool>(), masses).prop_map(
        |(joints, closing, anchor, planar, masses)| ClosedChain { joints, closing, anchor, planar, masses },
    )
}

/// Calls `check` with the model, unless the chain cannot move or its speeds depend on each other.
fn check_model_unless_rejected(chain: &ClosedChain, arguments: &str, check: impl FnOnce(&Model<'_>)) {
    let source = chain.chain_source(arguments);
    if let Err(messages) = check_model_or_return_errors(&source, |_, model| check(model)) {
        let known = ["cannot move", "no configuration", "do not follow", "can never hold"];
        let is_expected_error_message = |m: &String| known.iter().any(|k| m.contains(k));
        assert!(messages.iter().all(is_expected_error_message), "{}\n{}", messages.join("\n"), source.1);
    }
}

/// Whether the runtime accepts the accelerations from independent speeds, or falls back to multipliers. It
/// compares the pivots of the elimination, which follow the accelerations and multipliers in `found`, with
/// their values before the elimination.
fn runtime_accepts_eliminated_accelerations(nv: usize, nc: usize, found: &[f64]) -> bool {
    fn has_independent_solution<const NC: usize>(found: &[f64]) -> bool {
        let block_of_found_values = |first: usize| core::array::from_fn(|k| found[first * NC + k]);
        let (pivots, before) = (block_of_found_values(1), block_of_found_values(2));
        let all = Elimination { accelerations: [], multipliers: block_of_found_values(0), pivots, before };
        solution_with_predetermined_pivots::<f64, 0, NC>(&all).is_some()
    }
    let found = &found[nv..];
    match nc {
        1 => has_independent_solution::<1>(found),
        2 => has_independent_solution::<2>(found),
        3 => has_independent_solution::<3>(found),
        4 => has_independent_solution::<4>(found),
        5 => has_independent_solution::<5>(found),
        6 => has_independent_solution::<6>(found),
        _ => panic!("a joint has at most six constraints, found {nc}"),
    }
}

/// Returns the number of test cases: `usual`, or the value of the variable `LINKWORK_ORACLE`.
fn test_case_count(usual: u32) -> u32 {
    std::env::var("LINKWORK_ORACLE").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

#[test]
fn both_formulations_satisfy_the_equations_of_motion() {
    let checked = Cell::new(0);
    let run = TestRunner::new(property_test_config(test_case_count(64))).run(
        &(random_chains(), 0..1000_u64),
        |(chain, seed)| {
            check_model_unless_rejected(&chain, ", formulation = speeds", |model| {
                let joints = kinematics::joints_of_model(model);
                let v = mechanics::velocity_symbols(model);
                let mass = crba::mass_matrix(model, &joints);
                let h = rnea::inverse_dynamics(model, &joints, &v, None);
                let tau = (0..model.nv()).map(|k| Quantity::Force(k).expr(model.graph));
                let force: Vec<Expr<'_>> = tau.zip(h).map(|(tau, h)| tau - h).collect();
                let (rows, bias) = (constraints::jacobian(model), constraints::constraint_biases(model));
                let by_multipliers =
                    constraints::solve_constrained_dynamics(&mass, &rows, force.clone(), bias.clone());
                let pivots = model.dependent.as_ref().expect("speeds were asked for");
                let by_speeds =
                    constraints::solve_by_independent_velocities(model, &mass, &force, bias.clone(), pivots);
                let (nv, nc) = (model.nv(), rows.len());
                let at = random_symbol_values(model, seed);
                let first = eval(&by_multipliers, &at);
                let second = eval(&by_speeds, &at);
                // Close to a singular configuration, or with nearly dependent speeds, small pivots exclude
                // the solution.
                let regular = (0..nc).all(|k| first[nv + nc + k] > 1e-4 * first[nv + 2 * nc + k]);
                let taken = runtime_accepts_eliminated_accelerations(nv, nc, &second);
                let m = eval(&mass.concat(), &at);
                let j = eval(&rows.concat(), &at);
                let (f, b) = (eval(&force, &at), eval(&bias, &at));
                for (what, found, taken) in [("multipliers", &first, regular), ("speeds", &second, taken)] {
                    if !taken {
                        continue;
                    }
                    let (a, lambda) = (&found[..nv], &found[nv..nv + nc]);
                    // The residual of an equation, and its largest term, which bounds the rounding error.
                    let sum_and_largest_term = |terms: &[f64]| {
                        (terms.iter().sum::<f64>().abs(), terms.iter().fold(0.0_f64, |s, x| s.max(x.abs())))
                    };
                    let terms_of_motion_equation = |i: usize| -> Vec<f64> {
                        let held = (0..nc).map(|c| -j[c * nv + i] * lambda[c]);
                        (0..nv).map(|k| m[i * nv + k] * a[k]).chain(held).chain([-f[i]]).collect()
                    };
                    let terms_of_constraint_equation = |c: usize| -> Vec<f64> {
                        (0..nv).map(|k| j[c * nv + k] * a[k]).chain([b[c]]).collect()
                    };
                    for equations in [
                        (0..nv).map(terms_of_motion_equation).collect::<Vec<_>>(),
                        (0..nc).map(terms_of_constraint_equation).collect(),
                    ] {
                        let sums: Vec<(f64, f64)> =
                            equations.iter().map(|terms| sum_and_largest_term(terms)).collect();
                        let (left, largest) =
                            sums.iter().fold((0.0_f64, 1.0_f64), |s, x| (s.0.max(x.0), s.1.max(x.1)));
                        assert!(left < 1e-8 * largest, "{what}: {sums:?} of {chain:?} at {seed}");
                    }
                }
                checked.set(checked.get() + usize::from(regular && taken));
            });
            Ok(())
        },
    );
    run.expect("no case fails");
    assert!(checked.get() > 20, "only {} chains were regular", checked.get());
}

proptest! {
    #![proptest_config(property_test_config(32))]

    /// Constraint velocities are the derivatives of the residuals along the motion, and biases are the
    /// derivatives of the constraint velocities at constant `v`.
    #[test]
    fn constraint_velocities_and_biases_are_time_derivatives(chain in random_chains(), seed in 0..1000_u64) {
        check_model_unless_rejected(&chain, "", |model| {
            let q = random_configuration(model, seed);
            let velocity_sample = |k: usize| {
                let symbol = Quantity::Velocity(k).symbol();
                4.0 * (sample_of_symbol(symbol, seed) - 1.0)
            };
            let values_of_expressions_after = |e: &[Expr<'_>], step: f64| eval(e, &|s|
                match Quantity::from_symbol(s) {
                Quantity::Configuration(k) => q[k] + step * velocity_sample(k),
                Quantity::Velocity(k) => velocity_sample(k),
                _ => 0.0,
            });
            let difference_quotients = |e: &[Expr<'_>]| -> Vec<f64> {
                let h = 1e-5;
                values_of_expressions_after(e, h).iter().zip(values_of_expressions_after(e, -h)).map(|(a,
                    b)| (a - b) / (2.0 * h)).collect()
            };
            let residuals = constraints::residuals(model);
            let rates = constraints::constraint_velocities(model);
            let largest_magnitude = |e: &[f64]| e.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
            for (derivative, of) in [
                (values_of_expressions_after(&rates, 0.0), difference_quotients(&residuals)),
                (values_of_expressions_after(&constraints::constraint_biases(model), 0.0),
                    difference_quotients(&rates)),
            ] {
                for (d, o) in derivative.iter().zip(&of) {
                    assert!((d - o).abs() < 1e-6 * largest_magnitude(&derivative), "{d} and {o} of {chain:?}");
                }
            }
        });
    }
}
