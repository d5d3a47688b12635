//! Random expressions of quantities with known units are accepted if and only if the units are consistent.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::{parse_source_and_import, resolve::build_model};
use std::path::Path;
use support::random::Random;

/// Physical dimension of a quantity, as exponents of metre, kilogram and second.
type Dimension = [i32; 3];

const PLAIN: Dimension = [0, 0, 0];
const FORCE: Dimension = [1, 1, -2];
const ENERGY: Dimension = [2, 1, -2];

/// Parameters, whose units `MACHINE` declares: products of their powers have every dimension.
const PARAMETERS: [(&str, Dimension); 7] = [
    ("l", [1, 0, 0]),
    ("m", [0, 1, 0]),
    ("w", [0, 0, -1]),
    ("k", [0, 1, -2]),
    ("c", [0, 1, -1]),
    ("n", PLAIN),
    ("j", [2, 1, 0]),
];

/// Expressions for quantities of the motion, such as coordinates and velocities, with their dimensions.
const MOTION: [(&str, Dimension); 12] = [
    ("rail", [1, 0, 0]),
    ("hinge", PLAIN),
    ("rate(rail)", [1, 0, -1]),
    ("rate(hinge)", [0, 0, -1]),
    ("t", [0, 0, 1]),
    ("dot(r(arm.at(x) / ground), y)", [1, 0, 0]),
    ("norm(v(arm / ground / ground))", [1, 0, -1]),
    ("dot(omega(arm / cart), z)", [0, 0, -1]),
    ("kinetic_energy(arm)", ENERGY),
    ("dot(momentum(cart), x)", [1, 1, -1]),
    ("sin(hinge)", PLAIN),
    ("moment_of_inertia(arm / ground, ground.z)", [2, 1, 0]),
];

/// Inputs, with the unit of their force or torque.
const INPUTS: [(&str, Dimension); 4] =
    [("push", FORCE), ("turn", ENERGY), ("pull", FORCE), ("lever", [0, 1, -2])];

/// Returns the source of a machine with an additional element.
fn machine_source(more: &str) -> String {
    format!(
        "struct Machine {{
        #[unit(m)] l: f64, #[unit(kg)] m: f64, #[unit(1 / s)] w: f64, #[unit(N / m)] k: f64,
        #[unit(kg / s)] c: f64, #[unit(1)] n: f64, #[unit(kg * m2)] j: f64,
        #[body(mass = 1)] cart: Body,
        #[body(mass = 1, com = x)] arm: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart -> arm, about = z)] hinge: Pin,
        #[acts(on = rail)] push: Force,
        #[acts(on = hinge)] turn: Torque,
        #[acts(on = arm, along = y)] pull: Force,
        #[acts(on = cart, along = l * x)] lever: Force,
        #[output(l * m * w * k * c * n * j)] all: Scalar,
        {more} }}"
    )
}

/// Returns the error messages for a machine with an additional element; each message is one string.
fn messages_for_element(more: &str) -> Vec<String> {
    let mut cx = Diagnostics::new();
    let source = parse_source_and_import(
        "".parse().unwrap(),
        machine_source(more).parse().unwrap(),
        Path::new(""),
        &mut cx,
    )
    .unwrap();
    build_model(&source.mechanism.description, &Graph::new(), &mut cx);
    cx.full_message_texts()
}

/// Returns a random integer from zero to `n − 1`.
fn random_index(n: usize, random: &mut Random) -> usize {
    ((random.uniform_number(0.5) + 0.5) * n as f64) as usize % n
}

fn multiply_by_dimension_power(a: Dimension, b: Dimension, power: i32) -> Dimension {
    std::array::from_fn(|k| a[k] + power * b[k])
}

fn pick_randomly<T: Copy>(from: &[T], random: &mut Random) -> T {
    from[random_index(from.len(), random)]
}

