//! Inference of units: units that follow from the use of a parameter, declarations that are rejected, and
//! correct declarations that are accepted.

#[path = "units/gallery.rs"]
mod gallery;
#[path = "units/random.rs"]
mod random;

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Units;
use linkwork_compiler::{compile, expand, parse_source_and_import};
use std::path::Path;

/// Returns the units of a mechanism, or its error messages.
pub fn units_of_mechanism(arguments: &str, item: &str) -> Result<Units, Vec<String>> {
    let mut cx = Diagnostics::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let source = parse_source_and_import(arguments.parse().unwrap(), item.parse().unwrap(), &folder, &mut cx);
    let graph = Graph::new();
    let model = source.and_then(|source| compile(&source, &graph, &mut cx).map(|(model, _)| model));
    model.map(|model| model.units).ok_or_else(|| cx.full_message_texts())
}

/// Returns the source of a mechanism with a body on a sleeve and one on a pin, and with the additional fields
/// `more`.
fn machine_source(more: &str) -> String {
    format!(
        "struct Machine {{ {more}
        #[body(mass = 1)] cart: Body,
        #[body(mass = 1, com = x)] arm: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart -> arm, about = z)] hinge: Pin }}"
    )
}

fn units_of_test_machine(more: &str) -> Result<Units, Vec<String>> {
    units_of_mechanism("", &machine_source(more))
}

/// Checks the units of the parameters `a`, `b`, … of a machine. The length of `expected` is the number of
/// parameters.
#[track_caller]
fn check_parameter_units(fields: &str, expected: &[&str]) {
    let names: String = ('a'..='f').take(expected.len()).map(|c| format!("{c}: f64, ")).collect();
    match units_of_test_machine(&format!("{names}{fields}")) {
        Ok(units) => assert_eq!(units.parameters, expected, "{fields}"),
        Err(messages) => panic!("{fields}: {messages:?}"),
    }
}

/// Returns the text of a line of a compiler message if the line is a note.
fn note_text_in_line(line: &str) -> Option<&str> {
    line.strip_prefix("= note: ")
}

/// Whether an expected text belongs to a note. Notes state the unit of a parameter and the argument that
/// determines it, or the unit that would be required.
fn is_note_text(text: &str) -> bool {
    text.starts_with("it is ") || text.ends_with(" in")
}

/// Checks the errors of a machine with the parameters `a`, `b`, `c`, and the notes of these errors.
#[track_caller]
fn check_unit_errors(fields: &str, expected: &[&str]) {
    let has_word =
        |name: &&&str| fields.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == **name);
    let names: String = ["a", "b", "c"].iter().filter(has_word).map(|n| format!("{n}: f64, ")).collect();
    let names = if fields.contains("unit(") { String::new() } else { names };
    match units_of_test_machine(&format!("{names}{fields}")) {
        Ok(units) => panic!("{fields} is accepted with {units:?}"),
        Err(messages) => {
            let first: Vec<&str> = messages.iter().map(|m| m.lines().next().unwrap_or_default()).collect();
            let notes: Vec<&str> =
                messages.iter().flat_map(|m| m.lines()).filter_map(note_text_in_line).collect();
            let (told, errors): (Vec<&str>, Vec<&str>) = expected.iter().partition(|text| is_note_text(text));
            assert_eq!(first, errors, "{fields}");
            assert_eq!(notes.len(), told.len(), "{fields}: {notes:?}");
            for (note, told) in notes.iter().zip(&told) {
                assert!(note.starts_with(told), "{fields}: {note} for {told}");
            }
        }
    }
}

