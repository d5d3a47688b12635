//! C code of a mechanism with declared generalized speeds, compared with the same functions in Rust.

use linkwork::prelude::*;
use linkwork::{discrete, frame};
use mechanisms_in_speeds::Juggler;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

#[path = "mechanisms/speeds.rs"]
mod mechanisms_in_speeds;

/// Formats a list of numbers as a C array.
fn format_c_array(name: &str, numbers: &[f64]) -> String {
    let list: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
    format!("    const double {name}[] = {{{}}};\n", list.join(", "))
}

/// A function of the exported code, its call, and the results in Rust.
type CallWithExpectedResults = (&'static str, String, Vec<f64>);

/// Exports the mechanism in the given arithmetic, compiles it with the given flags, and returns the numbers
/// that the program prints.
fn export_compile_and_run(
    entries: &[CallWithExpectedResults],
    given: &str,
    arithmetic: &str,
    flags: &[&str],
) -> Vec<Vec<f64>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c").join("speeds").join(arithmetic);
    std::fs::create_dir_all(&folder).expect("a folder of the tests'");
    let exported = Command::new(env!("CARGO_BIN_EXE_linkwork"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["export", "c", "--out"])
        .arg(&folder)
        .arg("--with")
        .arg(format!("arithmetic = {arithmetic}"))
        .arg("tests/mechanisms/speeds.rs")
        .output()
        .expect("the command starts");
    assert!(exported.status.success(), "{}", String::from_utf8_lossy(&exported.stderr));
    let mut main = format!(
        "#include <stdio.h>\n#include \"juggler.h\"\n\nint main(void) {{\n    const juggler self[] = \
         {{{{0.7}}}};\n{given}"
    );
    for (name, call, expected) in entries {
        let n = expected.len();
        let _ = writeln!(
            main,
            "    {{\n        double r[{n}];\n        {call};\n        for (int k = 0; k < {n}; ++k) \
             {{\n            printf(\"%.17g \", r[k]);\n        }}\n        printf(\"\\n\"); /* {name} \
             */\n    }}"
        );
    }
    main.push_str("    return 0;\n}\n");
    std::fs::write(folder.join("main.c"), main).expect("a file of the tests'");
    let compiled = Command::new("cc")
        .current_dir(&folder)
        .args(["-Wall", "-Wextra", "-pedantic", "-Werror"])
        .args(flags)
        .args(["-o", "main", "juggler.c", "main.c", "-lm"])
        .output()
        .expect("the compiler starts");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new(folder.join("main")).output().expect("the program starts");
    let text = String::from_utf8_lossy(&run.stdout).into_owned();
    let parse_numbers_of_line =
        |line: &str| line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    text.lines().map(parse_numbers_of_line).collect()
}

/// Concatenates several results to one list.
fn concatenate_results(parts: &[&[f64]]) -> Vec<f64> {
    parts.concat()
}

/// Returns the functions with their results in Rust, and the declarations of their arguments in C.
fn exported_functions() -> (Vec<CallWithExpectedResults>, String) {
    let m = Juggler { axial: 0.7 };
    const N: usize = Juggler::NV;
    let sine_sample_vector =
        |seed: f64| SVector::<f64, N>::from_fn(|k, _| 0.6 * (seed + 1.7 * k as f64).sin());
    let q = m.integrate(&m.neutral(), &sine_sample_vector(0.3));
    let (v, a, tau, dv): (_, _, _, SVector<f64, N>) = (
        sine_sample_vector(1.1),
        sine_sample_vector(2.3),
        sine_sample_vector(4.0),
        sine_sample_vector(0.9) * 0.3,
    );
    let u = SVector::from([0.8]);
    let there = m.integrate(&q, &dv);
    let (f, h) = (frame!(Juggler, "hand"), 0.02);
    let (by_q, by_v) = m.inverse_dynamics_derivatives(&q, &v, &a);
    let (a_by_q, a_by_v, by_tau) = m.forward_dynamics_derivatives(&q, &v, &tau);
    let (by_state, by_input) = m.linearize(&q, &v, &u);
    let moved = Derivatives::integrate_derivatives_at(&m, &q, &dv);
    let rates = Derivatives::displacement_rate_derivatives(&m, &q, &dv, &v);
    let mut entries: Vec<(&str, &str, Vec<f64>)> = vec![
        ("rates_of_speeds", "(self, q, v, r)", concatenate_results(&[m.rates_of_speeds(&q, &v).as_slice()])),
        ("speeds_of_rates", "(self, q, v, r)", concatenate_results(&[m.speeds_of_rates(&q, &v).as_slice()])),
        ("mass_matrix", "(self, q, r)", concatenate_results(&[m.mass_matrix(&q).as_slice()])),
        (
            "inverse_dynamics",
            "(self, q, v, a, r)",
            concatenate_results(&[m.inverse_dynamics(&q, &v, &a).as_slice()]),
        ),
        (
            "forward_dynamics",
            "(self, q, v, tau, r)",
            concatenate_results(&[m.forward_dynamics(&q, &v, &tau).as_slice()]),
        ),
        (
            "generalized_forces",
            "(self, q, u, r)",
            concatenate_results(&[m.generalized_forces(&q, &u).as_slice()]),
        ),
        ("integrate", "(self, q, dv, r)", concatenate_results(&[there.as_slice()])),
        ("difference", "(self, q, there, r)", concatenate_results(&[m.difference(&q, &there).as_slice()])),
        (
            "displacement_rate",
            "(self, q, dv, v, r)",
            concatenate_results(&[m.displacement_rate(&q, &dv, &v).as_slice()]),
        ),
        (
            "integrate_derivatives",
            "(self, q, dv, r, r + N * N)",
            concatenate_results(&[moved.0.as_slice(), moved.1.as_slice()]),
        ),
        (
            "displacement_rate_derivatives",
            "(self, q, dv, v, r, r + N * N, r + 2 * N * N)",
            concatenate_results(&[rates.0.as_slice(), rates.1.as_slice(), rates.2.as_slice()]),
        ),
        (
            "inverse_dynamics_derivatives",
            "(self, q, v, a, r, r + N * N)",
            concatenate_results(&[by_q.as_slice(), by_v.as_slice()]),
        ),
        (
            "forward_dynamics_derivatives",
            "(self, q, v, tau, r, r + N * N, r + 2 * N * N)",
            concatenate_results(&[a_by_q.as_slice(), a_by_v.as_slice(), by_tau.as_slice()]),
        ),
        (
            "linearize",
            "(self, q, v, u, r, r + 4 * N * N)",
            concatenate_results(&[by_state.as_slice(), by_input.as_slice()]),
        ),
        (
            "frame_velocity",
            "(self, HAND, q, v, r)",
            concatenate_results(&[m.frame_velocity(f, &q, &v).as_slice()]),
        ),
        (
            "frame_acceleration",
            "(self, HAND, q, v, a, r)",
            concatenate_results(&[m.frame_acceleration(f, &q, &v, &a).as_slice()]),
        ),
        ("frame_jacobian", "(self, HAND, q, r)", concatenate_results(&[m.frame_jacobian(f, &q).as_slice()])),
        ("pull", "(self, q, v, u, r)", concatenate_results(&[m.pull(&q, &v, &u).as_slice()])),
    ];
    let concatenated_state = |next: (SVector<f64, { Juggler::NQ }>, SVector<f64, N>)| {
        concatenate_results(&[next.0.as_slice(), next.1.as_slice()])
    };
    let rk4 = discrete::step(&m, &Rk4::step(h), 0.0, &q, &v, &u).expect("it is regular");
    let euler = discrete::step(&m, &SemiImplicitEuler::step(h), 0.0, &q, &v, &u).expect("it is regular");
    entries.push(("rk4_step", "(self, q, v, u, 0.02, r, r + NQ)", concatenated_state(rk4)));
    entries.push(("semi_implicit_euler_step", "(self, q, v, u, 0.02, r, r + NQ)", concatenated_state(euler)));
    let transition_matrices = |next: discrete::Transition<f64, { Juggler::NQ }, N, 1>| {
        concatenate_results(&[next.a::<{ 2 * N }>().as_slice(), next.b::<{ 2 * N }>().as_slice()])
    };
    let call = "(self, q, v, u, 0.02, next, next + NQ, r, r + 4 * N * N, by_h)";
    let rk4 = discrete::transition(&m, &Rk4::step(h), 0.0, &q, &v, &u).expect("it is regular");
    let euler =
        discrete::transition(&m, &SemiImplicitEuler::step(h), 0.0, &q, &v, &u).expect("it is regular");
    entries.push(("rk4_transition", call, transition_matrices(rk4)));
    entries.push(("semi_implicit_euler_transition", call, transition_matrices(euler)));

    let mut given = String::from(
        "    enum { N = JUGGLER_NV, NQ = JUGGLER_NQ, HAND = JUGGLER_FRAME_HAND };\n    double next[NQ + N], \
         by_h[2 * N];\n    (void)(next);\n    (void)(by_h);\n",
    );
    let arrays = [("v", v), ("a", a), ("tau", tau), ("dv", dv)];
    arrays.iter().for_each(|(name, numbers)| given.push_str(&format_c_array(name, numbers.as_slice())));
    given.push_str(&format_c_array("q", q.as_slice()));
    given.push_str(&format_c_array("there", there.as_slice()));
    given.push_str(&format_c_array("u", u.as_slice()));
    // Calls have the frame argument directly after the parameters.
    let entries = entries.into_iter();
    let calls = entries.map(|(name, call, expected)| (name, format!("juggler_{name}{call}"), expected));
    (calls.collect(), given)
}

/// Checks results with a tolerance relative to the largest entry.
fn check_entries_with_tolerance(name: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    assert_eq!(found.len(), expected.len(), "{name}");
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= tolerance * size, "{name}, {k}: {found} is not {expected}");
    }
}

