//! Compares the printed equations, and the polynomials behind them, with two other derivations at random
//! states.

use super::*;
use crate::algebra::polynomial::tests::Random;
use crate::diag::Diagnostics;
use crate::expr::eval::eval;
use crate::expr::{Graph, Rotation, Vec3};
use crate::lower::lower;
use crate::mechanics::{crba, lagrange};
use crate::mechanism::{Chart, Motion, Pose, SuppliedQuantity};
use std::path::Path;

mod inertia;
mod kane;
mod latex;
mod linear;
mod mathml;
mod mechanisms;
mod random;
mod reading;
mod routh;

use mechanisms::*;
use reading::text::evaluate_text;

fn call_with_parsed_model<R>(gravity: &str, item: &str, f: impl for<'g> FnOnce(Model<'g>) -> R) -> R {
    let mut cx = Diagnostics::new();
    let arguments = format!("gravity = {gravity}").parse().unwrap();
    let source = crate::parse_source_and_import(arguments, item.parse().unwrap(), Path::new(""), &mut cx);
    let (graph, source) = (Graph::new(), source.expect("a struct"));
    let model = crate::resolve::build_model(&source.mechanism.description, &graph, &mut cx);
    f(model.unwrap_or_else(|| panic!("{:?}", cx.full_message_texts())))
}

fn equations_text(gravity: &str, item: &str) -> String {
    call_with_parsed_model(gravity, item, |model| crate::equations_as_text(&model))
}

/// Returns a function that assigns a random number to every symbol. Quaternions have unit length.
fn random_symbol_values(model: &Model<'_>, seed: u64) -> impl Fn(Symbol) -> f64 + use<> {
    let mut r = Random(seed * 2 + 1);
    let mut numbers = |n: usize| -> Vec<f64> {
        (0..n).map(|_| r.random_number_below(2000) as f64 / 1000.0 - 1.0).collect()
    };
    let parameters: Vec<f64> = numbers(model.parameters.len()).iter().map(|p| p + 1.5).collect();
    let mut q = numbers(model.nq());
    for first in model.charts.iter().filter_map(Chart::first_quaternion_index) {
        let norm = q[first.range_of_entries(4)].iter().map(|x| x * x).sum::<f64>().sqrt();
        q[first.range_of_entries(4)].iter_mut().for_each(|x| *x /= norm);
    }
    let (v, a, u) = (numbers(model.nv()), numbers(model.nv()), numbers(model.nu()));
    let multipliers = numbers(model.constraints.len());
    move |symbol| match Quantity::from_symbol(symbol) {
        Quantity::Parameter(k) => parameters[k],
        Quantity::Configuration(k) => q[k],
        Quantity::Velocity(k) => v[k],
        Quantity::Acceleration(k) => a[k],
        Quantity::Input(k) => u[k],
        Quantity::Given(SuppliedQuantity::Multiplier, k) => multipliers[k],
        Quantity::Time => 0.7,
        Quantity::Force(k) => 0.3 * k as f64 - 1.0,
        other => panic!("{other:?} in the equations"),
    }
}

fn assert_near(a: &[f64], b: &[f64], what: &str) {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(1.0_f64, |size, b| size.max(b.abs()));
    let near = a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-10 * size);
    assert!(near, "{what}: {a:?} instead of {b:?}");
}

/// Returns the values of the symbols of a mechanism by their printed names.
fn value_lookup_by_name<'a>(
    model: &'a Model<'_>,
    at: &'a dyn Fn(Symbol) -> f64,
) -> impl Fn(&str) -> f64 + 'a {
    let rates = written::coordinate_rate_velocity_flags(model);
    let quantities_with_indices_below = |n: usize, quantity: fn(usize) -> Quantity| (0..n).map(quantity);
    let quantities = quantities_with_indices_below(model.parameters.len(), Quantity::Parameter)
        .chain(quantities_with_indices_below(model.nq(), Quantity::Configuration))
        .chain(quantities_with_indices_below(model.nv(), Quantity::Velocity))
        .chain(quantities_with_indices_below(model.nv(), Quantity::Acceleration))
        .chain(quantities_with_indices_below(model.nu(), Quantity::Input))
        .chain(quantities_with_indices_below(model.constraints.len(), |k| {
            Quantity::Given(SuppliedQuantity::Multiplier, k)
        }))
        .chain(quantities_with_indices_below(model.nv(), Quantity::Force))
        .chain([Quantity::Time]);
    let named: Vec<(String, Symbol)> = quantities
        .map(|q| {
            let (name, dots) = written::name_and_derivative_order(model, &rates, q.symbol());
            (name + &"'".repeat(usize::from(dots)), q.symbol())
        })
        .collect();
    move |word| match named.iter().find(|(name, _)| name == word) {
        Some((_, symbol)) => at(*symbol),
        None => panic!("the name {word}"),
    }
}