/// Returns a factor of this dimension: powers of the first three parameters.
fn factor_of_dimension(mut by: Dimension) -> String {
    let mut text = String::new();
    for (k, (name, unit)) in PARAMETERS.iter().take(3).enumerate() {
        let power = by[k] / unit[k];
        by = multiply_by_dimension_power(by, *unit, -power);
        let sign = if power > 0 { '*' } else { '/' };
        (0..power.abs()).for_each(|_| text.push_str(&format!(" {sign} {name}")));
    }
    assert_eq!(by, PLAIN);
    text
}

/// Returns a product of this dimension that contains a parameter, so that its numbers are dimensionless.
fn random_product_with_parameter(dimension: Dimension, depth: usize, random: &mut Random) -> String {
    let (mut text, mut has) = (String::from("n"), PLAIN);
    for _ in 0..random_index(3, random) {
        let (name, unit) = match random_index(4, random) {
            0 => pick_randomly(&INPUTS, random),
            1 | 2 => pick_randomly(&MOTION, random),
            _ => pick_randomly(&PARAMETERS, random),
        };
        let below = random_index(3, random) == 0;
        text = format!("{text} {} {name}", if below { '/' } else { '*' });
        has = multiply_by_dimension_power(has, unit, if below { -1 } else { 1 });
    }
    if random_index(2, random) == 0 {
        text = format!("{} * {text}", pick_randomly(&["0.6", "0.5", "9.81", "40", "2", "pi"], random));
    }
    text.push_str(&factor_of_dimension(multiply_by_dimension_power(dimension, has, -1)));
    match depth.checked_sub(1).map(|depth| (depth, random_index(6, random))) {
        Some((depth, 0)) => format!("{text} * sin({})", random_sum_text(PLAIN, depth, random)),
        Some((depth, 1)) => {
            let square = multiply_by_dimension_power(dimension, dimension, 1);
            format!("sqrt({})", random_sum_text(square, depth, random))
        }
        Some((depth, 2)) => format!("max({text}, {})", random_sum_text(dimension, depth, random)),
        Some((depth, 3)) => format!("{text} / ({})", random_sum_text(PLAIN, depth, random)),
        _ => text,
    }
}

/// Returns a term of this dimension: a product with a parameter, a number, or a quantity of the motion with a
/// coefficient.
fn random_term(dimension: Dimension, depth: usize, random: &mut Random) -> String {
    let with_coefficient = [MOTION.as_slice(), INPUTS.as_slice()].concat();
    match random_index(8, random) {
        0 => "0.7".to_string(),
        1 => format!("30 * {}", pick_randomly(&with_coefficient, random).0),
        2 => match with_coefficient.iter().find(|(_, unit)| *unit == dimension) {
            Some((name, _)) => name.to_string(),
            None => random_product_with_parameter(dimension, depth, random),
        },
        _ => random_product_with_parameter(dimension, depth, random),
    }
}

/// Returns the text of a random sum of terms of the given dimension; one term contains a parameter.
fn random_sum_text(dimension: Dimension, depth: usize, random: &mut Random) -> String {
    let mut text = random_product_with_parameter(dimension, depth, random);
    for _ in 0..random_index(3, random) {
        let sign = if random_index(2, random) == 0 { '+' } else { '-' };
        text = match random_index(2, random) {
            0 => format!("{text} {sign} {}", random_term(dimension, depth, random)),
            _ => format!("{} {sign} {text}", random_term(dimension, depth, random)),
        };
    }
    text
}

/// Returns a random dimension other than the given one.
fn random_other_dimension(dimension: Dimension, random: &mut Random) -> Dimension {
    loop {
        let other = std::array::from_fn(|k| dimension[k] + random_index(5, random) as i32 - 2);
        if other != dimension {
            return other;
        }
    }
}