#[test]
fn declared_speeds_in_c_agree_with_rust() {
    let (entries, given) = exported_functions();
    let found = export_compile_and_run(&entries, &given, "fast", &["-std=c99", "-O1"]);
    assert_eq!(found.len(), entries.len());
    for ((name, _, expected), found) in entries.iter().zip(found) {
        check_entries_with_tolerance(name, &found, expected, 1e-11);
    }
}

/// Compilers may fuse products and sums by default, and use other instructions. Rust does not, and without
/// instructions for fused products its operations are those of reproducible arithmetic. Differences of
/// configurations contain an arc tangent of the platform.
#[test]
fn reproducible_c_code_has_the_bits_of_rust() {
    let (mut entries, given) = exported_functions();
    entries.retain(|(name, ..)| !name.ends_with("transition"));
    let found =
        export_compile_and_run(&entries, &given, "reproducible", &["-std=gnu11", "-O2", "-march=native"]);
    assert_eq!(found.len(), entries.len());
    let same_operations = cfg!(all(target_arch = "x86_64", not(target_feature = "fma"), debug_assertions));
    let mut others = Vec::new();
    for ((name, _, expected), found) in entries.iter().zip(found) {
        check_entries_with_tolerance(name, &found, expected, 1e-11);
        if found != *expected {
            others.push(*name);
        }
    }
    let expected: &[&str] = if same_operations { &["difference"] } else { &others };
    assert_eq!(others, expected, "functions with other bits");
}
