//! Elements other than joints, on random mechanisms with all of them. The recursive algorithms and Lagrange's
//! equations agree, the power balance is satisfied, and output positions change at the rates that output
//! velocities and accelerations state.

mod random_world;

use linkwork_compiler::expr::diff::DirectionalDerivative;
use linkwork_compiler::expr::eval::eval;
use linkwork_compiler::expr::replace::substitute_symbols;
use linkwork_compiler::expr::sample::sample_of_symbol;
use linkwork_compiler::expr::{Expr, Symbol};
use linkwork_compiler::kinematics::{
    self, Joint, random_configuration, symbols_in, time_derivative, velocity_gradient,
};
use linkwork_compiler::mechanics;
use linkwork_compiler::mechanics::{crba, energy, lagrange, ldl, momentum, rnea};
use linkwork_compiler::mechanism::{Model, Quantity};
use linkwork_compiler::resolve::outline_of_description;
use linkwork_compiler::syntax::Description;
use proptest::prelude::*;
use random_world::{OUTPUTS, random_element_mechanisms};
use support::model::check_model_or_panic;
use support::random::property_test_config;

/// Tolerance relative to the largest entry of the reference.
const TOLERANCE: f64 = 1e-10;
/// Tolerance of derivatives against finite differences.
const DIFFERENCE: f64 = 1e-7;

/// Numbers for all symbols: a state, accelerations, inputs and time.
struct ValuesOfSymbols {
    q: Vec<f64>,
    v: Vec<f64>,
    seed: u64,
}

impl ValuesOfSymbols {
    fn new(model: &Model<'_>, seed: u64) -> ValuesOfSymbols {
        let v = (0..model.nv())
            .map(|k| 2.0 * (sample_of_symbol(Quantity::Velocity(k).symbol(), seed) - 1.0))
            .collect();
        ValuesOfSymbols { q: random_configuration(model, seed), v, seed }
    }

    fn values_of_expressions(&self, e: &[Expr<'_>]) -> Vec<f64> {
        self.values_of_expressions_after(0.0, &[], e)
    }

    /// Returns the values of expressions after a short time along the motion with the given rates of `q`, to
    /// first order.
    fn values_of_expressions_after(&self, time: f64, rates: &[f64], e: &[Expr<'_>]) -> Vec<f64> {
        let test_rate_of_symbol = |s: Symbol| 2.0 * (sample_of_symbol(s, self.seed) - 1.0);
        eval(e, &|s| match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => self.q[k] + rates.get(k).map_or(0.0, |r| time * r),
            Quantity::Velocity(k) => {
                self.v[k] + time * test_rate_of_symbol(Quantity::Acceleration(k).symbol())
            }
            Quantity::Time => test_rate_of_symbol(s) + time,
            _ => test_rate_of_symbol(s),
        })
    }

    /// Returns the rates of expressions along the motion, by differences.
    fn numeric_rates_of_expressions(&self, model: &Model<'_>, e: &[Expr<'_>]) -> Vec<f64> {
        let rates = self.values_of_expressions(&lagrange::configuration_rates(model));
        let values_after_step = |s: f64| self.values_of_expressions_after(s, &rates, e);
        let h = 1e-3;
        let (near, far) = (
            (values_after_step(h), values_after_step(-h)),
            (values_after_step(2.0 * h), values_after_step(-2.0 * h)),
        );
        (0..e.len()).map(|k| (8.0 * (near.0[k] - near.1[k]) - (far.0[k] - far.1[k])) / (12.0 * h)).collect()
    }
}

fn assert_close(what: &str, a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len(), "{what}");
    let scale = b.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() <= tolerance * scale, "{what}, entry {k}: {a} and {b}");
    }
}