#[test]
fn units_are_inferred_from_every_use() {
    check_parameter_units(
        "#[body(mass = a, com = b * x, inertia = diagonal(c, c, c))] k: Body, #[joint(arm -> k)] j: Ball,",
        &["kg", "m", "kg·m²"],
    );
    check_parameter_units(
        "#[body(mass = 1, inertia = cuboid(a, b, b, 2 * b).rotated(z(c)))] k: Body, \
         #[joint(arm -> k)] j: Ball,",
        &["kg", "m", "rad"],
    );
    check_parameter_units(
        "#[body(mass = 1, inertia = sphere(1, 1))] k: Body, \
         #[joint(arm.at(a / 2 * x).rotated(z(b)) -> k, about = z, pitch = c)] j: Screw,",
        &["m", "rad", "m/rad"],
    );
    check_parameter_units(
        "#[acts(on = rail, stiffness = a, free_length = b)] s: Spring, \
         #[acts(on = hinge, stiffness = c, free_angle = d)] t: Spring,",
        &["N/m", "m", "N·m/rad", "rad"],
    );
    check_parameter_units(
        "#[acts(on = rail, damping = a)] s: Dashpot, #[acts(on = hinge, damping = b)] t: Dashpot,",
        &["N·s/m", "N·m·s/rad"],
    );
    check_parameter_units(
        "#[acts(on = rail, inertance = a)] s: Inerter, #[acts(on = hinge, inertance = b)] t: Inerter,",
        &["kg", "kg·m²"],
    );
    check_parameter_units(
        "#[acts(on = rail, coulomb = a, stiction = b, stribeck_speed = c, viscous = d, speed = e)] s: \
         Friction,",
        &["N", "N", "m/s", "N·s/m", "m/s"],
    );
    check_parameter_units(
        "#[particle(mass = 1)] p: Particle, #[joint(ground -> p, along = (x, y))] table: Stage, \
         #[acts(between = (ground, p), mu = a)] s: Gravity, \
         #[acts(between = (cart, p), constant = b)] t: Gravity, \
         #[acts(between = (arm, p), strength = c)] u: Attraction,",
        &["m³/s²", "m³/(kg·s²)", "N·m²"],
    );
    check_parameter_units(
        "#[acts(on = rail, force = a * stretch + b * pow(stretch, 3))] s: Spring, \
         #[acts(on = hinge, energy = c * stretch * stretch / 2)] t: Spring, \
         #[acts(on = rail, force = d * speed * abs(speed))] u: Dashpot,",
        &["N/m", "kg/(m²·s²)", "N·m", "kg/m"],
    );
    check_parameter_units(
        "#[acts(on = rail, value = a * cos(b * t))] s: Force, \
         #[acts(on = hinge, value = c * exp(-t / d))] t_: Torque,",
        &["N", "1/s", "N·m", "s"],
    );
    check_parameter_units(
        "#[energy(a / 2 * rail * rail)] s: Potential, \
         #[dissipation(b * rate(rail) * rate(rail))] t_: Rayleigh, #[energy(c)] u: Potential,",
        &["N/m", "N·s/m", "J"],
    );
}

#[test]
fn units_propagate_through_expressions() {
    check_parameter_units(
        "#[acts(on = cart, value = sqrt(a * b) * x)] s: Force, #[energy(a * rail + b * rail)] t_: Potential,",
        &["N", "N"],
    );
    // The square root of a product whose factors have their units from other uses.
    check_parameter_units(
        "#[acts(on = rail, damping = 2 * c * sqrt(a * b))] s: Dashpot, \
         #[acts(on = rail, stiffness = a)] k: Spring, #[body(mass = b)] w: Body, \
         #[joint(cart -> w)] j: Weld,",
        &["N/m", "kg", "1"],
    );
    check_parameter_units(
        "#[output(a * dot(v(arm / ground / ground), x))] s: Scalar, \
         #[acts(on = cart, value = a * v(cart / ground / ground))] t_: Force,",
        &["N·s/m"],
    );
    check_parameter_units(
        "#[acts(on = arm, value = a * omega(arm / ground) + b * alpha_ * rate(hinge) * z)] s: Torque, \
         #[define(atan2(a, b))] alpha_: Scalar,",
        &["N·m·s", "N·m·s"].map(|_| "kg·m²/s"),
    );
    check_parameter_units(
        "#[acts(on = rail, value = min(a, max(b, c * r2)))] s: Force, \
         #[define(dot(r(arm.at(x) / ground), r(arm.at(d * x) / ground)))] r2: Scalar,",
        &["N", "N", "kg/(m·s²)", "m"],
    );
    check_parameter_units("#[acts(on = rail, value = a * pow(rail / b, c))] s: Force,", &["N", "m", "1"]);
    check_parameter_units("#[acts(on = rail, value = a * pow(rail, b))] s: Force,", &["any", "1"]);
    // A ratio of two parameters determines neither unit.
    check_parameter_units("#[acts(on = hinge, value = 3 * sin(a / b))] s: Torque,", &["any", "any"]);
    check_parameter_units(
        "#[acts(on = cart, value = [a, 0, b] - c * unit(r(arm.at(x) / ground)))] s: Force,",
        &["N", "N", "N"],
    );
    check_parameter_units(
        "#[frame(ground, z(a), eigenaxis(x, b * t))] f: Frame, \
         #[acts(on = cart, value = c * f.x + d * cross(f.y, x))] s: Force,",
        &["rad", "1/s", "N", "N"],
    );
}

