//! Tests of exported CUDA code: compiled as C++, the kernels run on the processor, one state after another.

use super::compiled::{CallWithExpectedResults, ExportedMechanismCase, compare_results, test_folder};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Number of states of a batch; the last state is compared with Rust.
const STATES: usize = 3;

/// Returns the C++ compilers that are installed.
pub fn available_cpp_compilers() -> Vec<&'static str> {
    let is_compiler_available =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
    ["g++", "clang++"].into_iter().filter(is_compiler_available).collect()
}

/// Returns a C++ program that prints the results of all calls for the last state of a batch.
fn kernel_test_program(case: &ExportedMechanismCase, scalar: &str) -> String {
    let p = case.prefix;
    // Other states have other values.
    let varied_batch_numbers_text = |numbers: &[f64]| {
        let scale_of_state = |k: usize| (k + 1) as f64 / STATES as f64;
        let states = numbers.iter().flat_map(|x| (0..STATES).map(move |k| x * scale_of_state(k)));
        let texts: Vec<String> = states.map(|x| format!("({scalar}){x:?}")).collect();
        if texts.is_empty() { "0".to_string() } else { texts.join(", ") }
    };
    let mut text = format!(
        "#include \"{p}.cuh\"\n#include <stdio.h>\n\ntypedef {scalar} number;\nstatic void show(int n, const \
         number *x) {{\n    for (int k = 0; k < n; ++k) {{\n        printf(\"%.17g \", (double)x[{STATES} * \
         k + {STATES} - 1]);\n    }}\n}}\n\nint main() {{\n    lw_error failed = 0;\n"
    );
    let [arrays, tables] = case.tables;
    text.push_str(arrays);
    for (name, numbers) in &case.given {
        let _ = writeln!(
            text,
            "    static const number {name}[] = {{{}}};\n    (void){name};",
            varied_batch_numbers_text(numbers)
        );
    }
    let own = match case.parameters.is_empty() {
        true => String::new(),
        false => {
            let _ = writeln!(
                text,
                "    static const number own[] = {{{}}};",
                varied_batch_numbers_text(&case.parameters)
            );
            let mut list = "own, ".to_string();
            for (k, table) in split_into_table_initialisers(tables).iter().enumerate() {
                let _ = writeln!(text, "    static const {p}_device::{p}_table table{k} = {table};");
                let _ = write!(list, "table{k}, ");
            }
            list
        }
    };
    let time = case.time.unwrap_or(0.0);
    let _ = writeln!(
        text,
        "    static const number t[] = {{{time:?}}}, h[] = {{({scalar})0.01}};\n    (void)t, (void)h;"
    );
    let most = case.entries.iter().flat_map(|e| &e.results).map(Vec::len).max().unwrap_or(1).max(1);
    for k in 0..6 {
        let _ = writeln!(text, "    static number r{k}[{most} * {STATES}];\n    (void)r{k};");
    }
    case.entries.iter().for_each(|entry| write_kernel_call(&mut text, entry, case, &own));
    text.push_str("    return failed;\n}\n");
    text
}

/// Splits a list of C table initialisers into the tables.
fn split_into_table_initialisers(tables: &str) -> Vec<String> {
    let parts = tables.split("{{").skip(1);
    parts.map(|part| format!("{{{{{}", part.trim_end_matches(", "))).collect()
}

fn write_kernel_call(
    text: &mut String,
    entry: &CallWithExpectedResults,
    case: &ExportedMechanismCase,
    own: &str,
) {
    let p = case.prefix;
    let (name, frame) = match entry.name.split_once(' ') {
        Some((name, "0")) => (name, "0, ".to_string()),
        Some((name, _)) => (name, format!("{}_FRAMES - 1, ", p.to_uppercase())),
        None => (entry.name, String::new()),
    };
    let timeless = ["neutral", "total_mass", "integrate", "difference", "tangent_rate"];
    let is_timed = case.time.is_some() && !timeless.contains(&name);
    let time = if is_timed { "lw_shared(t), " } else { "" };
    let arguments = entry.arguments.replace("0.01", "lw_shared(h)");
    let comma = if arguments.is_empty() { "" } else { ", " };
    let results: Vec<String> = (0..entry.results.len()).map(|k| format!("r{k}")).collect();
    let _ = writeln!(
        text,
        "    failed |= {p}_{name}_batch({STATES}, {own}{frame}{time}{arguments}{comma}{});",
        results.join(", ")
    );
    for (k, result) in entry.results.iter().enumerate() {
        let _ = writeln!(text, "    show({}, r{k});", result.len());
    }
    text.push_str("    printf(\"\\n\");\n");
}

/// Compiles a program without warnings, runs it, and returns the numbers that it prints.
fn compile_and_run(compiler: &str, folder: &Path, p: &str, main: &str) -> Vec<Vec<f64>> {
    let (source, executable) = (folder.join("main.cpp"), folder.join(format!("main_{compiler}")));
    std::fs::write(&source, main).expect("a file of the tests'");
    let compiled = Command::new(compiler)
        .args(["-std=c++14", "-O0", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&executable)
        .arg(&source)
        .output()
        .expect("the compiler starts");
    assert!(compiled.status.success(), "{p}: {}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new(&executable).output().expect("the program starts");
    assert!(run.status.success(), "{p}: {}", run.status);
    let text = String::from_utf8_lossy(&run.stdout).into_owned();
    let parse_numbers_of_line =
        |line: &str| line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    text.lines().map(parse_numbers_of_line).collect()
}

/// Exports CUDA kernels, compiles them as C++ for the processor and compares the results with Rust.
pub fn check_exported_kernels(case: &ExportedMechanismCase, scalar: &str, arguments: &[&str]) {
    let Some(compiler) = available_cpp_compilers().into_iter().next() else {
        println!("skipped: there is no C++ compiler");
        return;
    };
    let folder = test_folder(&format!("cuda_{}_{scalar}", case.prefix));
    let output = Command::new(env!("CARGO_BIN_EXE_linkwork"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["export", "cuda", "--prefix", case.prefix, "--scalar", scalar, "--out"])
        .arg(&folder)
        .args(arguments)
        .output()
        .expect("the command starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = compile_and_run(compiler, &folder, case.prefix, &kernel_test_program(case, scalar));
    compare_results(case, &found, case.tolerance);
}
