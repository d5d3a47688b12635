//! Tests of exported C code: generates a program that calls its functions, compiles and runs it, and compares
//! the results.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Function call: its arguments in C, and the expected results in order.
pub struct CallWithExpectedResults {
    pub name: &'static str,
    pub arguments: &'static str,
    pub results: Vec<Vec<f64>>,
    pub returned: bool,
}

/// Exported mechanism with the calls whose results in C and Rust are compared.
pub struct ExportedMechanismCase {
    /// Prefix of identifiers and of file names.
    pub prefix: &'static str,
    pub parameters: Vec<f64>,
    /// C initialisers of tables, and the C arrays to which the initialisers refer.
    pub tables: [&'static str; 2],
    pub time: Option<f64>,
    /// Values of the arguments of the functions, by name.
    pub given: Vec<(&'static str, Vec<f64>)>,
    pub entries: Vec<CallWithExpectedResults>,
    /// Maximum error of the results, relative to the largest entry of each.
    pub tolerance: f64,
}

/// Returns a C program that prints the results of all calls, one line per call.
pub fn c_test_program(case: &ExportedMechanismCase, scalar: &str) -> String {
    let p = case.prefix;
    let format_number_list = |numbers: &[f64]| {
        let texts: Vec<String> = numbers.iter().map(|x| format!("({scalar}){x:?}")).collect();
        texts.join(", ")
    };
    let mut text = format!(
        "#include \"{p}.h\"\n#include <stdio.h>\n\nstatic void show(int n, const {scalar} *x) {{\n    for \
         (int k = 0; k < n; ++k) {{\n        printf(\"%.17g \", (double)x[k]);\n    }}\n}}\n\nint main(void) \
         {{\n"
    );
    let own = match case.parameters.is_empty() {
        true => "",
        false => {
            let [arrays, tables] = case.tables;
            let _ = writeln!(
                text,
                "{arrays}    static const {p} self = {{{}{tables}}};",
                format_number_list(&case.parameters)
            );
            "&self, "
        }
    };
    for (name, numbers) in case.given.iter().filter(|(_, numbers)| !numbers.is_empty()) {
        let _ = writeln!(text, "    static const {scalar} {name}[] = {{{}}};", format_number_list(numbers));
    }
    for (name, _) in case.given.iter().filter(|(_, numbers)| numbers.is_empty()) {
        let _ = writeln!(text, "    static const {scalar} {name}[1] = {{0}};");
    }
    let most = case.entries.iter().flat_map(|e| &e.results).map(Vec::len).max().unwrap_or(1).max(1);
    for k in 0..6 {
        let _ = writeln!(text, "    static {scalar} r{k}[{most}];");
    }
    for name in ["r1", "r2", "r3", "r4", "r5", "tau", "u"] {
        let _ = writeln!(text, "    (void){name};");
    }
    for entry in &case.entries {
        let (name, frame) = match entry.name.split_once(' ') {
            Some((name, "0")) => (name, "0, ".to_string()),
            Some((name, _)) => (name, format!("{}_FRAMES - 1, ", p.to_uppercase())),
            None => (entry.name, String::new()),
        };
        let timeless = ["neutral", "total_mass", "integrate", "difference", "tangent_rate"];
        let is_timeless = timeless.contains(&name) || name == "standard_parameters";
        let time = case.time.filter(|_| !is_timeless).map_or(String::new(), |t| format!("({scalar}){t:?}, "));
        let comma = if entry.arguments.is_empty() { "" } else { ", " };
        let mut arguments = format!("{own}{frame}{time}{}{comma}", entry.arguments);
        if entry.returned {
            let arguments = arguments.trim_end_matches(", ");
            let _ = writeln!(text, "    r0[0] = {p}_{name}({arguments});\n    show(1, r0);");
        } else {
            let names: Vec<String> = (0..entry.results.len()).map(|k| format!("r{k}")).collect();
            arguments += &names.join(", ");
            let _ = writeln!(text, "    {p}_{name}({arguments});");
            for (k, result) in entry.results.iter().enumerate() {
                let _ = writeln!(text, "    show({}, r{k});", result.len());
            }
        }
        text.push_str("    printf(\"\\n\");\n");
    }
    text.push_str("    return 0;\n}\n");
    text
}

pub fn available_c_compilers() -> Vec<&'static str> {
    let is_compiler_available =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
    let known: Vec<&str> = ["gcc", "clang"].into_iter().filter(is_compiler_available).collect();
    if known.is_empty() { ["cc"].into_iter().filter(is_compiler_available).collect() } else { known }
}

pub fn test_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c").join(name);
    std::fs::create_dir_all(&folder).expect("a folder of the tests'");
    folder
}

/// Runs the command `linkwork export c` in a test folder.
pub fn export_c_code(folder: &Path, arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_linkwork"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["export", "c", "--out"])
        .arg(folder)
        .args(arguments)
        .output()
        .expect("the command starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Compiles a program without warnings, runs it, and returns the numbers that it prints.
pub fn compile_and_run(compiler: &str, folder: &Path, p: &str, main: &str, flags: &[&str]) -> Vec<Vec<f64>> {
    let (source, executable) = (folder.join("main.c"), folder.join(format!("main_{compiler}")));
    std::fs::write(&source, main).expect("a file of the tests'");
    let strict = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"];
    let compiled = Command::new(compiler)
        .current_dir(folder)
        .args(strict)
        .args(flags)
        .arg("-o")
        .arg(&executable)
        .args([format!("{p}.c"), "main.c".to_string()])
        .arg("-lm")
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

pub fn compare_results(case: &ExportedMechanismCase, found: &[Vec<f64>], tolerance: f64) {
    assert_eq!(found.len(), case.entries.len(), "{}", case.prefix);
    for (entry, found) in case.entries.iter().zip(found) {
        let expected = entry.results.concat();
        assert_eq!(found.len(), expected.len(), "{}: {}", case.prefix, entry.name);
        let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            assert!(
                (found - expected).abs() <= tolerance * largest,
                "{}: {}[{k}] is {found} in C and {expected} in Rust",
                case.prefix,
                entry.name
            );
        }
    }
}

/// Size in bytes above which a source file is compiled without optimisation only. Fusing and reordering by
/// the C compiler is tested with the shorter files.
const LONG: u64 = 800_000;

/// Exports C code, compiles it without and with optimisation for this processor, and compares the results
/// with Rust.
pub fn check_exported_code(case: &ExportedMechanismCase, arguments: &[&str]) {
    let compilers = available_c_compilers();
    if compilers.is_empty() {
        println!("skipped: there is no C compiler");
        return;
    }
    let folder = test_folder(case.prefix);
    export_c_code(&folder, &[&["--prefix", case.prefix], arguments].concat());
    let source = folder.join(format!("{}.c", case.prefix));
    let is_long_source = std::fs::metadata(source).expect("it is written").len() > LONG;
    let ways = [&["-O0"][..], &["-O1", "-march=native"]];
    for compiler in compilers {
        for flags in ways.into_iter().take(if is_long_source { 1 } else { 2 }) {
            let found =
                compile_and_run(compiler, &folder, case.prefix, &c_test_program(case, "double"), flags);
            compare_results(case, &found, case.tolerance);
        }
    }
}