#[test]
fn numeric_literals_take_any_unit() {
    for fields in [
        "#[acts(on = cart, value = -g * a * y)] s: Force, #[define(9.81)] g: Scalar, \
         #[body(mass = a)] w: Body, #[joint(cart -> w)] j: Weld,",
        "#[acts(on = rail, value = a + 0.1)] s: Force,",
        "#[acts(on = rail, value = -2 * rail + a)] s: Force,",
        "#[acts(on = rail, value = a * tanh(rate(rail) / 0.01))] s: Force,",
        "#[acts(on = rail, value = a * (1 - cos(2 * t)))] s: Force,",
        "#[acts(on = rail, value = -200 * rail - 30 * rate(rail) + 0 * a)] s: Force,",
        "#[acts(on = rail, force = 4 * stretch + pow(stretch, 3))] k: Spring, #[energy(a)] e: Potential,",
        "#[particle(mass = a, at = sin(hinge) * x - cos(hinge) * y)] p: Particle,",
        "#[energy(a * sin(rail + 0.2 * t))] e: Potential,",
        "#[acts(on = rail, value = -rail)] s: Force, #[energy(a * sin(t))] e: Potential,",
        "#[acts(on = cart, value = sin(t) * x - 3 * v(cart / ground / ground))] s: Force, \
         #[energy(a)] e: Potential,",
    ] {
        if let Err(messages) = units_of_test_machine(&format!("a: f64, {fields}")) {
            panic!("{fields}: {messages:?}");
        }
    }
}

#[test]
fn coordinates_inputs_and_outputs_have_units() {
    let units = units_of_test_machine(
        "m: f64, s: Coordinate, phi: Coordinate, gain: f64, #[unit(m)] lever: f64, steer: Input,
        #[particle(mass = m, at = s * (cos(phi) * x + sin(phi) * y))] p: Particle,
        #[acts(on = rail)] push: Force, #[acts(on = hinge)] turn: Torque,
        #[acts(on = cart, along = lever * x)] pull: Force,
        #[acts(on = arm, value = gain * sin(steer) * z)] tail: Torque,
        #[output(m * dot(v(p / ground / ground), v(p / ground / ground)))] twice: Scalar,
        #[output(v(p / ground / ground))] velocity: Vector, #[output(phi)] bearing: Scalar,",
    )
    .unwrap();
    assert_eq!(units.parameters, ["kg", "N·m", "m"]);
    let first = units.configuration.iter().zip(&units.velocities);
    let first: Vec<String> = first.map(|(q, v)| format!("{q}, {v}")).collect();
    assert_eq!(first, ["m, m/s", "rad, rad/s", "m, m/s", "rad, rad/s"]);
    assert_eq!(units.inputs, ["rad", "N", "N·m", "N/m"]);
    assert_eq!(units.outputs, ["J", "m/s", "1"]);
}

