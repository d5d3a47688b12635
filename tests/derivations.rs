//! Two derivations of the equations of motion agree: the recursive algorithms in link axes, and Lagrange's
//! equations from energies in the ground frame. The test cases are random trees with joints of every kind and
//! random bodies, parameters, springs, dashpots, inputs and states.

mod random_speeds;
mod random_tree;

use linkwork_compiler::expr::diff::DirectionalDerivative;
use linkwork_compiler::expr::eval::eval;
use linkwork_compiler::expr::sample::sample_of_symbol;
use linkwork_compiler::expr::{Expr, Graph, Mat3, Vec3};
use linkwork_compiler::kinematics::{self, Joint, random_configuration};
use linkwork_compiler::mechanics::{aba, crba, energy, forces, lagrange, ldl, momentum, rnea};
use linkwork_compiler::mechanism::{InputEffect, LinkId, Model, Quantity, SumOfLinkVectors};
use linkwork_compiler::{lower, mechanics};
use proptest::prelude::*;
use random_tree::random_trees;
use support::model::{check_model_or_panic, random_symbol_values};
use support::random::property_test_config;

/// Tolerance relative to the largest entry of the reference.
const TOLERANCE: f64 = 1e-10;

fn assert_same_expressions(what: &str, model: &Model<'_>, seed: u64, a: &[Expr<'_>], b: &[Expr<'_>]) {
    let at = random_symbol_values(model, seed);
    let (a, b) = (eval(a, &at), eval(b, &at));
    let scale = b.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    for (k, (a, b)) in a.iter().zip(&b).enumerate() {
        assert!((a - b).abs() <= TOLERANCE * scale, "{what}, entry {k}: {a} and {b} (seed {seed})");
    }
}

/// Returns the expressions of the inverse dynamics `M x + h`.
fn apply_mass_and_bias<'g>(m: &crba::Matrix<'g>, x: &[Expr<'g>], h: &[Expr<'g>]) -> Vec<Expr<'g>> {
    m.iter().zip(h).map(|(row, h)| row.iter().zip(x).fold(*h, |sum, (m, x)| sum + *m * *x)).collect()
}

fn flatten_matrix_by_rows<'g>(m: &crba::Matrix<'g>) -> Vec<Expr<'g>> {
    m.iter().flatten().copied().collect()
}

fn compare_dynamics_with_lagrange(model: &Model<'_>, seed: u64) {
    let joints = kinematics::joints_of_model(model);
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let reference = lagrange::derive(model, &joints);
    let mass = crba::mass_matrix(model, &joints);
    let bias = rnea::inverse_dynamics(model, &joints, &v, None);
    let tau = rnea::inverse_dynamics(model, &joints, &v, Some(&a));
    assert_same_expressions(
        "mass matrix",
        model,
        seed,
        &flatten_matrix_by_rows(&mass),
        &flatten_matrix_by_rows(&reference.mass_matrix),
    );
    assert_same_expressions("bias", model, seed, &bias, &reference.bias);
    assert_same_expressions(
        "inverse dynamics",
        model,
        seed,
        &tau,
        &apply_mass_and_bias(&reference.mass_matrix, &a, &reference.bias),
    );
    let kinetic = energy::kinetic_energy(model, &joints, &v);
    let potential = energy::potential_energy(model, &joints);
    assert_same_expressions(
        "energies",
        model,
        seed,
        &[kinetic, potential],
        &[reference.kinetic, reference.potential],
    );
    let p = momentum::generalized_momentum(model, &joints, &v);
    let zero = vec![model.graph.zero(); model.nv()];
    assert_same_expressions(
        "momentum",
        model,
        seed,
        &p,
        &apply_mass_and_bias(&reference.mass_matrix, &v, &zero),
    );
    check_momentum_rate(model, &joints, &p, &bias, seed);
    check_forward_dynamics(model, &joints, &mass, &tau, &bias, &a, seed);
    check_lowering(model, &tau, seed);
}

