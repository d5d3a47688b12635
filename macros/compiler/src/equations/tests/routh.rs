//! Compares Routh's reduction with accelerations of the unreduced mechanism, Lagrange's equations of the
//! Routhian, and closed forms.

use super::super::reduced::{format_routh_equations, routh_equations};
use super::*;
use crate::expr::eval::Tape;
use crate::mechanics::routh;

/// Mechanisms with cyclic coordinates: gravity, description, and names of the cyclic coordinates.
const ROWS: [(&str, &str, &[&str]); 5] = [
    ("-g * z", GYROSCOPE, &["precession", "spin"]),
    ("-9.81 * z", PENDULUM, &["phi"]),
    ("0 * x", FREE_CART, &["rail"]),
    ("-9.81 * z", GOVERNOR, &["shaft"]),
    ("0 * x", SPINNING, &["spin"]),
];

const PENDULUM: &str = "struct Pendulum { m: f64, l: f64, phi: Coordinate, theta: Coordinate,
    #[particle(mass = m, at = l * (sin(theta) * cos(phi) * x + sin(theta) * sin(phi) * y - cos(theta) * z))] bob: Particle }";

const FREE_CART: &str = "struct FreeCart { m: f64, l: f64, k: f64,
    #[body(mass = 2 * m)] cart: Body,
    #[body(mass = m, com = l / 2 * x, inertia = rod(m, l, x))] first: Body,
    #[body(mass = m, com = l / 2 * x, inertia = rod(m, l, x))] second: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> first, about = z)] one: Pin,
    #[joint(first.at(l * x) -> second, about = z)] two: Pin,
    #[acts(on = two, stiffness = k)] coil: Spring,
    #[acts(on = two)] motor: Torque, #[acts(on = rail)] push: Force }";

const GOVERNOR: &str = "struct Governor { m: f64, l: f64, c: f64, j: f64,
    #[body(mass = 1, inertia = diagonal(1, 1, j))] column: Body,
    #[body(mass = m, com = -l * z, inertia = sphere(m, l / 5))] arm: Body,
    #[joint(ground -> column, about = z)] shaft: Pin,
    #[joint(column -> arm, about = y)] hinge: Pin,
    #[acts(on = hinge, damping = c)] damper: Dashpot,
    #[acts(on = shaft)] motor: Torque }";

const SPINNING: &str = "struct Spinning { m: f64, k: f64,
    #[body(mass = m, inertia = diagonal(1, 1, 2))] wheel: Body, #[particle(mass = m)] slider: Particle,
    #[joint(ground -> wheel, about = z)] spin: Pin,
    #[joint(wheel -> slider, along = (x, y))] place: Stage,
    #[energy(k / 2 * (place.x * place.x + place.y * place.y))] coil: Potential }";

/// Returns the values of symbols in a state, with the given momenta and forces.
fn symbol_values_in_state<'a>(
    model: &Model<'_>,
    seed: u64,
    p: &'a [f64],
    tau: &'a [f64],
) -> impl Fn(Symbol) -> f64 + use<'a> {
    let symbol = random_symbol_values(model, seed);
    move |s| match Quantity::from_symbol(s) {
        Quantity::Momentum(k) => p[k],
        Quantity::Force(k) => tau[k],
        _ => symbol(s),
    }
}

/// Compares accelerations, velocities and Routhian with Lagrange's equations of the unreduced mechanism.
/// Returns the names of the cyclic coordinates.
pub(super) fn compare_routh_with_lagrange(model: &Model<'_>) -> Vec<String> {
    let joints = crate::kinematics::joints_of_model(model);
    let mass = crba::mass_matrix(model, &joints);
    let cyclic = routh::cyclic_coordinates(model, &joints);
    let reduced = routh::derive(model, &joints, &mass, cyclic.clone());
    let others: Vec<usize> = (0..model.nv()).filter(|k| !cyclic.contains(k)).collect();
    let momenta = crate::mechanics::momentum::generalized_momentum(model, &joints, &velocity_symbols(model));
    // Unreduced mechanism, by Lagrange's equations.
    let lagrange = lagrange::derive(model, &joints);
    let tau = crate::mechanics::generalized_force_symbols(model);
    let force = tau.iter().zip(&lagrange.bias).map(|(tau, bias)| *tau - *bias).collect();
    let whole = crate::mechanics::ldl::solve_symmetric(lagrange.mass_matrix, force, &joints);
    for seed in 1..12 {
        let tau: Vec<f64> = (0..model.nv()).map(|k| 0.3 * k as f64 - 0.4).collect();
        let p: Vec<f64> = eval(&momenta, &symbol_values_in_state(model, seed, &[], &tau));
        let p: Vec<f64> = cyclic.iter().map(|k| p[*k]).collect();
        let value = symbol_values_in_state(model, seed, &p, &tau);
        let expected = eval(&whole, &value);
        let expected: Vec<f64> = others.iter().map(|k| expected[*k]).collect();
        assert_near(&eval(&reduced.acceleration, &value), &expected, "accelerations");
        let v = eval(&velocity_symbols(model), &value);
        let v: Vec<f64> = cyclic.iter().map(|k| v[*k]).collect();
        assert_near(&eval(&reduced.velocity, &value), &v, "velocities");
        let power: f64 = p.iter().zip(&v).map(|(p, v)| p * v).sum();
        let lagrangian = lagrange.kinetic - lagrange.potential;
        assert_near(&eval(&[reduced.routhian], &value), &[eval(&[lagrangian], &value)[0] - power], "R");
    }
    cyclic.iter().map(|k| model.velocities[*k].0.clone()).collect()
}

