//! Lists of elements: a mechanism with lists compiles to the same code as the mechanism with single elements.

use linkwork_compiler::{check_mechanism, expand};
use std::path::Path;

/// Returns the code generated for a mechanism with these arguments and fields.
fn generated_code(arguments: &str, fields: &str) -> String {
    let item = format!("pub struct S {{ {fields} }}");
    let emitted = expand(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""));
    emitted.into_tokens().unwrap().to_string()
}

fn compiler_messages(arguments: &str, fields: &str) -> Vec<String> {
    let item = format!("struct S {{ {fields} }}");
    check_mechanism(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""))
}

/// Checks that both mechanisms compile to the same code.
fn assert_same_code(arguments: [&str; 2], fields: [&str; 2]) {
    for (arguments, fields) in arguments.iter().zip(fields) {
        assert_eq!(compiler_messages(arguments, fields), [""; 0]);
    }
    assert_eq!(generated_code(arguments[0], fields[0]), generated_code(arguments[1], fields[1]));
}

#[test]
fn list_macro_expands_to_its_elements() {
    let hull = "pub m: f64, pub l: f64, pub k: f64,
        #[body(mass = m, inertia = sphere(m, l))] hull: Body,
        #[joint(ground -> hull)] pose: Free,";
    let with = format!(
        "{hull}
        #[body(mass = m / 10, com = -l / 2 * z, inertia = rod(m / 10, l, z))] leg: [Body; 2],
        #[joint(hull.at((i - 0.5) * 2 * l * y) -> leg[i], about = y)] hip: [Pin; 2],
        #[acts(on = hip[i])] drive: [Torque; 2],
        #[acts(between = (leg[0].at(-l * z), leg[1].at(-l * z)), stiffness = k, free_length = l)] band: Spring,
        #[output(r(leg[1 - i].at(-l * z) / hull), resolved_in = hull)] foot: [Vector; 2],"
    );
    let without = format!(
        "{hull}
        #[body(mass = m / 10, com = -l / 2 * z, inertia = rod(m / 10, l, z))] leg_0: Body,
        #[body(mass = m / 10, com = -l / 2 * z, inertia = rod(m / 10, l, z))] leg_1: Body,
        #[joint(hull.at((0 - 0.5) * 2 * l * y) -> leg_0, about = y)] hip_0: Pin,
        #[joint(hull.at((1 - 0.5) * 2 * l * y) -> leg_1, about = y)] hip_1: Pin,
        #[acts(on = hip_0)] drive_0: Torque,
        #[acts(on = hip_1)] drive_1: Torque,
        #[acts(between = (leg_0.at(-l * z), leg_1.at(-l * z)), stiffness = k, free_length = l)] band: Spring,
        #[output(r(leg_1.at(-l * z) / hull), resolved_in = hull)] foot_0: Vector,
        #[output(r(leg_0.at(-l * z) / hull), resolved_in = hull)] foot_1: Vector,"
    );
    assert_same_code(["gravity = -9.81 * z, derivatives"; 2], [&with, &without]);
}

#[test]
fn chain_macro_connects_consecutive_elements() {
    let with = "#[body(mass = 1, com = -y, inertia = rod(1, 2, y))] link: [Body; 4],
        #[joint(ground -> link[0], about = z)] first: Pin,
        #[joint(link[i].at(-2 * y) -> link[i + 1], about = z)] hinge: [Pin; 3],
        #[joint(link[(7 * 2) % 11].at(-2 * y) -> ground.at(x), about = z)] last: Pin,";
    let link_declaration = |k| format!("#[body(mass = 1, com = -y, inertia = rod(1, 2, y))] link_{k}: Body,");
    let hinge_declaration =
        |k| format!("#[joint(link_{k}.at(-2 * y) -> link_{}, about = z)] hinge_{k}: Pin,", k + 1);
    let without: String = (0..4)
        .map(link_declaration)
        .chain(["#[joint(ground -> link_0, about = z)] first: Pin,".to_string()])
        .chain((0..3).map(hinge_declaration))
        .chain(["#[joint(link_3.at(-2 * y) -> ground.at(x), about = z)] last: Pin,".to_string()])
        .collect();
    assert_same_code(
        [
            "formulation = speeds, independent = (hinge[2], first)",
            "formulation = speeds, independent = (hinge_2, first)",
        ],
        [with, &without],
    );
}

#[test]
fn nested_lists_do_not_explode() {
    let many = "#[body(mass = 1)] a: [Body; 4096], #[body(mass = 1)] b: [Body; 1],";
    assert_eq!(compiler_messages("", many), ["the lists of a mechanism have at most 4096 elements"]);
    let long = "x + ".repeat(2000) + "x";
    let wide = format!("#[output({long})] wide: [Vector; 4000],");
    assert_eq!(compiler_messages("", &wide)[0], "lists expand to at most 1000000 tokens");
    let deep =
        format!("#[body(mass = 1)] a: [Body; 2], #[output(mass(a[{}0]))] m: Scalar,", "0 + ".repeat(50_000));
    assert!(compiler_messages("", &deep)[0].starts_with("expected an index into `a`"));
}