/// Returns the left and right side of each equation of a printed text, without the legend.
fn sides_of_equations(text: &str) -> Vec<(String, String)> {
    let (text, _) = text.trim_end().rsplit_once("\n\n").expect("a legend");
    let joined = text.replace("\n    ", " ");
    let lines = joined.lines().filter_map(|line| line.split_once(" = "));
    lines.map(|(left, right)| (left.to_string(), right.to_string())).collect()
}

/// Checks that the printed equations have the values of the polynomials.
fn check_values_of_printed_equations(model: &Model<'_>, e: &EquationsOfMotion) {
    let text = format_equations(model, e).plain;
    let lines = sides_of_equations(&text);
    assert_eq!(lines.len(), 1 + e.motion.len(), "{text}");
    for seed in 1..4 {
        let symbol = random_symbol_values(model, seed);
        let names = value_lookup_by_name(model, &symbol);
        let read: Vec<f64> =
            lines.iter().flat_map(|(a, b)| [a, b]).skip(1).map(|side| evaluate_text(side, &names)).collect();
        let sides = e.motion.iter().zip(&e.forces).flat_map(|(a, b)| [a, b]);
        let sides: Vec<f64> = [&e.lagrangian]
            .into_iter()
            .chain(sides)
            .map(|p| e.ring.evaluate_polynomial(p, &symbol))
            .collect();
        let size = sides.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
        for ((read, expected), k) in read.iter().zip(&sides).zip(0..) {
            // Numbers are printed with six digits.
            assert!((read - expected).abs() < 1e-5 * size, "{k}: {read}, {expected}: {text}");
        }
    }
}

/// Compares motion, forces, constraints and Lagrangian with the lowered programs of the recursive algorithms,
/// and the motion with Lagrange's equations.
fn check_against_recursive_algorithms(model: &Model<'_>) {
    let joints = crate::kinematics::joints_of_model(model);
    let mass = crba::mass_matrix(model, &joints);
    let e = derive(model, &joints, &mass, None, &EquationSizeLimits::READABLE).expect("small");
    let (v, a) = (velocity_symbols(model), acceleration_symbols(model));
    let mut outputs = rnea::inverse_dynamics(model, &joints, &v, Some(&a));
    outputs.extend(model.constraints.iter().map(|c| c.residual.unwrap_or(c.rate)));
    outputs.extend(right_sides(model, &joints));
    outputs.extend(model.constraints.iter().map(|_| model.graph.zero()));
    let kinetic = energy::kinetic_energy(model, &joints, &v);
    outputs.push(kinetic - energy::potential_energy(model, &joints));
    let program = lower(&outputs);
    let by_lagrange = lagrange::derive(model, &joints);
    let rows = by_lagrange.mass_matrix.iter().zip(&by_lagrange.bias);
    let rows = rows.map(|(row, h)| row.iter().zip(&a).fold(*h, |sum, (m, a)| sum + *m * *a));
    let rows: Vec<Expr<'_>> = rows.collect();
    for seed in 1..20 {
        let symbol = random_symbol_values(model, seed);
        let value_of_polynomial = |p: &Polynomial| e.ring.evaluate_polynomial(p, &symbol);
        let all: Vec<f64> =
            e.motion.iter().chain(&e.forces).chain([&e.lagrangian]).map(value_of_polynomial).collect();
        assert_near(&all, &program.interpret_program(&symbol), &model.name);
        assert_near(&all[..model.nv()], &eval(&rows, &symbol), "Lagrange");
    }
    check_values_of_printed_equations(model, &e);
}

