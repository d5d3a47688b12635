//! Tests of errors by users who know Rust, other tools or mechanics, but not yet the language. Each causes
//! one error with help.

use super::{ARM, ErrorRow, compiler_messages};
use std::path::Path;

/// Erroneous sources: arguments of the attribute, and fields added to an arm on a hinge.
const SLIPS: &[(&str, &str)] = &[
    ("", "#[acts(on = hinge, stiffness = 3, damping = 1)] k: Spring"),
    ("", "#[acts(on = hinge, k = 3)] k: Spring"),
    ("", "#[acts(on = hinge, c = 3)] k: Dashpot"),
    ("", "#[acts(on = hinge, torque = 3)] k: Torque"),
    ("", "#[acts(on = arm, value = 3)] k: Force"),
    ("", "#[acts(on = arm, along = z, value = 3)] k: Force"),
    ("", "#[acts(on = hinge, value = 3 * z)] k: Torque"),
    ("", "#[acts(on = hinge, value = sin(time))] k: Torque"),
    ("", "#[acts(on = hinge, value = hinge.powi(2))] k: Torque"),
    ("", "#[acts(on = hinge, value = hinge.sin())] k: Torque"),
    ("", "#[acts(on = hinge, value = f64::sin(hinge))] k: Torque"),
    ("", "#[acts(on = hinge, value = hinge ** 2)] k: Torque"),
    ("", "#[acts(on = hinge, value = hinge ^ 2)] k: Torque"),
    ("", "#[acts(on = hinge, value = if hinge > 0 { 1 } else { 0 })] k: Torque"),
    ("", "#[acts(on = hinge, value = -2 hinge)] k: Torque"),
    ("", "#[acts(on = hinge, value = |x| x)] k: Torque"),
    ("", "#[acts(on = hinge, value = &hinge)] k: Torque"),
    ("", "#[acts(on = hinge, value = self.k)] k: Torque"),
    ("", "#[acts(on = hinge, value = sqrt(-1))] k: Torque"),
    ("", "#[acts(on = hinge, value = ln(0))] k: Torque"),
    ("", "#[acts(on = hinge, value = asin(2))] k: Torque"),
    ("", "#[acts(on = hinge, value = max(hinge))] k: Torque"),
    ("", "#[acts(on = hinge, value = abs(hinge, 2))] k: Torque"),
    ("", "#[acts(on = hinge, value = sign(hinge))] k: Torque"),
    ("", "#[acts(on = hinge, value = clamp(hinge, -1, 1))] k: Torque"),
    ("", "#[acts(on = hinge, value = norm(hinge))] k: Torque"),
    ("", "#[acts(on = hinge, value = dot(x, 1))] k: Torque"),
    ("", "#[acts(on = hinge, value = cross(x, y))] k: Torque"),
    ("", "#[output(hinge = 3)] o: Scalar"),
    ("", "#[output(hinge)] o: Vector"),
    ("", "#[output(r(arm / ground))] o: Scalar"),
    ("", "#[output(r(arm - ground))] o: Vector"),
    ("", "#[output(r(arm, ground))] o: Vector"),
    ("", "#[output(r(arm))] o: Vector"),
    ("", "#[output(v(arm / ground))] o: Vector"),
    ("", "#[output(omega(arm))] o: Vector"),
    ("", "#[output(omega(arm / ground / ground))] o: Vector"),
    ("", "#[output(jacobian(arm))] o: Vector"),
    ("", "#[output(r(arm / ground), in = arm)] o: Vector"),
    ("", "#[output(r(arm / ground), resolved_in = hinge)] o: Vector"),
    ("", "#[output(a(arm / ground / ground))] o: f64"),
    ("", "#[output(energy)] o: Scalar"),
    ("", "#[output(kinetic_energy())] o: Scalar"),
    ("", "#[define(b)] a: Scalar, #[define(a)] b: Scalar, #[output(a)] o: Scalar"),
    ("", "#[point(arm.at(x))] tip: Point, #[output(r(tip / ground))] o: Vector"),
    ("", "#[point(on = arm, at = (1, 0, 0))] tip: Point, #[output(r(tip / ground))] o: Vector"),
    ("", "#[point(on = arm, at = 1)] tip: Point, #[output(r(tip / ground))] o: Vector"),
    ("", "#[frame(arm, rotated(z(1)))] f: Frame, #[output(dot(f.x, x))] o: Scalar"),
    ("", "#[frame(arm, yaw = 1)] f: Frame, #[output(dot(f.x, x))] o: Scalar"),
    ("", "#[particle(mass = 1, on = arm)] p: Particle"),
    ("", "#[particle(1, at = arm.at(x))] p: Particle"),
    ("", "#[particle(mass = 1, inertia = 2, at = arm.at(x))] p: Particle"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(hinge -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, about = z, at = x)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, axis = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, about = Z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, about = \"z\")] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, about = z + y)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, about = z, limits = (-1, 1))] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, about = z, damping = 1)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool, about = (z, z))] w: Universal"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm -> tool -> ground, about = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm.x -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm.at(x, y) -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm.at(x).rotate(z(1)) -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm.rotated(1) -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(arm.rotated(z) -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, com = x)] tool: Body, #[joint(world -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, inertia = sphere(1))] tool: Body, #[joint(arm -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, inertia = rod(1, z, 1))] tool: Body, #[joint(arm -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, inertia = diagonal(1, 2))] tool: Body, #[joint(arm -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1, inertia = 3 * z)] tool: Body, #[joint(arm -> tool, about = z)] w: Pin"),
    ("", "#[body(density = 1000, com = x)] tool: Body, #[joint(arm -> tool, about = z)] w: Pin"),
    ("", "#[body(mass = 1 kg, com = x)] tool: Body, #[joint(arm -> tool, about = z)] w: Pin"),
    ("", "#[constraint(hinge)] c: Holonomic"),
    ("", "#[constraint(hinge > 0)] c: Holonomic"),
    ("", "#[constraint(hinge == 0, 1)] c: Holonomic"),
    ("", "#[constraint(omega(arm / ground) = 0)] c: Nonholonomic"),
    ("", "#[constraint(rate(hinge) = 0)] c: Nonholonomic"),
    ("", "#[energy(rate(hinge) * rate(hinge))] e: Rayleigh"),
    ("gravity = 9.81 * down", ""),
    ("gravity = [0, -9.81]", ""),
    ("gravity = (0, -9.81, 0)", ""),
    ("gravity: -9.81 * y", ""),
    ("gravity = -9.81 * arm.y", ""),
    ("derivative", ""),
    ("derivatives = yes", ""),
    ("batch(8)", ""),
    ("formulation = lagrange", ""),
    ("scalar = f16", ""),
    ("crate = \"linkwork\"", ""),
    ("skip_passes = all", ""),
    ("independent = hinge", ""),
    ("", "#[dissipation(hinge * hinge)] e: Rayleigh"),
];