#[test]
fn robot_file_mechanisms_have_units() {
    let units = units_of_mechanism("urdf = \"urdf/solo12.urdf\", base = free", "struct Robot;").unwrap();
    assert_eq!(units.configuration[..8], ["m", "m", "m", "1", "1", "1", "1", "rad"]);
    assert_eq!(units.velocities[..7], ["m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s", "rad/s"]);
    assert!(units.inputs.iter().all(|unit| unit == "N·m"));
}

#[test]
fn parameter_with_two_units_is_rejected() {
    check_unit_errors(
        "#[acts(on = rail, stiffness = a)] s: Spring, #[acts(on = hinge, stiffness = a)] t_: Spring,",
        &[
            "`a` is a torque or an energy (N·m) here, but a stiffness (N/m) elsewhere",
            "`a` is a stiffness (N/m) in",
        ],
    );
    check_unit_errors(
        "#[body(mass = a, com = a / 2 * y)] w: Body, #[joint(cart -> w)] j: Weld,",
        &["`a` is a length (m) here, but a mass (kg) elsewhere", "`a` is a mass (kg) in"],
    );
    check_unit_errors(
        "#[energy(a * rail)] e: Potential, #[body(mass = 2 * a)] w: Body, #[joint(cart -> w)] j: Weld,",
        &["`a` is a force (N) here, but a mass (kg) elsewhere", "`a` is a mass (kg) in"],
    );
    // Each conflict is reported once, independent of the number of wrong uses.
    check_unit_errors(
        "#[body(mass = a, com = a * y, inertia = rod(a, a, y))] w: Body, #[joint(cart -> w)] j: Weld,",
        &["`a` is a length (m) here, but a mass (kg) elsewhere", "`a` is a mass (kg) in"],
    );
    // The conflict follows through another parameter: a b is a mass, and so is b.
    check_unit_errors(
        "#[body(mass = a * b)] w: Body, #[body(mass = b, com = a * y)] w2: Body, \
         #[joint(cart -> w)] j: Weld, #[joint(cart -> w2)] j2: Weld,",
        &[
            "expected a mass (kg), found a quantity in kg·m",
            "`a` is a length (m) in",
            "`b` is a mass (kg) in",
        ],
    );
}

/// A mechanism that cannot move, with a parameter of two conflicting units: both errors are reported.
#[test]
fn unit_errors_are_reported_with_topology_errors() {
    check_unit_errors(
        "#[joint(arm.at(a * x) -> ground.at(3 * x))] stop: Weld,
        #[acts(on = rail, stiffness = a)] coil: Spring,",
        &[
            "`a` is a stiffness (N/m) here, but a length (m) elsewhere",
            "`a` is a length (m) in",
            "this mechanism cannot move",
        ],
    );
}

