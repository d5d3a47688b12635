//! Tests of several errors at once: each is reported, but no error that is only a consequence of another one.

use super::{ARM, check_error_counts, compiler_messages};

const TOOL: &str = "#[body(mass = 1, inertia = sphere(1, 1))] tool: Body,";

#[test]
fn independent_errors_are_reported_together() {
    let arm = format!("{ARM} {TOOL}");
    let rows: Vec<(String, usize)> = vec![
        // An axis, a mass, a spring on an unknown joint, an output.
        (
            "#[body(mass = mas)] arm: Body, #[joint(ground -> arm, about = up)] hinge: Pin,
            #[acts(on = hinge, stiffness = k)] coil: Spring, #[output(sine(hinge))] seen: Scalar"
                .to_string(),
            4,
        ),
        // Elements on the child of a joint with an invalid endpoint are still checked.
        (
            format!(
                "{arm} #[joint(arm.at(l * x) -> tool, about = z)] wrist: Pin,
                #[acts(on = tool, along = xx)] push: Force, #[output(r(tip / ground))] seen: Vector,
                #[constraint(norm(r(tool / ground)) = lenght)] held: Holonomic"
            ),
            4,
        ),
        // A spring between points of unknown position causes no further error.
        (
            format!(
                "{arm} #[joint(arm -> tool, about = z)] wrist: Pin, #[point(on = tool, at = l * x)] tip: Point,
                #[acts(between = (ground, tip), stiffness = 1)] coil: Spring,
                #[output(v(tip / ground / ground))] seen: Vector"
            ),
            1,
        ),
        // An error in a definition with many uses is reported once.
        (
            format!(
                "{ARM} #[define(sine(hinge))] s: Scalar, #[output(s)] first: Scalar, #[output(2 * s)] second: Scalar,
                #[acts(on = hinge, value = -s)] motor: Torque"
            ),
            1,
        ),
        // A particle with an invalid position still has a motion.
        (
            format!(
                "{ARM} theta: Coordinate, #[particle(mass = 1, at = l * cos(theta) * x)] bead: Particle,
                #[acts(on = bead, along = x)] push: Force"
            ),
            1,
        ),
        // A frame with an invalid rotation still has axes.
        (
            format!("{ARM} #[frame(ground, z(omega0 * t))] turned: Frame, \
                     #[output(dot(arm.x, turned.x))] seen: Scalar"),
            1,
        ),
        // Two syntax errors.
        (format!("#[body(mass = 1 com = x)] tool: Body, {ARM} #[acts(hinge)] motor: Torque"), 2),
        // An error of a unit that appears in two places, and another error of units.
        (
            "l: f64, m: f64, n: f64, #[body(mass = l, com = l * x)] arm: Body,
            #[joint(ground -> arm, about = z)] hinge: Pin,
            #[body(mass = m, com = (m + n) * x, inertia = sphere(n, 1))] tool: Body,
            #[joint(arm -> tool, about = z)] wrist: Pin"
                .to_string(),
            2,
        ),
    ];
    let rows: Vec<(&str, &str, usize)> = rows.iter().map(|(fields, n)| ("", fields.as_str(), *n)).collect();
    check_error_counts(&rows);
}

/// Checks that a conflict between two positions is one error, with the second position as a note.
#[test]
fn conflicting_declarations_are_one_error_with_a_note() {
    for (fields, note) in [
        ("l: f64, #[body(mass = l, com = l * x)] arm: Body, #[joint(ground -> arm, about = z)] hinge: Pin", "in \
            `mass` of `arm`"),
        (
            "#[unit(m)] k: f64, #[body(mass = 1, com = x)] arm: Body, #[joint(ground -> arm, about = z)] hinge: Pin,
            #[acts(on = hinge, stiffness = k)] coil: Spring",
            "in `stiffness` of `coil`",
        ),
        (
            "#[body(mass = 1, com = x, at = x)] arm: Body, #[joint(ground -> arm, about = z)] hinge: Pin",
            "the joint `hinge` places it as well",
        ),
        (
            "hinge: f64, #[body(mass = hinge, com = x)] arm: Body, \
             #[joint(ground -> arm, about = z)] hinge: Pin",
            "another field has this name",
        ),
    ] {
        let found = compiler_messages("", fields);
        let good = matches!(found.as_slice(), [one] if one.contains("= note: ") && one.contains(note));
        assert!(good, "{fields}\nexpected the note {note}\nfound {}", found.join("\n"));
    }
}

#[test]
fn too_many_degrees_of_freedom_are_rejected_with_advice() {
    let mut fields = String::new();
    for k in 0..260 {
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}", k - 1) };
        fields += &format!(
            "#[body(mass = 1, com = x)] b{k}: Body, #[joint({parent} -> b{k}, about = z)] j{k}: Pin,"
        );
    }
    let found = compiler_messages("", &fields);
    let good = matches!(found.as_slice(), [one] if one.starts_with("260 degrees of freedom, more than 256")
        && one.contains("= help: the generated code has no loops")
        && one.contains("divide the mechanism"));
    assert!(good, "{found:#?}");
}

/// Rounding errors of the mass matrix of a long chain are small: no joint of it seems to move no inertia.
/// Successive axes are perpendicular, and the smallest eigenvalue of the mass matrix is 0.46 kg m².
#[test]
fn long_chains_have_inertia() {
    let mut fields = String::new();
    for k in 0..120 {
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at(0.1 * x)", k - 1) };
        let axis = if k % 2 == 0 { "y" } else { "z" };
        fields += &format!(
            "#[body(mass = 1, com = x, inertia = sphere(1, 0.1))] b{k}: Body,
            #[joint({parent} -> b{k}, about = {axis})] j{k}: Pin,"
        );
    }
    let found = compiler_messages("", &fields);
    assert!(found.is_empty(), "{found:#?}");
}
