//! Names of outputs: an output cannot have the name of another function of the mechanism.

use linkwork_compiler::{check_mechanism, expand};
use std::collections::BTreeSet;
use std::path::Path;

fn mechanism_text(name: &str) -> String {
    format!(
        "struct S {{
            #[particle(mass = 1)] ball: Particle,
            #[joint(ground -> ball, along = (x, y))] table: Stage,
            #[acts(on = table.x)] drive: Force,
            #[output(table.x)] {name}: Scalar,
        }}"
    )
}

/// Returns the names of the functions in generated code.
fn function_names(code: &str) -> BTreeSet<String> {
    let names = code.split("fn ").skip(1).map(|rest| {
        rest.chars().skip_while(|c| *c == ' ').take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    });
    names.filter(|name: &String| !name.is_empty() && !name.starts_with("__")).collect()
}

#[test]
fn outputs_cannot_have_names_of_functions() {
    let empty_tokens = || "".parse().unwrap();
    let mechanism_tokens = |name: &str| mechanism_text(name).parse().unwrap();
    assert_eq!(
        check_mechanism(empty_tokens(), mechanism_tokens("place"), Path::new("")),
        Vec::<String>::new()
    );
    let emitted = expand(empty_tokens(), mechanism_tokens("place"), Path::new(""));
    let code = format!("{}{}", emitted.tokens, emitted.text);
    // Absent functions reserve no names, because they are visible only if no other function matches.
    let is_present_function = |part: &&str| !part.contains("::__private::absent::");
    let code: String = code.split("#[automatically_derived]").filter(is_present_function).collect();
    let names = function_names(&code);
    assert!(names.contains("mass_matrix") && names.contains("place_jacobian"), "{names:?}");
    // Methods of the traits for frames and parameters are not functions of the mechanism.
    let by_name = ["placement", "twist", "acceleration", "jacobian"];
    let by_number = ["placement_of", "velocity_of", "acceleration_of", "jacobian_of"];
    let of_others = [&["place", "place_jacobian", "outputs"][..], &by_name, &by_number].concat();
    for name in names.iter().filter(|name| !of_others.contains(&name.as_str())) {
        let messages = check_mechanism(empty_tokens(), mechanism_tokens(name), Path::new(""));
        assert!(messages.iter().any(|m| m.contains("is taken")), "{name}: {messages:?}");
    }
    for name in ["linearize", "prepare", "joint_torque_regressor", "mass_matrix_lanes", "assemble_jacobian"] {
        assert_eq!(
            check_mechanism(empty_tokens(), mechanism_tokens(name), Path::new("")),
            Vec::<String>::new(),
            "{name}"
        );
    }
    // The Jacobian of such an output would have the name of another function.
    assert!(!check_mechanism(empty_tokens(), mechanism_tokens("frame"), Path::new("")).is_empty());
}

/// Passes of the program may divide constants with another sign, whose result is finite.
#[test]
fn accelerations_may_be_outputs_for_any_coefficients() {
    let item = "struct Drone {
        #[body(mass = 0.8, inertia = diagonal(0.006, 0.007, 0.012))] frame: Body,
        #[joint(ground -> frame)] flight: Free,
        #[body(mass = 0.1, com = -0.3 * z, inertia = diagonal(0.001, 0.001, 0.0002))] load: Body,
        #[joint(frame -> load)] hook: Ball,
        #[acts(on = frame.at(0.15 * x), along = frame.z)] front: Force,
        #[acts(on = frame.at(-0.15 * x), along = frame.z)] back: Force,
        #[acts(on = frame.at(0.15 * y), along = frame.z)] left: Force,
        #[acts(on = frame.at(-0.15 * y), along = frame.z)] right: Force,
        #[acts(on = frame, about = frame.z)] yaw: Torque,
        #[output(omega(frame / ground), resolved_in = frame)] gyroscope: Vector,
        #[output(a(frame / ground / ground) + 9.81 * z, resolved_in = frame)] accelerometer: Vector,
        #[output(r(frame / ground))] fix: Vector,
    }";
    let arguments = "gravity = -9.81 * z, derivatives".parse().unwrap();
    let emitted = expand(arguments, item.parse().unwrap(), Path::new(""));
    let code = format!("{}{}", emitted.tokens, emitted.text);
    assert!(!code.contains("compile_error"), "{}", code.split("compile_error").nth(1).unwrap_or_default());
}