#[test]
fn sums_of_different_units_are_rejected() {
    let known = "#[body(mass = a, com = b * y)] w: Body, #[joint(cart -> w)] j: Weld,";
    let sites = ["`a` is a mass (kg) in", "`b` is a length (m) in"];
    let message_with_unit_origins = |first: &'static str| [first, sites[0], sites[1]];
    check_unit_errors(
        &format!("{known} #[energy(3.5 * (a + b))] e: Potential,"),
        &message_with_unit_origins("a length (m) cannot be added to a mass (kg)"),
    );
    check_unit_errors(
        &format!("{known} #[energy(3.5 * (a - b))] e: Potential,"),
        &message_with_unit_origins("a length (m) cannot be subtracted from a mass (kg)"),
    );
    check_unit_errors(
        &format!("{known} #[energy(3.5 * max(a, b))] e: Potential,"),
        &message_with_unit_origins("`max` cannot compare a mass (kg) with a length (m)"),
    );
    check_unit_errors(
        &format!("{known} #[energy(3.5 * norm([a, 0, b]))] e: Potential,"),
        &message_with_unit_origins("this component is a length (m), but another is a mass (kg)"),
    );
    check_unit_errors(
        &format!("{known} #[energy(3.5 * atan2(a, b))] e: Potential,"),
        &message_with_unit_origins("`atan2` cannot compare a mass (kg) with a length (m)"),
    );
    check_unit_errors(
        "#[energy(a * rail + a * hinge)] e: Potential,",
        &["a force (N) cannot be added to a torque or an energy (N·m)", "`a` is a force (N) in"],
    );
    check_unit_errors(
        "#[energy(3.5 * (a * rail + a * hinge))] e: Potential,",
        &["these terms cannot have one unit: they differ by 1/m"],
    );
    check_unit_errors(
        "#[energy(a * (rail + hinge))] e: Potential,",
        &["a plain number cannot be added to a length (m)"],
    );
    check_unit_errors(
        "#[energy(a * sin(b))] e: Potential, #[body(mass = b)] w: Body, #[joint(cart -> w)] j: Weld,",
        &["`b` is a plain number here, but a mass (kg) elsewhere", "`b` is a mass (kg) in"],
    );
}

/// Units of sums that contain only coordinates, rates, time and inputs are checked, too.
#[test]
fn sums_of_coordinates_and_rates_have_checked_units() {
    let input = "#[acts(on = rail)] f: Force, #[acts(on = hinge)] m: Torque,";
    for (sum, message) in [
        ("f + rail", "a length (m) cannot be added to a force (N)"),
        ("f - m", "a torque or an energy (N·m) cannot be subtracted from a force (N)"),
        ("rail + rate(rail)", "a speed (m/s) cannot be added to a length (m)"),
        ("sin(rail + t)", "a time (s) cannot be added to a length (m)"),
        ("kinetic_energy(arm) + rail", "a length (m) cannot be added to a torque or an energy (N·m)"),
        ("max(f, hinge)", "`max` cannot compare a force (N) with a plain number"),
    ] {
        check_unit_errors(&format!("{input} #[output({sum})] o: Scalar,"), &[message]);
        check_unit_errors(
            &format!("{input} #[output(2 * inner)] o: Scalar, #[define({sum})] inner: Scalar,"),
            &[message],
        );
    }
    check_unit_errors(
        &format!("{input} #[output(f * x + rail * y)] o: Vector,"),
        &["a length (m) cannot be added to a force (N)"],
    );
    check_unit_errors(
        &format!("{input} #[acts(on = hinge, value = f)] o: Torque,"),
        &["expected a torque or an energy (N·m), found a force (N)"],
    );
}

/// The number in the mechanism's gravity is an acceleration also as a factor of a parameter; no other number
/// is.
#[test]
fn gravity_literal_is_an_acceleration() {
    let is_valid_hover_force = |gravity: &str, number: &str| {
        let item = machine_source(&format!(
            "m: f64, #[body(mass = m)] load: Body, #[joint(cart -> load)] fixed: Weld,
            #[acts(on = load, value = {number} * m * y)] lift: Force,"
        ));
        units_of_mechanism(gravity, &item).is_ok()
    };
    assert!(
        is_valid_hover_force("gravity = -9.81 * y", "9.81")
            && is_valid_hover_force("gravity = [0, -9.8, 0]", "9.8")
    );
    assert!(!is_valid_hover_force("gravity = -9.81 * y", "9.8") && !is_valid_hover_force("", "9.81"));
}