/// Checks that the outline that is generated for a mechanism with errors has the signatures of the correct
/// mechanism.
fn check_outline_signatures(description: &Description, model: &Model<'_>) {
    let outline = outline_of_description(description);
    assert_eq!(outline.configuration, model.configuration);
    assert_eq!(outline.velocities, model.velocities.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
    assert_eq!(outline.inputs, model.inputs.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
    assert_eq!(outline.frames, model.frames.iter().map(|frame| frame.name.clone()).collect::<Vec<_>>());
    assert_eq!((outline.time, outline.velocity_inputs), (model.time, model.velocity_inputs));
    for (guess, output) in outline.outputs.iter().zip(&model.outputs) {
        let symbols: Vec<Quantity> =
            symbols_in(&output.values).into_iter().map(Quantity::from_symbol).collect();
        let output_uses_quantity = |f: fn(&Quantity) -> bool| symbols.iter().any(f);
        assert_eq!((&guess.name, guess.size), (&output.name, output.values.len()));
        assert_eq!(
            guess.uses.accelerations,
            output_uses_quantity(|q| matches!(q, Quantity::Acceleration(_))),
            "{}",
            guess.name
        );
        let velocities = guess.uses.velocities || guess.uses.accelerations;
        assert_eq!(
            velocities,
            output_uses_quantity(|q| matches!(q, Quantity::Velocity(_))),
            "{}",
            guess.name
        );
        assert_eq!(
            guess.uses.inputs,
            output_uses_quantity(|q| matches!(q, Quantity::Input(_))),
            "{}",
            guess.name
        );
    }
    assert_eq!(outline.outputs.len(), model.outputs.len());
}

/// Returns the expressions of the inverse dynamics `M x + h`.
fn apply_mass_and_bias<'g>(m: &crba::Matrix<'g>, x: &[Expr<'g>], h: &[Expr<'g>]) -> Vec<Expr<'g>> {
    m.iter().zip(h).map(|(row, h)| row.iter().zip(x).fold(*h, |sum, (m, x)| sum + *m * *x)).collect()
}

fn flatten_matrix_by_rows<'g>(m: &crba::Matrix<'g>) -> Vec<Expr<'g>> {
    m.iter().flatten().copied().collect()
}

fn derivative_of_expression<'g>(model: &Model<'g>, quantity: Quantity, e: Expr<'g>) -> Expr<'g> {
    DirectionalDerivative::with_respect_to(quantity.symbol(), model.graph).differentiate(e)
}

fn compare_dynamics_with_lagrange(model: &Model<'_>, seed: u64) {
    let state = ValuesOfSymbols::new(model, seed);
    let assert_close_expressions = |what: &str, a: &[Expr<'_>], b: &[Expr<'_>]| {
        assert_close(what, &state.values_of_expressions(a), &state.values_of_expressions(b), TOLERANCE);
    };
    let joints = kinematics::joints_of_model(model);
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let reference = lagrange::derive(model, &joints);
    let mass = crba::mass_matrix(model, &joints);
    let bias = rnea::inverse_dynamics(model, &joints, &v, None);
    let tau = rnea::inverse_dynamics(model, &joints, &v, Some(&a));
    assert_close_expressions(
        "mass matrix",
        &flatten_matrix_by_rows(&mass),
        &flatten_matrix_by_rows(&reference.mass_matrix),
    );
    assert_close_expressions("bias", &bias, &reference.bias);
    assert_close_expressions(
        "inverse dynamics",
        &tau,
        &apply_mass_and_bias(&reference.mass_matrix, &a, &reference.bias),
    );
    let kinetic = energy::kinetic_energy(model, &joints, &v);
    let potential = energy::potential_energy(model, &joints);
    assert_close_expressions("energies", &[kinetic, potential], &[reference.kinetic, reference.potential]);
    let p = momentum::generalized_momentum(model, &joints, &v);
    let expected: Vec<_> = (0..model.nv())
        .map(|k| derivative_of_expression(model, Quantity::Velocity(k), reference.kinetic))
        .collect();
    assert_close_expressions("momentum", &p, &expected);
    // The reference is ṗ = Ṗ(q, v, t) + M a with τ = M a + h.
    let rate = momentum::momentum_rate_without_inputs(model, &joints, &v);
    let expected: Vec<_> =
        p.iter().zip(&bias).map(|(p, h)| time_derivative(model.configuration_space(), *p) - *h).collect();
    assert_close_expressions("momentum rate", &rate, &expected);
    let r: Vec<_> = tau.iter().zip(&bias).map(|(t, h)| *t - *h).collect();
    assert_close_expressions("factorisation", &ldl::solve_symmetric(mass, r, &joints), &a);
    check_power_balance(model, &joints, &tau, &state);
}