/// Returns the text of a random sum in which one term has an inconsistent dimension.
fn sum_with_wrong_unit(dimension: Dimension, random: &mut Random) -> String {
    let (good, bad) = (
        random_sum_text(dimension, 1, random),
        random_product_with_parameter(random_other_dimension(dimension, random), 1, random),
    );
    match random_index(6, random) {
        0 => format!("{bad} + {good}"),
        1 => format!("{good} - {bad}"),
        2 => {
            format!(
                "({good}) * cos({})",
                random_product_with_parameter(random_other_dimension(PLAIN, random), 1, random)
            )
        }
        3 => format!("min({good}, {bad})"),
        4 => {
            // Sum without any parameter.
            let all = [MOTION.as_slice(), INPUTS.as_slice()].concat();
            let (a, b) = loop {
                let (a, b) = (pick_randomly(&all, random), pick_randomly(&all, random));
                if a.1 != b.1 {
                    break (a.0, b.0);
                }
            };
            format!("{a} + {b}")
        }
        _ => format!("if {good} < {bad} {{ {good} }} else {{ {good} }}"),
    }
}

/// Returns an element that uses an expression of this dimension, directly or through definitions.
fn random_element(e: &str, dimension: Dimension, random: &mut Random) -> String {
    match random_index(if dimension == FORCE || dimension == ENERGY { 6 } else { 4 }, random) {
        0 => format!("#[output({e})] o: Scalar"),
        1 => format!("#[define({e})] d: Scalar, #[output(2 * d)] o: Scalar"),
        2 => format!("#[output(r2 + d)] o: Scalar, #[define(d - d)] r2: Scalar, #[define({e})] d: Scalar"),
        3 => format!(
            "#[define(n * d)] twice: Scalar, #[define({e})] d: Scalar, #[output(twice - d)] o: Scalar"
        ),
        4 if dimension == FORCE => format!("#[acts(on = rail, value = {e})] o: Force"),
        4 => format!("#[acts(on = hinge, value = {e})] o: Torque"),
        _ if dimension == FORCE => format!("#[acts(on = cart, value = ({e}) * x)] o: Force"),
        _ => format!("#[acts(on = arm, value = ({e}) * z)] o: Torque"),
    }
}

fn random_dimension(random: &mut Random) -> Dimension {
    match random_index(3, random) {
        0 => FORCE,
        1 => ENERGY,
        _ => std::array::from_fn(|_| random_index(4, random) as i32 - 2),
    }
}

#[test]
fn random_expressions_with_matching_units_are_accepted() {
    let mut random = Random::new(41);
    for _ in 0..600 {
        let dimension = random_dimension(&mut random);
        let e = random_sum_text(dimension, 2, &mut random);
        let more = random_element(&e, dimension, &mut random);
        assert_eq!(messages_for_element(&more), Vec::<String>::new(), "{more}");
    }
}

#[test]
fn random_expressions_with_conflicting_units_are_rejected() {
    let mut random = Random::new(42);
    for _ in 0..600 {
        let dimension = random_dimension(&mut random);
        let e = sum_with_wrong_unit(dimension, &mut random);
        let more = random_element(&e, dimension, &mut random);
        assert!(!messages_for_element(&more).is_empty(), "{more}");
    }
}

/// Expressions of another dimension than that of their use are rejected.
#[test]
fn uses_with_other_units_are_rejected() {
    let mut random = Random::new(43);
    for _ in 0..600 {
        let (kind, place) = pick_randomly(&[("rail", FORCE), ("hinge", ENERGY)], &mut random);
        let dimension = random_other_dimension(place, &mut random);
        let e = match INPUTS.iter().find(|(_, unit)| *unit != place && random_index(4, &mut random) == 0) {
            Some((name, _)) => name.to_string(),
            None => random_product_with_parameter(dimension, 2, &mut random),
        };
        let element = if kind == "rail" { "Force" } else { "Torque" };
        let more = format!("#[acts(on = {kind}, value = {e})] o: {element}");
        assert!(!messages_for_element(&more).is_empty(), "{more}");
    }
}