/// A number that multiplies a parameter is dimensionless, for every value.
#[test]
fn factors_of_parameters_are_dimensionless() {
    for number in ["0.5", "0.6", "9.81", "40", "2 / 7", "1e-3", "sin(0.3)", "pi"] {
        let body_with_mass = |value: &str| {
            format!("#[unit(kg / m)] rho: f64, #[body(mass = {value})] w: Body, #[joint(cart -> w)] j: Weld,")
        };
        for value in [format!("rho * {number}"), format!("{number} * rho"), format!("rho / ({number})")] {
            let messages = units_of_test_machine(&body_with_mass(&value)).unwrap_err();
            assert!(
                messages[0].starts_with("`rho` is declared as a quantity in kg/m, but used as a mass (kg)")
            );
            assert!(messages[0].contains("`#[define(9.81)] g: Scalar`"), "{messages:?}");
        }
        units_of_test_machine(&format!(
            "{} #[define({number})] length: Scalar,",
            body_with_mass("rho * length")
        ))
        .unwrap();
    }
}

#[test]
fn unit_attributes_fix_the_units_of_parameters() {
    let unit_of_attribute = |written: &str| {
        let units =
            units_of_test_machine(&format!("#[unit({written})] a: f64, #[output(3.5 * a)] o: Scalar,"))?;
        Ok::<String, Vec<String>>(units.parameters[0].clone())
    };
    for (written, shown) in [
        ("kg", "kg"),
        ("N * m / rad", "N·m/rad"),
        ("kg * m2", "kg·m²"),
        ("m3 / (kg * s2)", "m³/(kg·s²)"),
        ("1 / s", "1/s"),
        ("rad / s", "rad/s"),
        ("1", "1"),
    ] {
        assert_eq!(unit_of_attribute(written).as_deref(), Ok(shown));
    }
    let error_message_of_unit = |written: &str| unit_of_attribute(written).unwrap_err().join("; ");
    assert!(error_message_of_unit("mm").contains(
        "unknown unit `mm`\n\n= help: all quantities are in SI units, angles in radians: write `m`"
    ));
    assert!(error_message_of_unit("deg").contains("write `rad`"));
    assert!(error_message_of_unit("kq").contains("did you mean `kg`?"));
    assert!(error_message_of_unit("m99").contains("unknown unit `m99`"));
    assert!(error_message_of_unit("2 * kg").contains("expected a unit"));
    assert!(error_message_of_unit("kg +").contains("missing operand after this operator"));
    assert!(error_message_of_unit("").contains("missing unit"));
    check_unit_errors(
        "#[unit(m)] a: f64, #[output(3.5 * a)] e: Scalar, #[body(mass = a)] w: Body, \
         #[joint(cart -> w)] j: Weld,",
        &["`a` is declared as a length (m), but used as a mass (kg)", "it is a mass (kg) in"],
    );
    check_unit_errors(
        "#[unit(m)] #[unit(m)] a: f64, #[output(3.5 * a)] e: Scalar,",
        &["a parameter has one `#[unit]`"],
    );
}

/// The struct keeps its fields without the attribute, and its documentation states all units.
#[test]
fn inferred_units_are_documented() {
    let item = machine_source(
        "/// A length.\n#[unit(m)] a: f64, b: f64, #[acts(on = rail, stiffness = b, free_length = a)] s: \
         Spring,
        #[output(r(arm / ground))] place: Vector,",
    );
    let emitted = expand("".parse().unwrap(), item.parse().unwrap(), Path::new(""));
    let text = emitted.tokens.to_string();
    assert!(!text.contains("unit ("), "{text}");
    for row in [
        "| parameter | `a` | m |",
        "| parameter | `b` | N/m |",
        "| `q[0]` | `rail` | m |",
        "| `v[1]` | `hinge` | rad/s |",
        "| output | `place` | m |",
    ] {
        assert!(text.contains(row), "{row} is not in {text}");
    }
}