#[test]
fn printed_normal_forms_equal_generated_functions() {
    for item in [CART_POLE, NUMBERS] {
        call_with_parsed_model("-9.81 * z", item, |model| check_against_recursive_algorithms(&model));
        call_with_parsed_model("-9.81 * y", item, |model| check_against_recursive_algorithms(&model));
    }
    for item in [DOUBLE_PENDULUM, GYROSCOPE, SHAFT, SPHERICAL, CHAIN, BALL, TRIPLE, ARM, WAGON] {
        call_with_parsed_model("-g * z", item, |model| check_against_recursive_algorithms(&model));
        call_with_parsed_model("-g * y", item, |model| check_against_recursive_algorithms(&model));
    }
}

/// Places the tip of a link at the position `place`, rotated by `angle` about z.
fn set_link_placement<'g>(model: &mut Model<'g>, link: usize, place: [Expr<'g>; 3], angle: Expr<'g>) {
    model.links[link].motion = Motion::Placed;
    model.links[link].parent = None;
    model.links[link].placement =
        Pose { rotation: Rotation::rotation_about_coordinate_axis(2, angle), translation: Vec3(place) };
}

/// Describes each rod of a double pendulum by its angle from the vertical.
#[test]
fn double_pendulum_in_absolute_angles_prints_correctly() {
    let text = call_with_parsed_model("-g * y", DOUBLE_PENDULUM, |mut model| {
        let g = model.graph;
        let [a, b] = [0, 1].map(|k| Quantity::Configuration(k).expr(g));
        let length = Quantity::Parameter(3).expr(g);
        set_link_placement(&mut model, 1, [length * a.sin(), -(length * a.cos()), g.zero()], b);
        model.inputs.clear();
        check_against_recursive_algorithms(&model);
        crate::equations_as_text(&model)
    });
    let first = "l1 (l1 (1/3 m1 + m2) shoulder''
    + 1/2 m2 l2 (cos(shoulder - elbow) elbow'' + sin(shoulder - elbow) elbow'²)
    + g (1/2 m1 + m2) sin(shoulder)) = 0";
    assert!(text.contains(first), "{text}");
}

/// A bead on a hoop that rotates about the vertical at a prescribed speed.
#[test]
fn driven_hoop_prints_time_dependent_equations() {
    let text = call_with_parsed_model("-g * z", HOOP, |mut model| {
        model.parameters = ["g", "m", "radius", "speed"].map(String::from).to_vec();
        let g = model.graph;
        let [radius, speed] = [2, 3].map(|k| Quantity::Parameter(k).expr(g));
        let (theta, turn) = (Quantity::Configuration(0).expr(g), speed * Quantity::Time.expr(g));
        let out = radius * theta.sin();
        set_link_placement(
            &mut model,
            0,
            [out * turn.cos(), out * turn.sin(), -(radius * theta.cos())],
            g.zero(),
        );
        check_against_recursive_algorithms(&model);
        crate::equations_as_text(&model)
    });
    let expected = "\
L = 1/2 m radius² theta'² + 1/2 m radius² speed² sin²(theta) + g m radius cos(theta)

m radius (radius theta'' + (g - radius speed² cos(theta)) sin(theta)) = 0
";
    assert!(text.starts_with(expected), "{text}");
}

/// Checks that the length of the equations decides whether they are printed, not the number of velocities.
#[test]
fn equation_length_decides_what_is_printed() {
    let text = equations_text("-g * z", &masses_with_springs(5));
    assert!(text.contains("m x2'' + k (2 x2 - x1 - x3) = 0\n"), "{text}");
    let text = equations_text("-g * z", &masses_with_springs(20));
    assert!(text.contains("m x19'' + k (x19 - x18) = 0\n"), "{text}");
    let text = equations_text("-g * z", FREE);
    assert!(text.contains("a pose.wx' + (c - b) pose.wy pose.wz = 0\n"), "{text}");
    let text = equations_text("-g * z", DISK);
    assert!(text.contains("1/4 m radius² (pose.wz' + pose.wx pose.wy)\n"), "{text}");
    let text = equations_text("-g * z", SPHERE);
    assert!(text.contains("\n-radius + pose.z = 0\n"), "{text}");
    for item in [
        masses_with_springs(5),
        masses_with_springs(20),
        FREE.to_string(),
        SPHERE.to_string(),
        DISK.to_string(),
    ] {
        call_with_parsed_model("-g * z", &item, |model| check_against_recursive_algorithms(&model));
    }
}

