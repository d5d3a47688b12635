//! Wrong calls: each is an error with a message, and changes nothing.

use super::{Fmu, set_option_arguments};
use std::process::Command;

#[test]
fn wrong_calls_and_values_are_errors_with_messages() {
    let values = set_option_arguments(&["cart_mass=1", "pole_mass=0.1", "pole_length=1", "rail_damping=0.1"]);
    let Some(fmu) = Fmu::new("wrong", &[&["../../models/src/cart_pole.rs"], &values[..]].concat()) else {
        return;
    };
    // The value reference 11 of the pole's mass follows time, 4 states, 4 rates, 1 input and the cart's mass.
    let found = fmu.output_lines_of_importer("errors", [0.0, 11.0, 0.0]);
    let expected = [
        "3 fmi3Instantiate: the instantiation token is not that of modelDescription.xml",
        "3 fmi3InstantiateCoSimulation: there is no Event Mode and no intermediate update",
        "3 fmi3ExitInitializationMode: wrong order of calls: not allowed after instantiation",
        "3 fmi3EnterInitializationMode: the tolerance is not positive",
        "3 fmi3EnterInitializationMode: the stop time is before the start time",
        "3 fmi3SetFloat64: `pole_mass` is set to a value that is not finite",
        "3 fmi3SetFloat64: there is no variable with the value reference 1000000",
        "3 fmi3SetFloat64: the number of values differs from that of the variables, all scalars",
        "3 fmi3SetFloat64: an argument is NULL",
        "3 fmi3GetInt32: all variables have the type Float64",
        "3 fmi3GetClock: there are no clocks",
        "3 fmi3SetContinuousStates: wrong order of calls: not allowed in Initialization Mode",
        "3 fmi3ExitInitializationMode: the mass matrix is not positive definite: check masses and inertias",
        "3 fmi3DoStep: wrong order of calls: not allowed in Event Mode",
        "3 fmi3SetFloat64: `q.rail` is a state: it can be set until initialization ends",
        "3 fmi3SetFloat64: the mass matrix is not positive definite: check masses and inertias",
        "3 fmi3SetFloat64: `pole_mass` is a parameter: set it between steps or in Event Mode",
        "3 fmi3SetContinuousStates: NULL, or another number of states",
        "3 fmi3SetTime: the time is not finite",
        "3 fmi3EnterEventMode: wrong order of calls: not allowed after termination",
        "3 fmi3DoStep: the communication point is not the time at which the last step ended",
        "3 fmi3DoStep: the communication step is not positive",
        "3 fmi3EnterContinuousTimeMode: wrong order of calls: not allowed in Step Mode",
        "3",
    ];
    assert_eq!(found, expected);
}

/// Calls all functions at random, in any order and with wrong arguments, of mechanisms with and without
/// constraints and contacts. If the compiler has sanitizers, they check memory and arithmetic.
#[test]
fn random_calls_do_no_harm() {
    let sanitizers = "-fsanitize=address,undefined";
    let check = ["-x", "c", "-", sanitizers, "-o", "/dev/null"];
    let has_sanitizers = Command::new("sh")
        .args(["-c", &format!("echo 'int main(void) {{ return 0; }}' | cc {}", check.join(" "))])
        .output()
        .is_ok_and(|output| output.status.success());
    let more: &[&str] = if has_sanitizers { &[sanitizers, "-fno-sanitize-recover=all"] } else { &[] };
    let cart = set_option_arguments(&["cart_mass=1", "pole_mass=0.1", "pole_length=1", "rail_damping=0.1"]);
    let four_bar =
        set_option_arguments(&["g=9.81", "density=1", "a=0.3", "b=1", "c=0.8", "d=0.9", "q.input=1"]);
    let door = set_option_arguments(&["strength=1", "q.rail=-1", "v.rail=0.7"]);
    let top = set_option_arguments(&[
        "g=9.81",
        "mass=1",
        "height=0.2",
        "axial=0.02",
        "transverse=0.03",
        "v.tip.wz=20",
    ]);
    let all: [(&str, &[&str], &[&str]); 4] = [
        ("random_cart", &["../../models/src/cart_pole.rs"], &cart),
        ("random_four_bar", &["../../models/src/four_bar.rs"], &four_bar),
        ("random_door", &["tests/fmu/mechanisms.rs", "--struct", "Door"], &door),
        ("random_top", &["../../models/src/heavy_top.rs"], &top),
    ];
    for (name, file, values) in all {
        let Some(fmu) =
            Fmu::export_and_compile_with_importer(name, &[file, values].concat(), "attack.c", more)
        else {
            return;
        };
        let variables = fmu.description.matches("<Float64 ").count();
        let lines = fmu.random_call_output_lines(variables, 60);
        let last: Vec<usize> =
            lines[lines.len() - 1].split_whitespace().filter_map(|word| word.parse().ok()).collect();
        assert_eq!(last[0], 0, "{name}: {lines:?}");
        assert!(last[1] > 1000 && last[2] > 1000, "{name}: failures and successes: {last:?}");
    }
}