/// Units of the rows of joints, expressions and rolling pairs: a multiplier times its constraint velocity is
/// a power.
#[test]
fn constraints_and_multipliers_have_units() {
    let item = "struct Machine {
        length: f64, radius: f64, ratio: f64, area: f64,
        #[body(mass = 1, com = x, inertia = diagonal(1, 2, 3))] first: Body,
        #[body(mass = 1, com = y, inertia = diagonal(1, 2, 3))] second: Body,
        #[body(mass = 1, inertia = sphere(1, radius))] ball: Body,
        #[joint(ground -> first)] left: Free,
        #[joint(ground -> second)] right: Free,
        #[joint(ground -> ball)] loose: Free,
        #[body(mass = 1, com = x, inertia = rod(1, 1, y))] wheel: Body,
        #[joint(ground -> wheel, about = z)] spin: Pin,
        #[body(mass = 1)] slider: Body,
        #[joint(ground -> slider, along = x)] slide: Sleeve,
        #[joint(first -> second, about = z, pitch = 0.1)] thread: Screw,
        #[constraint(norm(r(first / ground)) = length)] rope: Holonomic,
        #[constraint(spin = ratio * sin(3 * t))] drive: Holonomic,
        #[constraint(slide * slide = area)] square: Holonomic,
        #[constraint(rate(spin) = ratio * dot(omega(second / ground), x))] gear: Nonholonomic,
        #[constraint(dot(v(second / ground / ground), second.y) = 0)] knife: Nonholonomic,
        #[constraint(rolls(ball.sphere(radius), ground.plane(z)))] contact: Rolling,
        #[body(mass = 1, com = z, inertia = cone(1, 1, 2, z))] top: Body,
        #[joint(ground -> top)] tumble: Free,
        #[constraint(rolls(top.cone(0.4, z), ground.plane(z)))] line: Rolling,
    }";
    let expected = [
        ("thread.x", "configurations", "m", "N"),
        ("thread.y", "configurations", "m", "N"),
        ("thread.advance", "configurations", "m", "N"),
        ("thread.tilt_x", "configurations", "rad", "N·m"),
        ("thread.tilt_y", "configurations", "rad", "N·m"),
        ("rope", "configurations", "m", "N"),
        ("drive", "configurations", "rad", "N·m"),
        ("square", "configurations", "m²", "N/m"),
        ("contact.normal", "configurations", "m", "N"),
        ("line.normal", "configurations", "m", "N"),
        ("line.tilt", "configurations", "rad", "N·m"),
        ("gear", "velocities", "rad/s", "N·m"),
        ("knife", "velocities", "m/s", "N"),
        ("contact.x", "velocities", "m/s", "N"),
        ("contact.y", "velocities", "m/s", "N"),
        ("line.x", "velocities", "m/s", "N"),
        ("line.y", "velocities", "m/s", "N"),
        ("line.spin", "velocities", "rad/s", "N·m"),
    ];
    let found = units_of_mechanism("", item).unwrap().constraints;
    assert_eq!(found, expected.map(|(.., unit, multiplier)| [unit, multiplier].map(str::to_string)));
    let text = expand("".parse().unwrap(), item.parse().unwrap(), Path::new("")).tokens.to_string();
    for (k, (name, what, unit, multiplier)) in expected.into_iter().enumerate() {
        let row = format!("| `λ[{k}]` | `{name}` | {what} | {unit} | {multiplier} |");
        assert!(text.contains(&row), "{row} is not in {text}");
    }
}

/// The time of inference is bounded for structs of any size.
#[test]
fn unit_inference_of_large_structs_terminates() {
    let n = 800;
    let fields: String = (0..n).map(|k| format!("p{k}: f64, ")).collect();
    let product_of_parameters =
        |k: usize| (k..k + 120).map(|j| format!("p{}", j % n)).collect::<Vec<_>>().join(" * ");
    let energies: String =
        (0..n).map(|k| format!("#[energy(1.5 * {})] e{k}: Potential, ", product_of_parameters(k))).collect();
    let mut cx = Diagnostics::new();
    let source = parse_source_and_import(
        "".parse().unwrap(),
        machine_source(&format!("{fields}{energies}")).parse().unwrap(),
        Path::new(""),
        &mut cx,
    );
    if let Some(source) = source {
        linkwork_compiler::resolve::build_model(&source.mechanism.description, &Graph::new(), &mut cx);
    }
    assert_eq!(cx.full_message_texts(), Vec::<String>::new());
}