#[test]
fn routh_reduced_motion_equals_the_full_motion() {
    for (gravity, item, names) in ROWS {
        assert_eq!(call_with_parsed_model(gravity, item, |model| compare_routh_with_lagrange(&model)), names);
    }
}

/// Chains of random links on a column that rotates freely about the direction of gravity.
#[test]
fn routh_reduction_of_random_chains_equals_the_full_motion() {
    let mut random = Random(77);
    (0..20).for_each(|_| _ = random.random_number_below(2));
    for length in [2, 3, 4, 2, 3, 4] {
        let mut random_number = || random.random_number_below(1000) as f64 / 500.0 - 1.0;
        let mut vector = || {
            format!(
                "({:.3} * x + {:.3} * y + {:.3} * z)",
                random_number(),
                random_number(),
                random_number() + 0.1
            )
        };
        let mut item = "struct Chain { m: f64,
            #[body(mass = m, com = 0.3 * x, inertia = cuboid(m, 0.2, 0.4, 0.6))] link0: Body,
            #[joint(ground -> link0, about = z)] column: Pin,"
            .to_string();
        for k in 1..length {
            item += &format!(
                "#[body(mass = {k} * m, com = 0.2 * {}, inertia = cuboid(m, 0.5, 0.3, 0.2))] link{k}: Body,
                #[joint(link{}.at({}) -> link{k}, about = unit({}))] joint{k}: Pin,",
                vector(),
                k - 1,
                vector(),
                vector()
            );
        }
        let found =
            call_with_parsed_model("-9.81 * z", &(item + "}"), |model| compare_routh_with_lagrange(&model));
        assert_eq!(found, ["column"]);
    }
}

/// Lagrange's equations hold for the Routhian in the noncyclic coordinates: `d/dt ∂R/∂v − ∂R/∂q` equals the
/// forces without a potential.
#[test]
fn lagranges_equations_hold_for_the_routhian() {
    for (gravity, item, _) in ROWS {
        call_with_parsed_model(gravity, item, |model| {
            let joints = crate::kinematics::joints_of_model(&model);
            let mass = crba::mass_matrix(&model, &joints);
            let cyclic = routh::cyclic_coordinates(&model, &joints);
            let reduced = routh::derive(&model, &joints, &mass, cyclic.clone());
            let g = model.graph;
            let routhian_derivative = |quantity: Quantity| {
                crate::expr::diff::DirectionalDerivative::with_respect_to(quantity.symbol(), g)
                    .differentiate(reduced.routhian)
            };
            let others: Vec<usize> = (0..model.nv()).filter(|k| !cyclic.contains(k)).collect();
            let momenta: Vec<Expr<'_>> =
                others.iter().map(|k| routhian_derivative(Quantity::Velocity(*k))).collect();
            let slopes: Vec<Expr<'_>> =
                others.iter().map(|k| routhian_derivative(Quantity::Configuration(*k))).collect();
            let all = crate::mechanics::passive::passive_forces(&model, true);
            let of_potentials = crate::mechanics::passive::passive_forces(&model, false);
            let lost: Vec<Expr<'_>> = others.iter().map(|k| all[*k] - of_potentials[*k]).collect();
            let (momenta, slopes, lost) = (Tape::new(&momenta), Tape::new(&slopes), Tape::new(&lost));
            let (acceleration, velocity) = (Tape::new(&reduced.acceleration), Tape::new(&reduced.velocity));
            for seed in 1..8 {
                let tau = vec![0.0; model.nv()];
                let p: Vec<f64> = (0..cyclic.len()).map(|k| 0.9 - 0.7 * k as f64).collect();
                let value = symbol_values_in_state(&model, seed, &p, &tau);
                let (a, w) = (acceleration.evaluate_at(&value), velocity.evaluate_at(&value));
                let momenta_after_time_step = |h: f64| {
                    let symbol_value_after_time_step = |s: Symbol| match Quantity::from_symbol(s) {
                        Quantity::Configuration(k) => {
                            let rate = cyclic
                                .iter()
                                .position(|c| *c == k)
                                .map_or_else(|| value(Quantity::Velocity(k).symbol()), |c| w[c]);
                            value(s) + h * rate
                        }
                        Quantity::Velocity(k) => {
                            value(s) + others.iter().position(|o| *o == k).map_or(0.0, |o| h * a[o])
                        }
                        _ => value(s),
                    };
                    momenta.evaluate_at(&symbol_value_after_time_step)
                };
                let h = 1e-3;
                let ((b, c), (d, e)) = (
                    (momenta_after_time_step(h), momenta_after_time_step(-h)),
                    (momenta_after_time_step(2.0 * h), momenta_after_time_step(-2.0 * h)),
                );
                let rate: Vec<f64> =
                    (0..b.len()).map(|k| (8.0 * (b[k] - c[k]) - (d[k] - e[k])) / (12.0 * h)).collect();
                let symbol_value_with_cyclic_velocities = |s: Symbol| match Quantity::from_symbol(s) {
                    Quantity::Velocity(k) => {
                        cyclic.iter().position(|c| *c == k).map_or_else(|| value(s), |c| w[c])
                    }
                    _ => value(s),
                };
                for ((rate, slope), lost) in rate
                    .iter()
                    .zip(slopes.evaluate_at(&value))
                    .zip(lost.evaluate_at(&symbol_value_with_cyclic_velocities))
                {
                    let size = 1.0 + rate.abs() + slope.abs();
                    assert!(
                        (rate - slope + lost).abs() < 1e-8 * size,
                        "{}: {rate} {slope} {lost}",
                        model.name
                    );
                }
            }
        });
    }
}