/// Checks the power balance: Jacobi's integral `p · v − T + U` changes by the power of the forces minus
/// `∂L/∂t`.
fn check_power_balance<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    tau: &[Expr<'g>],
    state: &ValuesOfSymbols,
) {
    let g = model.graph;
    let v = mechanics::velocity_symbols(model);
    let dot_product =
        |a: &[Expr<'g>], b: &[Expr<'g>]| a.iter().zip(b).fold(g.zero(), |sum, (a, b)| sum + *a * *b);
    let kinetic = energy::kinetic_energy(model, joints, &v);
    let potential = energy::potential_energy(model, joints);
    let p = momentum::generalized_momentum(model, joints, &v);
    let jacobi = dot_product(&p, &v) - kinetic + potential;
    let velocity_differentiation =
        |e: Expr<'g>| velocity_gradient(e).iter().fold(g.zero(), |sum, (k, d)| sum + *d * v[*k]);
    let mut power = dot_product(tau, &v);
    for dashpot in &model.dashpots {
        power -= dashpot.damping * kinematics::coordinate_velocity(model, &dashpot.on).square();
    }
    for function in &model.dissipations {
        power -= velocity_differentiation(*function);
    }
    for load in &model.loads {
        let zero_for_inputs = |s| matches!(Quantity::from_symbol(s), Quantity::Input(_)).then(|| g.zero());
        power += substitute_symbols(load.force, &zero_for_inputs) * velocity_differentiation(load.rate);
    }
    let expected = power - derivative_of_expression(model, Quantity::Time, kinetic - potential);
    assert_close(
        "energy",
        &state.numeric_rates_of_expressions(model, &[jacobi]),
        &state.values_of_expressions(&[expected]),
        DIFFERENCE,
    );
}

/// Returns the expressions of the output with this name.
fn output_expressions<'g>(model: &Model<'g>, name: &str) -> Vec<Expr<'g>> {
    model.outputs.iter().find(|o| o.name == name).expect("every output is there").values.clone()
}

/// Checks that output velocities are the rates of output positions, and output accelerations the rates of
/// velocities, each in the axes in which the output is expressed.
fn check_rates_of_outputs(model: &Model<'_>, seed: u64) {
    let state = ValuesOfSymbols::new(model, seed);
    let assert_rate_of_output = |rate: &str, of: &str| {
        let slope = state.numeric_rates_of_expressions(model, &output_expressions(model, of));
        assert_close(
            rate,
            &state.values_of_expressions(&output_expressions(model, rate)),
            &slope,
            DIFFERENCE,
        );
    };
    for k in 1..=3 {
        assert_rate_of_output(&format!("v{k}"), &format!("r{k}"));
        assert_rate_of_output(&format!("a{k}"), &format!("v{k}"));
    }
    for k in 4..=6 {
        assert_rate_of_output(&format!("d{k}"), &format!("w{k}"));
    }
    let vector_output_values = |name: &str| {
        <[f64; 3]>::try_from(state.values_of_expressions(&output_expressions(model, name))).expect("a vector")
    };
    let w = vector_output_values("w4");
    for axis in ["x4", "y4", "z4"] {
        let e = vector_output_values(axis);
        let turning = [w[1] * e[2] - w[2] * e[1], w[2] * e[0] - w[0] * e[2], w[0] * e[1] - w[1] * e[0]];
        assert_close(
            axis,
            &turning,
            &state.numeric_rates_of_expressions(model, &output_expressions(model, axis)),
            DIFFERENCE,
        );
    }
    for name in OUTPUTS.map(|(name, ..)| name).into_iter().chain(["size"]) {
        let values = output_expressions(model, name);
        let total_time_derivative = |e: &Expr<'_>| {
            let moved = state.values_of_expressions(&[time_derivative(model.configuration_space(), *e)])[0];
            velocity_gradient(*e).iter().fold(moved, |sum, (k, d)| {
                sum + state.values_of_expressions(&[*d * Quantity::Acceleration(*k).expr(model.graph)])[0]
            })
        };
        let rates: Vec<f64> = values.iter().map(total_time_derivative).collect();
        // Accelerations are constant along this motion.
        assert_close(name, &rates, &state.numeric_rates_of_expressions(model, &values), DIFFERENCE);
    }
}

proptest! {
    #![proptest_config(property_test_config(32))]

    #[test]
    fn lagrange_and_recursive_algorithms_agree(world in random_element_mechanisms(), seed in 0_u64..1000) {
        check_model_or_panic(&world.element_mechanism_source(), |_, model|
            compare_dynamics_with_lagrange(model, seed));
    }

    #[test]
    fn place_derivatives_agree_with_their_velocities(world in random_element_mechanisms(),
        seed in 0_u64..1000) {
        check_model_or_panic(&world.element_mechanism_source(), |_, model| check_rates_of_outputs(model,
            seed));
    }

    #[test]
    fn outline_after_an_error_has_the_correct_signatures(world in random_element_mechanisms()) {
        check_model_or_panic(&world.element_mechanism_source(), check_outline_signatures);
    }
}
