//! The printed equations, and the polynomials behind them against both derivations at random states.

use super::*;
use crate::diag::Diagnostics;
use crate::expr::Graph;
use crate::expr::eval::eval;
use crate::expr::polynomial::tests::Random;
use crate::lower::lower;
use crate::mechanics::{crba, lagrange};
use std::path::Path;

mod mechanisms;

use mechanisms::*;

fn with_model<R>(gravity: &str, item: &str, f: impl FnOnce(&Model<'_>) -> R) -> R {
    let mut cx = Diagnostics::new();
    let arguments = format!("gravity = {gravity}").parse().unwrap();
    let source = crate::read(arguments, item.parse().unwrap(), Path::new(""), &mut cx);
    let (graph, source) = (Graph::new(), source.expect("a struct"));
    let model = crate::model::build_model(&source.mechanism.description, &graph, &mut cx);
    f(&model.unwrap_or_else(|| panic!("{:?}", cx.messages())))
}

fn equations_of(gravity: &str, item: &str) -> String {
    with_model(gravity, item, crate::equations)
}

/// A number for every symbol; quaternions are unit.
fn state(model: &Model<'_>, seed: u64) -> impl Fn(Symbol) -> f64 + use<> {
    let mut r = Random(seed * 2 + 1);
    let mut numbers = |n: usize| -> Vec<f64> { (0..n).map(|_| r.below(2000) as f64 / 1000.0 - 1.0).collect() };
    let parameters: Vec<f64> = numbers(model.parameters.len()).iter().map(|p| p + 1.5).collect();
    let mut q = numbers(model.nq());
    for chart in &model.charts {
        if let Chart::Ball(first, _) = chart {
            let norm = q[*first..first + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
            q[*first..first + 4].iter_mut().for_each(|x| *x /= norm);
        }
    }
    let (v, a, u) = (numbers(model.nv()), numbers(model.nv()), numbers(model.nu()));
    move |symbol| match Quantity::of(symbol) {
        Quantity::Parameter(k) => parameters[k],
        Quantity::Configuration(k) => q[k],
        Quantity::Velocity(k) => v[k],
        Quantity::Acceleration(k) => a[k],
        Quantity::Input(k) => u[k],
        other => panic!("{other:?} in the equations"),
    }
}

fn assert_near(a: &[f64], b: &[f64], what: &str) {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(1.0_f64, |size, b| size.max(b.abs()));
    let near = a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-10 * size);
    assert!(near, "{what}: {a:?} instead of {b:?}");
}

/// Motion, forces and Lagrangian against the recursive algorithms as lowered for generation, and motion against
/// Lagrange's equations.
fn check(gravity: &str, item: &str) {
    with_model(gravity, item, |model| {
        let joints = crate::mechanics::joints(model);
        let mass = crba::mass_matrix(model, &joints);
        let e = derive(model, &joints, &mass).expect("small");
        let (v, a) = (velocities(model), accelerations(model));
        let mut outputs = rnea::inverse_dynamics(model, &joints, &v, Some(&a));
        outputs.extend(forces::generalized_forces(model, &joints));
        let kinetic = energy::kinetic_energy(model, &joints, &v);
        outputs.push(kinetic - energy::potential_energy(model, &joints));
        let program = lower(&outputs).fused();
        let by_lagrange = lagrange::derive(model, &joints);
        let rows = by_lagrange.mass_matrix.iter().zip(&by_lagrange.bias);
        let rows = rows.map(|(row, h)| row.iter().zip(&a).fold(*h, |sum, (m, a)| sum + *m * *a));
        let rows: Vec<Expr<'_>> = rows.collect();
        for seed in 1..20 {
            let symbol = state(model, seed);
            let value = |p: &Polynomial| e.ring.evaluate(p, &symbol);
            let all: Vec<f64> = e.motion.iter().chain(&e.forces).chain([&e.lagrangian]).map(value).collect();
            assert_near(&all, &program.run(&symbol), &model.name);
            assert_near(&all[..model.nv()], &eval(&rows, &symbol), "Lagrange");
        }
    });
}

#[test]
fn normal_forms_are_what_is_generated() {
    for item in [CART_POLE, NUMBERS] {
        check("-9.81 * z", item);
        check("-9.81 * y", item);
    }
    for item in [DOUBLE_PENDULUM, GYROSCOPE, SHAFT, SPHERICAL, CHAIN, BALL, TRIPLE, ARM, WAGON] {
        check("-g * z", item);
        check("-g * y", item);
    }
}

#[test]
fn large_mechanisms_have_no_text() {
    assert_eq!(equations_of("-9.81 * z", SKEW), "");
    let (mut bodies, mut parent) = (String::new(), "ground".to_string());
    for k in 0..5 {
        bodies += &format!("#[body(mass = 1, com = x)] b{k}: Body, #[joint({parent} -> b{k}, about = z)] j{k}: Pin,");
        parent = format!("b{k}.at(x)");
    }
    assert_eq!(equations_of("-9.81 * y", &format!("struct Five {{ {bodies} }}")), "");
}

#[test]
fn show() {
    for (g, item) in [("-9.81 * y", CART_POLE), ("-g * y", DOUBLE_PENDULUM), ("-g * z", GYROSCOPE), ("-g * y", SHAFT),
        ("-g * z", SPHERICAL), ("-g * y", CHAIN), ("-g * z", BALL), ("-9.81 * z", NUMBERS), ("-g * y", TRIPLE), ("-g * z", ARM), ("-9.81 * z", SKEW), ("-g * y", WAGON)] {
        with_model(g, item, |model| {
            let joints = crate::mechanics::joints(model);
            let mass = crba::mass_matrix(model, &joints);
            let rn = rnea::inverse_dynamics(model, &joints, &velocities(model), None);
            let start = std::time::Instant::now();
            let text = crate::equations(model);
            println!("{}: {:?}\n{text}", model.name, start.elapsed());
            let _ = (rn, mass);
        });
    }
}