/// The printed polynomials have the values of the generated functions.
#[test]
fn printed_routhian_equals_generated_functions() {
    let mut texts = Vec::new();
    for (gravity, item, _) in ROWS {
        call_with_parsed_model(gravity, item, |model| {
            let joints = crate::kinematics::joints_of_model(&model);
            let mass = crba::mass_matrix(&model, &joints);
            let cyclic = routh::cyclic_coordinates(&model, &joints);
            let functions = routh::derive(&model, &joints, &mass, cyclic.clone());
            let printed = routh_equations(&model, &joints, &mass, cyclic.clone()).expect("small");
            let inputs = forces::generalized_forces_of_inputs(&model, &joints);
            let others: Vec<usize> = (0..model.nv()).filter(|k| !cyclic.contains(k)).collect();
            for seed in 1..8 {
                let p: Vec<f64> = (0..cyclic.len()).map(|k| 0.9 - 0.7 * k as f64).collect();
                let symbol = symbol_values_in_state(&model, seed, &p, &[]);
                let tau = eval(&inputs, &symbol);
                let symbol = symbol_values_in_state(&model, seed, &p, &tau);
                let a = eval(&functions.acceleration, &symbol);
                let symbol_value_with_unit_inertias = |s: Symbol| match Quantity::from_symbol(s) {
                    Quantity::Prepared(_) => 1.0,
                    _ => symbol(s),
                };
                let inertias: Vec<f64> = printed
                    .determinants
                    .iter()
                    .map(|d| printed.ring.evaluate_polynomial(d, &symbol_value_with_unit_inertias))
                    .collect();
                let symbol_value_with_accelerations = |s: Symbol| match Quantity::from_symbol(s) {
                    Quantity::Prepared(k) => inertias[k],
                    Quantity::Acceleration(k) => {
                        others.iter().position(|o| *o == k).map_or(f64::NAN, |o| a[o])
                    }
                    Quantity::Velocity(k) if cyclic.contains(&k) => f64::NAN,
                    _ => symbol(s),
                };
                let values_of_polynomials = |list: &[Polynomial]| -> Vec<f64> {
                    list.iter()
                        .map(|p| printed.ring.evaluate_polynomial(p, &symbol_value_with_accelerations))
                        .collect()
                };
                // The ring also evaluates atoms that no polynomial contains.
                assert_near(
                    &values_of_polynomials(&printed.motion),
                    &values_of_polynomials(&printed.forces),
                    &model.name,
                );
                assert_near(
                    &values_of_polynomials(&printed.velocity),
                    &eval(&functions.velocity, &symbol),
                    "velocities",
                );
                assert_near(
                    &values_of_polynomials(std::slice::from_ref(&printed.routhian)),
                    &eval(&[functions.routhian], &symbol),
                    "R",
                );
            }
            let written = format_routh_equations(&model, &printed);
            assert_eq!(latex::latex_errors(&written.latex), [""; 0], "{}", written.latex);
            texts.push(written.plain);
        });
    }
    for line in [
        "R = 1/2 m l² theta'² - 1/2 p_phi²/D + 9.81 m l cos(theta)\n",
        "phi' = p_phi/D\n",
        "p_phi is the momentum of the cyclic coordinate phi, and constant;",
    ] {
        assert!(texts[1].contains(line), "{line} in {}", texts[1]);
    }
    assert!(texts[3].contains("p_shaft' = motor\n"), "{}", texts[3]);
}
