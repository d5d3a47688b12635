//! A syntax error and an error in another element are reported in the same compilation, if the second does
//! not depend on the first.

use super::{ARM, check_error_counts, compiler_messages};

/// Fields of a test mechanism: an arm with a tool, a spring, a motor and an output.
const PARTS: [&str; 12] = [
    "k: f64",
    "l: f64",
    "#[body(mass = 1, com = -y, inertia = sphere(1, 0.1))] arm: Body",
    "#[body(mass = 0.5, com = x, inertia = sphere(1, 1))] tool: Body",
    "#[joint(ground -> arm, about = z)] hinge: Pin",
    "#[joint(arm.at(l * x) -> tool, about = z)] wrist: Pin",
    "#[point(on = tool, at = l * x)] tip: Point",
    "#[acts(on = wrist, stiffness = k)] coil: Spring",
    "#[acts(on = hinge)] motor: Torque",
    "#[acts(on = tip, value = k * l * x)] push: Force",
    "#[define(sin(hinge))] s: Scalar",
    "#[output(s * v(tip / ground / ground))] seen: Vector",
];

/// Returns the fields of the test mechanism, some of them replaced by the given texts.
fn fields_with_changes(changed: &[(usize, &str)]) -> String {
    let part_or_replacement =
        |k: usize| changed.iter().find(|(at, _)| *at == k).map_or(PARTS[k], |(_, text)| text);
    (0..PARTS.len()).map(part_or_replacement).collect::<Vec<_>>().join(", ")
}

#[test]
fn errors_of_consecutive_stages_are_both_reported() {
    let rows: Vec<(String, usize)> = vec![
        // A syntax error in a force element; an unknown name in another element.
        (
            fields_with_changes(&[
                (7, "#[acts(on = wrist, stifness = k)] coil: Spring"),
                (9, "#[acts(on = tip, value = kk * x)] push: Force"),
            ]),
            2,
        ),
        // A body with a syntax error is still known as a body.
        (
            fields_with_changes(&[
                (3, "#[body(mass = 0.5 com = x)] tool: Body"),
                (5, "#[joint(arm.at(ll * x) -> tool, about = z)] wrist: Pin"),
            ]),
            2,
        ),
        (
            fields_with_changes(&[
                (2, "#[body(mas = 1)] arm: Body"),
                (7, "#[acts(on = wrist, stiffness = stiff)] coil: Spring"),
            ]),
            2,
        ),
        // Without a joint the kinematic tree is unknown, but other errors are reported.
        (
            fields_with_changes(&[
                (4, "#[joint(ground, arm, about = z)] hinge: Pin"),
                (3, "#[body(mass = -1, inertia = sphere(1, 1))] tool: Body"),
            ]),
            2,
        ),
        (
            fields_with_changes(&[
                (5, "#[joint(arm -> tool, abuot = z)] wrist: Pin"),
                (4, "#[joint(ground -> arm, about = 2 * z)] hinge: Pin"),
            ]),
            2,
        ),
        // An output and a definition.
        (
            fields_with_changes(&[
                (11, "#[output(s +)] seen: Vector"),
                (10, "#[define(sine(hinge))] s: Scalar"),
            ]),
            2,
        ),
        // A repeated name, and an axis.
        (
            fields_with_changes(&[
                (0, "tip: f64, k: f64"),
                (4, "#[joint(ground -> arm, about = l * z)] hinge: Pin"),
            ]),
            2,
        ),
        // An unknown type, and one error in each of two independent elements.
        (
            fields_with_changes(&[
                (8, "#[acts(on = hinge)] motor: Engine"),
                (7, "#[acts(on = elbow, stiffness = k)] coil: Spring"),
                (10, "#[define(cosine(hinge))] s: Scalar"),
            ]),
            3,
        ),
    ];
    let rows: Vec<(&str, &str, usize)> = rows.iter().map(|(fields, n)| ("", fields.as_str(), *n)).collect();
    check_error_counts(&rows);
    // An option of the attribute.
    check_error_counts(&[("gravty = -9.81 * y", &format!("{ARM} #[acts(on = hinges)] motor: Torque"), 2)]);
    // A misspelt option may affect the other elements, so they are not checked.
    check_error_counts(&[
        ("inertias = none", "#[body(mass = 1)] arm: Body, #[joint(ground -> arm, about = z)] hinge: Pin", 1),
        ("urfd = \"robot.urdf\"", "#[acts(on = elbow)] motor: Torque", 1),
    ]);
}

/// Checks that a syntax error in one field causes no errors in the valid fields.
#[test]
fn syntax_errors_cause_no_errors_in_valid_fields() {
    for (k, part) in PARTS.iter().enumerate() {
        let mut broken = vec![part.replace(": ", ": Un")];
        if let Some((attribute, field)) = part.split_once(")] ") {
            broken.extend([
                format!("{attribute}, nothing = 1)] {field}"),
                format!("{attribute}, + )] {field}"),
            ]);
            broken.push(field.to_string());
            broken.push(part.replace("#[", "#[un"));
        }
        for text in broken {
            let fields = fields_with_changes(&[(k, &text)]);
            let found = compiler_messages("gravity = -9.81 * y", &fields);
            assert!(found.len() == 1, "{text}\nexpected one error, found\n{}", found.join("\n"));
        }
    }
}