/// Checks that the legend explains each multiplier by the name of its constraint.
#[test]
fn legend_names_the_constraint_of_each_multiplier() {
    let text = equations_text("-g * z", SPHERE);
    let sentence = "lambda1, lambda2 and lambda3 are the multipliers of the constraints contact.normal,
contact.x and contact.y, in this order.
";
    assert!(text.ends_with(sentence), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

/// The axle fixes the wheel's height, so that the normal constraint is trivial. Its row is zero up to
/// rounding and is dropped.
#[test]
fn trivial_constraint_rows_are_dropped() {
    let text = equations_text("-9.81 * z", CASTOR);
    assert!(
        !text.contains("0 = 0") && text.contains("plane.x' - 0.3 cos(plane.angle) roll' = 0\n"),
        "{text}"
    );
    let speeds_formulation_arguments =
        || "gravity = -9.81 * z, formulation = speeds, derivatives".parse().unwrap();
    assert_eq!(
        crate::check_mechanism(speeds_formulation_arguments(), CASTOR.parse().unwrap(), Path::new("")),
        [""; 0]
    );
    // A contact that can never close is reported, however small its row is.
    let hovering = CASTOR.replace("0.3 * z", "0.4 * z");
    let messages =
        crate::check_mechanism(speeds_formulation_arguments(), hovering.parse().unwrap(), Path::new(""));
    assert!(
        messages.len() == 1 && messages[0].contains("`contact.normal` cannot be satisfied"),
        "{messages:?}"
    );
}

#[test]
fn printed_numbers_follow_one_rule() {
    let text = equations_text("-9.81 * z", TURNS);
    for part in ["coil (q - pi/2)", "1/(4 pi²) m lead²", "3/2 q''"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn large_mechanisms_print_no_equations() {
    assert_eq!(equations_text("-9.81 * z", SKEW), "");
    let (mut bodies, mut parent) = (String::new(), "ground".to_string());
    for k in 0..5 {
        bodies += &format!(
            "#[body(mass = 1, com = x)] b{k}: Body, #[joint({parent} -> b{k}, about = z)] j{k}: Pin,"
        );
        parent = format!("b{k}.at(x)");
    }
    assert_eq!(equations_text("-9.81 * y", &format!("struct Five {{ {bodies} }}")), "");
}

#[test]
fn cart_pole_equations_are_printed_as_text() {
    let expected = "\
L = 1/2 (cart_mass + pole_mass) rail'²
    + 1/2 pole_mass pole_length (1/3 pole_length hinge'² - cos(hinge) rail' hinge')
    - 4.905 pole_mass pole_length cos(hinge)

(cart_mass + pole_mass) rail''
    - 1/2 pole_mass pole_length (cos(hinge) hinge'' - sin(hinge) hinge'²)
    + rail_damping rail' = push
pole_mass pole_length (1/3 pole_length hinge'' - 1/2 cos(hinge) rail'' - 4.905 sin(hinge)) = 0

L is kinetic less potential energy; rail' and rail'' are the first and second rates of rail.
";
    assert_eq!(equations_text("-9.81 * y", CART_POLE), expected);
}

#[test]
fn slider_on_shaft_equations_are_printed_as_text() {
    let expected = "\
L = 1/2 (shaft_inertia + mass slide²) turn'² + 1/2 mass slide'²
    - 1/2 stiffness (slide - free_length)² - g mass slide sin(turn)

(shaft_inertia + mass slide²) turn'' + mass slide (2 turn' slide' + g cos(turn)) = motor
mass (slide'' - slide turn'² + g sin(turn)) + damping slide' + stiffness (slide - free_length) = 0

L is kinetic less potential energy; turn' and turn'' are the first and second rates of turn.
";
    assert_eq!(equations_text("-g * y", SHAFT), expected);
}

#[test]
fn gyroscope_equations_are_printed_as_text() {
    let expected = "\
(axial cos²(nutation) + (transverse + mass lever²) sin²(nutation)) precession''
    + axial cos(nutation) spin''
    + (2 (transverse - axial + mass lever²) cos(nutation) precession'
    - axial spin') sin(nutation) nutation' = 0
(transverse + mass lever²) nutation''
    + ((axial - transverse - mass lever²) cos(nutation) precession'² + axial precession' spin'
    - mass lever g) sin(nutation) = 0
axial (cos(nutation) precession'' + spin'' - sin(nutation) precession' nutation') = 0
";
    let text = equations_text("-g * z", GYROSCOPE);
    assert!(text.contains(expected), "{text}");
}

/// Checks the printed equations of a top: quaternion components, and angular velocities, which are not the
/// rates of these components.
#[test]
fn top_equations_are_printed_as_text() {
    let expected = "\
(m l² + a) tip.wx' + (c - m l² - a) tip.wy tip.wz - 2 g m l (tip.qx tip.qw + tip.qy tip.qz) = 0
(m l² + a) tip.wy' + (m l² + a - c) tip.wx tip.wz + 2 g m l (tip.qx tip.qz - tip.qy tip.qw) = 0
c tip.wz' = 0

L is kinetic less potential energy; tip.wx' is the rate of tip.wx.
";
    let text = equations_text("-g * z", BALL);
    assert!(text.ends_with(expected), "{text}");
}

/// Compares Hamilton's equations with velocities, energies and rates of the recursive algorithms.
fn check_hamiltons_equations(model: &Model<'_>) -> String {
    let joints = crate::kinematics::joints_of_model(model);
    let mass = crba::mass_matrix(model, &joints);
    let c = canonical_equations(model, &joints, &mass).expect("small");
    let v = velocity_symbols(model);
    let momenta = crate::mechanics::momentum::generalized_momentum(model, &joints, &v);
    let kinetic = energy::kinetic_energy(model, &joints, &v);
    let power = momenta.iter().zip(&v).fold(model.graph.zero(), |sum, (p, v)| sum + *p * *v);
    let mut expected = vec![power - kinetic + energy::potential_energy(model, &joints)];
    expected.extend(&v);
    let rate = crate::mechanics::momentum::momentum_rate_without_inputs(model, &joints, &v);
    let inputs = forces::generalized_forces_of_inputs(model, &joints);
    expected.extend(rate.into_iter().zip(inputs).map(|(rate, input)| rate + input));
    for seed in 1..10 {
        let symbol = random_symbol_values(model, seed);
        let p = eval(&momenta, &symbol);
        // Determinants contain no other determinants, but the ring evaluates all of its atoms.
        let symbol_value_with_unit_momenta = |s: Symbol| match Quantity::from_symbol(s) {
            Quantity::Momentum(_) | Quantity::Prepared(_) => 1.0,
            _ => symbol(s),
        };
        let determinants: Vec<f64> = c
            .determinants
            .iter()
            .map(|d| c.ring.evaluate_polynomial(d, &symbol_value_with_unit_momenta))
            .collect();
        let symbol_value_at_momenta = |s: Symbol| match Quantity::from_symbol(s) {
            Quantity::Momentum(k) => p[k],
            Quantity::Prepared(k) => determinants[k],
            Quantity::Velocity(_) | Quantity::Acceleration(_) => panic!("a velocity in Hamilton's form"),
            _ => symbol(s),
        };
        let all = [&c.hamiltonian].into_iter().chain(&c.velocity).chain(&c.momentum_rate);
        let found: Vec<f64> =
            all.map(|polynomial| c.ring.evaluate_polynomial(polynomial, &symbol_value_at_momenta)).collect();
        assert_near(&found, &eval(&expected, &symbol), &model.name);
    }
    let written = format_canonical_equations(model, &c);
    assert_eq!(latex::latex_errors(&written.latex), [""; 0], "{}", written.latex);
    written.plain
}

#[test]
fn hamiltons_equations_equal_generated_functions() {
    let text = call_with_parsed_model("-9.81 * y", CART_POLE, |model| check_hamiltons_equations(&model));
    for line in [
        "rail' = pole_mass pole_length (1/3 pole_length p_rail + 1/2 p_hinge cos(hinge))/D\n",
        "hinge' = (p_hinge (cart_mass + pole_mass) + 1/2 pole_mass pole_length p_rail cos(hinge))/D\n",
        "D = pole_mass pole_length² (1/3 (cart_mass + pole_mass) - 1/4 pole_mass cos²(hinge))\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
    for item in [DOUBLE_PENDULUM, GYROSCOPE, SPHERICAL, BALL, FREE, TRIPLE, ARM] {
        call_with_parsed_model("-g * z", item, |model| check_hamiltons_equations(&model));
        call_with_parsed_model("-g * y", item, |model| check_hamiltons_equations(&model));
    }
    // Euler's equations in terms of momenta.
    let text = call_with_parsed_model("-g * z", FREE, |model| check_hamiltons_equations(&model));
    assert!(text.contains("p_pose.wx' = p_pose.wy p_pose.wz (1/c - 1/b)\n"), "{text}");
    let text = call_with_parsed_model("-g * z", BALL, |model| check_hamiltons_equations(&model));
    assert!(text.contains("p_tip.wz' = 0\n") && !text.contains("D is"), "{text}");
}

#[test]
fn undefined_forms_of_equations_are_rejected() {
    let messages_for_form = |words: &str, item: &str| {
        let arguments = format!("gravity = -g * z, equations = {words}").parse().unwrap();
        crate::check_mechanism(arguments, item.parse().unwrap(), Path::new(""))
    };
    assert_eq!(messages_for_form("lagrange", SPHERE), [""; 0]);
    assert_eq!(messages_for_form("structure", SPHERE), [""; 0]);
    assert_eq!(messages_for_form("hamilton", FREE), [""; 0]);
    let rows = [
        ("hamilton", SPHERE.to_string(), "printed only for mechanisms without constraints"),
        ("routh", SPHERE.to_string(), "require a mechanism without constraints"),
        ("routh", BALL.to_string(), "no coordinate of this mechanism is cyclic"),
        ("lagrange", masses_with_springs(100), "have thousands of terms"),
        ("newton", SPHERE.to_string(), "unknown value `newton` for `equations`"),
    ];
    for (words, item, expected) in rows {
        let messages = messages_for_form(words, &item);
        assert!(messages.len() == 1 && messages[0].contains(expected), "{words}: {messages:?}");
        assert!(messages[0].contains("help"), "{messages:?}");
    }
}

/// Equations beyond the readable limits are printed on request, and are correct.
#[test]
fn long_equations_are_printed_on_request() {
    let arm = "pub struct Arm { g: f64, m: f64,
        #[body(mass = m, com = 0.5 * x, inertia = rod(m, 1, x))] a: Body,
        #[body(mass = m, com = 0.4 * x, inertia = rod(m, 0.8, x))] b: Body,
        #[body(mass = m, com = 0.3 * x, inertia = cuboid(m, 0.6, 0.1, 0.2))] c: Body,
        #[joint(ground -> a, about = z)] one: Pin,
        #[joint(a.at(x) -> b, about = y)] two: Pin,
        #[body(mass = m, com = 0.1 * z, inertia = cuboid(m, 0.2, 0.1, 0.3))] d: Body,
        #[joint(b.at(0.8 * x) -> c, about = z)] three: Pin,
        #[joint(c.at(0.6 * x) -> d, about = x)] four: Pin }";
    call_with_parsed_model("-g * z", arm, |model| {
        let joints = crate::kinematics::joints_of_model(&model);
        let mass = crba::mass_matrix(&model, &joints);
        assert!(derive(&model, &joints, &mass, None, &EquationSizeLimits::READABLE).is_none());
        let e =
            derive(&model, &joints, &mass, None, &EquationSizeLimits::ASKED).expect("not too long for that");
        let (v, a) = (velocity_symbols(&model), acceleration_symbols(&model));
        let forces = rnea::inverse_dynamics(&model, &joints, &v, Some(&a));
        for seed in 1..10 {
            let symbol = random_symbol_values(&model, seed);
            let found: Vec<f64> = e.motion.iter().map(|p| e.ring.evaluate_polynomial(p, &symbol)).collect();
            assert_near(&found, &eval(&forces, &symbol), "on request");
        }
        check_values_of_printed_equations(&model, &e);
    });
}