/// Checks the rate of the generalized momentum. From ṗ = Ṁ v + M a and τ = M a + h, the rate without τ is Ṁ v
/// − h, with Ṁ v found as the derivative of `M v` along the motion.
fn check_momentum_rate<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    p: &[Expr<'g>],
    h: &[Expr<'g>],
    seed: u64,
) {
    let rates = lagrange::configuration_rates(model);
    let mut expected: Vec<Expr<'g>> = h.iter().map(|h| -*h).collect();
    for (k, rate) in rates.iter().enumerate() {
        let mut d = DirectionalDerivative::with_respect_to(Quantity::Configuration(k).symbol(), model.graph);
        for (sum, p) in expected.iter_mut().zip(p) {
            *sum += d.differentiate(*p) * *rate;
        }
    }
    let rate = momentum::momentum_rate_without_inputs(model, joints, &mechanics::velocity_symbols(model));
    assert_same_expressions("momentum rate", model, seed, &rate, &expected);
}

fn check_forward_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &crba::Matrix<'g>,
    tau: &[Expr<'g>],
    bias: &[Expr<'g>],
    a: &[Expr<'g>],
    seed: u64,
) {
    let r: Vec<Expr<'g>> = tau.iter().zip(bias).map(|(t, h)| *t - *h).collect();
    let articulated = aba::inverse_mass_times_vector(model, joints, &r).expect("no coordinate is coupled");
    assert_same_expressions("articulated bodies", model, seed, &articulated, a);
    let factorised = ldl::solve_symmetric(mass.clone(), r, joints);
    assert_same_expressions("factorisation", model, seed, &factorised, a);
}

/// Checks that the lowered program and its fused form compute the values of the expression graph.
fn check_lowering(model: &Model<'_>, tau: &[Expr<'_>], seed: u64) {
    let q = random_configuration(model, seed);
    let test_number_of_symbol = |s| match Quantity::from_symbol(s) {
        Quantity::Configuration(k) => q[k],
        _ => sample_of_symbol(s, seed),
    };
    let direct = eval(tau, &test_number_of_symbol);
    let program = lower::lower(tau);
    let (plain, fused) = (
        program.interpret_program(&test_number_of_symbol),
        program.run_passes(lower::pipeline::PART).interpret_program(&test_number_of_symbol),
    );
    let scale = direct.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    for k in 0..direct.len() {
        assert!((plain[k] - direct[k]).abs() <= 1e-13 * scale, "{} and {}", plain[k], direct[k]);
        assert!((fused[k] - direct[k]).abs() <= 1e-12 * scale, "{} and {}", fused[k], direct[k]);
    }
}

/// Checks that the generalized forces are the derivatives of the inputs' power with respect to the
/// velocities. The power of a force is its product with the velocity of its point, which is found here by
/// differentiating the point's position in the ground frame.
fn check_forces_against_input_power<'g>(model: &Model<'g>, seed: u64) {
    let g = model.graph;
    let joints = kinematics::joints_of_model(model);
    let world = frames_in_ground(&joints, g);
    let mut power = g.zero();
    for (k, (_, input)) in model.inputs.iter().enumerate() {
        let u = Quantity::Input(k).expr(g);
        power += u * match input {
            InputEffect::Named => g.zero(),
            InputEffect::Coordinate(c) => kinematics::coordinate_velocity(model, c),
            InputEffect::Sum(terms, _) => {
                terms.iter().fold(g.zero(), |sum, c| sum + kinematics::coordinate_velocity(model, c))
            }
            InputEffect::Force { link, point, along } => {
                let (r, p) = &world[link.0];
                vector_in_ground(along, &world, g).dot(velocity_of_point(model, *p + *r * *point))
            }
            InputEffect::Torque { link, about } => {
                vector_in_ground(about, &world, g).dot(angular_velocity(model, &world[link.0].0))
            }
        };
    }
    let expected: Vec<Expr<'g>> = (0..model.nv())
        .map(|k| {
            DirectionalDerivative::with_respect_to(Quantity::Velocity(k).symbol(), g).differentiate(power)
        })
        .collect();
    assert_same_expressions(
        "inputs",
        model,
        seed,
        &forces::generalized_forces_of_inputs(model, &joints),
        &expected,
    );
}

fn frames_in_ground<'g>(joints: &[Joint<'g>], g: &'g Graph) -> Vec<(Mat3<'g>, Vec3<'g>)> {
    let mut world: Vec<(Mat3<'g>, Vec3<'g>)> = Vec::new();
    for joint in joints {
        let (r, p) = joint.parent.map_or((Mat3::identity(g), Vec3::zero(g)), |LinkId(p)| world[p]);
        world.push((r * joint.rotation.rotation_matrix(), p + r * joint.translation));
    }
    world
}

fn vector_in_ground<'g>(d: &SumOfLinkVectors<'g>, world: &[(Mat3<'g>, Vec3<'g>)], g: &'g Graph) -> Vec3<'g> {
    d.iter().fold(Vec3::zero(g), |sum, (link, v)| sum + link.map_or(*v, |l| world[l.0].0 * *v))
}

fn time_derivative<'g>(model: &Model<'g>, e: Expr<'g>) -> Expr<'g> {
    let rates = lagrange::configuration_rates(model);
    rates.iter().enumerate().fold(model.graph.zero(), |sum, (k, rate)| {
        sum + DirectionalDerivative::with_respect_to(Quantity::Configuration(k).symbol(), model.graph)
            .differentiate(e)
            * *rate
    })
}

fn velocity_of_point<'g>(model: &Model<'g>, p: Vec3<'g>) -> Vec3<'g> {
    p.map(|c| time_derivative(model, c))
}

/// Returns the angular velocity from `Ṙ Rᵀ = [ω]×`, in ground axes.
fn angular_velocity<'g>(model: &Model<'g>, r: &Mat3<'g>) -> Vec3<'g> {
    let rate = Mat3::from_fn(|i, j| time_derivative(model, r.0[i][j]));
    let w = rate * r.transpose();
    Vec3([w.0[2][1], w.0[0][2], w.0[1][0]])
}

proptest! {
    #![proptest_config(property_test_config(60))]

    #[test]
    fn lagrange_and_recursive_algorithms_agree(tree in random_trees(3), seed in 0_u64..1000) {
        check_model_or_panic(&tree.tree_source(), |_, model| compare_dynamics_with_lagrange(model, seed));
    }

    #[test]
    fn input_power_is_generalized_force_times_velocity(tree in random_trees(4), seed in 0_u64..1000) {
        check_model_or_panic(&tree.tree_source(), |_, model| check_forces_against_input_power(model, seed));
    }
}