#[test]
fn each_misspelling_is_one_error_with_help() {
    let mut wrong = Vec::new();
    for (attribute, fields) in SLIPS {
        let found = compiler_messages(attribute, &format!("{ARM} {fields}"));
        if !matches!(found.as_slice(), [one] if one.contains("= help: ")) {
            wrong.push(format!("{attribute} {fields}\n{}", found.join("\n  and ")));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), SLIPS.len(), wrong.join("\n\n"));
}

/// Erroneous fields added to an arm on a hinge, with the first line of the message and a part of the help.
const POINTERS: &[ErrorRow] = &[
    (
        "#[acts(on = hinge, value = 3 * hinge_ddot)] k: Torque",
        "unknown name `hinge_ddot`",
        "write `rate(rate(hinge))` for its acceleration",
    ),
    (
        "#[acts(on = hinge, value = -stiff * hinge)] k: Torque",
        "unknown name `stiff`",
        "or declare it: `stiff: f64` is a parameter",
    ),
    (
        "#[output(kinetic_energy)] e: Scalar",
        "`kinetic_energy` is a function of a body",
        "that of the whole mechanism needs no output: it is the method `kinetic_energy`",
    ),
    ("#[output(momentum)] p: Vector", "`momentum` is a function of a body", "write `momentum(body)`"),
    (
        "#[acts(between = ground.at(x) -> arm.at(y), stiffness = 1)] k: Spring",
        "expected `,`",
        "write `between = (ground.at(x), arm.at(y))`",
    ),
    ("#[limit(hinge, -1, 1)] range: Limit", "expected `name = value`", "write `on = hinge`"),
];

#[test]
fn misspelling_errors_point_at_the_token() {
    super::check_error_rows(|fields| (String::new(), format!("{ARM} {fields}")), POINTERS);
}

/// Invalid options for an imported robot file, with the expected messages.
const OPTIONS: &[ErrorRow] = &[
    ("lock = [hand_joint]", "expected a list of strings for `lock`", "write `lock = [\"hand_joint\"]`"),
    ("lock = \"hand_joint\"", "expected a list of strings for `lock`", "write `lock = [\"hand_joint\"]`"),
    ("lock = (a, b)", "expected a list of strings for `lock`", "write `lock = [\"a\", \"b\"]`"),
    ("lock = 3", "expected a list of strings for `lock`", "write `lock = [\"…\", \"…\"]`"),
    ("base = \"free\"", "expected a name for `base`", "write it without quotes: `base = free`"),
    ("inertia = \"none\"", "expected a name for `inertia`", "write it without quotes: `inertia = none`"),
];

#[test]
fn file_options_are_suggested_in_correct_syntax() {
    let robot = "<robot name=\"arm\"><link name=\"arm\"/></robot>";
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("options.urdf"), robot).unwrap();
    let options_without_fields =
        |options: &str| (format!("urdf = \"options.urdf\", {options}"), String::new());
    super::check_error_rows(options_without_fields, OPTIONS);
}

#[test]
fn gravity_may_be_written_in_ground_axes() {
    assert_eq!(compiler_messages("gravity = -9.81 * ground.y", ARM), Vec::<String>::new());
}
