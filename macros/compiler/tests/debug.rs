//! Separate bodies of large functions for debug builds, in which calls and lanes are most expensive.

use linkwork_compiler::expand;
use std::path::Path;

/// Returns the generated code of a floating body with arms of six joints, with these options of the
/// attribute.
fn floating_body_code(words: &str, names: &[&str]) -> String {
    let mut item = "struct S {\n#[body(mass = 5, inertia = sphere(5, 0.2))] trunk: Body, \
                    #[joint(ground -> trunk)] base: Free,"
        .to_string();
    for name in names {
        let mut parent = "trunk".to_string();
        for (k, axis) in ["x", "y", "z", "x", "y", "z"].iter().enumerate() {
            item += &format!(
                "#[body(mass = 2, com = 0.2 * y, inertia = diagonal(0.03, 0.04, 0.02))] {name}{k}: Body,
                #[joint({parent} -> {name}{k}, about = {axis})] {name}_joint{k}: Pin,\n"
            );
            parent = format!("{name}{k}.at(0.4 * z)");
        }
    }
    item += "}";
    let arguments = format!("gravity = -9.81 * z, {words}");
    let emitted = expand(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""));
    format!("{}{}", emitted.tokens, emitted.text)
}

/// Returns pairs of bodies: for debug builds, and for all other builds.
fn debug_and_release_bodies(code: &str) -> Vec<(&str, &str)> {
    let both = code.split("#[cfg(debug_assertions)]").skip(1);
    both.map(|text| text.split_once("#[cfg(not(debug_assertions))]").expect("one of either")).collect()
}

#[test]
fn debug_builds_use_operators_instead_of_calls() {
    for names in [&["one"][..], &["left", "right"]] {
        let code = floating_body_code("", names);
        let bodies = debug_and_release_bodies(&code);
        assert!(bodies.len() > 4, "{names:?}: inverse and forward dynamics, at least");
        for (debug, _) in &bodies {
            assert!(!debug.contains("mul_add(") && !debug.contains("mul_sub("), "{names:?}");
            assert!(!debug.contains(".lane::<") && !debug.contains("Ops::splat"), "{names:?}");
        }
        assert!(bodies.iter().any(|(_, other)| other.contains("Ops::mul_add::<f64>;")), "{names:?}");
        assert!(bodies.iter().any(|(_, other)| other.contains(".lane::<")), "{names:?}");
    }
}

/// Checks that batch functions of debug builds evaluate one state at a time, because SIMD lanes would take
/// too much stack.
#[test]
fn debug_batches_evaluate_states_sequentially() {
    let code = floating_body_code("batch, derivatives", &["one"]);
    let bodies = debug_and_release_bodies(&code);
    for call in [
        "|k| self.inverse_dynamics(",
        "|k| self.forward_dynamics(",
        "let found = self.forward_dynamics_derivatives_into(",
    ] {
        let one = format!("{call}&lane(q, k)");
        assert!(bodies.iter().any(|(debug, other)| debug.contains(&one) && !other.contains(&one)), "{call}");
    }
}

/// Batched derivatives of outputs have names in debug builds, too. Second derivatives with respect to
/// configuration, velocities and inputs have six blocks.
#[test]
fn debug_batches_have_all_derivatives() {
    let mut item = "struct S {".to_string();
    for (k, axis) in ["x", "y", "z"].iter().enumerate() {
        let parent = if k == 0 { "ground".to_string() } else { format!("arm{}.at(x)", k - 1) };
        item += &format!(
            "#[body(mass = 1, com = x, inertia = diagonal(1, 2, 2))] arm{k}: Body, #[joint({parent} -> arm{k}, about = {axis})] pin{k}: Pin,
            #[acts(on = arm{k}.at(x + y), along = ground.x)] jet{k}: Force,"
        );
    }
    item += "#[output(a(arm2.at(x) / ground / ground))] felt: Vector, }";
    let emitted = expand("batch, second_derivatives".parse().unwrap(), item.parse().unwrap(), Path::new(""));
    let code = format!("{}{}", emitted.tokens, emitted.text);
    let call = "|k| self.generalized_forces_second_derivatives(&lane(q, k), &lane(v, k)";
    let bodies = debug_and_release_bodies(&code);
    let (debug, _) = bodies.iter().find(|(debug, _)| debug.contains(call)).expect(call);
    assert!(debug.contains("all[k].5") && !debug.contains("all[k].6"), "{debug}");
    let call = "|k| self.felt_derivatives(&lane(q, k), &lane(v, k), &lane(a, k))";
    let (debug, _) = bodies.iter().find(|(debug, _)| debug.contains(call)).expect(call);
    let fields =
        ["by_q", "by_v", "by_a", "by_u"].map(|name| format!("{name}: lane_by_lane(|k| all[k].{name})"));
    let record = format!("::linkwork::OutputJacobians {{ {} }}", fields.join(", "));
    assert!(debug.contains(&format!(";\n{record}")), "{debug}");
}
