//! Reports the machine code of generated functions: size, stack and calls of each function. Fails if a
//! function calls anything that is not in the list below, such as a panic.
//!
//! `cargo run --release -p linkwork-benches --bin assembly [native]`: for cargo's default target, or for this
//! computer's processor. It compiles the package `benches/assembly`.

use linkwork_benches::assembly::{Routine, name_in_source, parse_routines};
use object::{Object, ObjectSymbol};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::{env, fs};

/// Names of functions that generated functions may call in addition to generated functions.
const DOCUMENTED: [&str; 18] = [
    // Copy large results, and fill them with zeros.
    "memcpy",
    "memmove",
    "memset",
    // For angles beyond 10⁵ rad, one by one.
    "cos",
    "sin",
    "sincos",
    // Functions that occur in expressions.
    "acos",
    "asin",
    "atan",
    "atan2",
    "cosh",
    "exp",
    "log",
    "pow",
    "sinh",
    "tan",
    "tanh",
    // Queries the processor's features at the first call.
    "std_detect::detect::cache::detect_and_initialize",
];

fn main() -> ExitCode {
    if !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        println!("assembly: only that of x86-64 on Linux can be read");
        return ExitCode::SUCCESS;
    }
    let words: Vec<String> = env::args().skip(1).collect();
    let done = match words.iter().map(String::as_str).collect::<Vec<&str>>().as_slice() {
        [] => print_routine_tables(""),
        ["native"] => print_routine_tables("-C target-cpu=native"),
        _ => Err("expected nothing or `native`".to_string()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("assembly: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Prints the tables. Returns an error for an undocumented call.
fn print_routine_tables(flags: &str) -> Result<(), String> {
    let (text, object) = build_package(flags)?;
    let (routines, bytes) = (parse_routines(&text), function_sizes_in_object_file(&object)?);
    let (generated, others): (Vec<&String>, Vec<&String>) =
        routines.keys().partition(|symbol| mechanism_and_function_names(symbol).is_some());
    if generated.is_empty() {
        return Err("there are no functions in the assembly".to_string());
    }
    let mut used = BTreeSet::new();
    println!("| function | bytes | instructions | stack, bytes | calls |");
    println!("| --- | ---: | ---: | ---: | --- |");
    let mut generated: Vec<(String, &String)> =
        generated.into_iter().map(|symbol| (display_name_of_symbol(symbol), symbol)).collect();
    generated.sort();
    for (title, symbol) in generated {
        let parts = reachable_functions(symbol, &routines);
        // A function that only calls the function of the same name is skipped.
        let skipped = usize::from(
            parts.get(1).is_some_and(|next| last_path_segment(next) == last_path_segment(symbol)),
        );
        for (k, part) in parts.iter().enumerate().skip(skipped) {
            if k == skipped {
                println!("| {title} {}", format_routine_table_row(part, &routines, &bytes));
            } else if last_path_segment(part) == "with_avx2" && routines[parts[skipped]].calls.contains(*part)
            {
                println!("| – with AVX2 and FMA {}", format_routine_table_row(part, &routines, &bytes));
            }
        }
        used.extend(parts);
    }
    println!("\n| called by these | how many | largest, bytes | instructions | stack, bytes | calls |");
    println!("| --- | ---: | ---: | ---: | ---: | --- |");
    let mut groups: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for symbol in others
        .iter()
        .filter(|symbol| used.contains(symbol.as_str()) && last_path_segment(symbol) != "with_avx2")
    {
        groups.entry(last_path_segment(symbol)).or_default().push(symbol);
    }
    for (title, symbols) in groups {
        if let Some(largest) = symbols.iter().max_by_key(|symbol| bytes.get(**symbol)) {
            println!(
                "| {title} | {} {}",
                symbols.len(),
                format_routine_table_row(largest, &routines, &bytes)
            );
        }
    }
    let wrong = undocumented_calls(&used, &routines);
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(format!("calls that are not documented:\n{}", wrong.join("\n")))
    }
}

/// Returns the names of the mechanism and of the function for a symbol of the package, otherwise `None`.
fn mechanism_and_function_names(symbol: &str) -> Option<(String, String)> {
    let name = name_in_source(symbol);
    let (mechanism, function) = name.strip_prefix("linkwork_assembly::")?.split_once("::")?;
    let is_module = mechanism.starts_with(|c: char| c.is_ascii_lowercase());
    is_module.then(|| (mechanism.to_string(), function.to_string()))
}

fn display_name_of_symbol(symbol: &str) -> String {
    mechanism_and_function_names(symbol)
        .map_or_else(|| last_path_segment(symbol), |(mechanism, function)| format!("{mechanism}, {function}"))
}

/// Returns the values of a function as the remaining cells of a table row.
fn format_routine_table_row(
    symbol: &str,
    routines: &BTreeMap<String, Routine>,
    bytes: &BTreeMap<String, u64>,
) -> String {
    let routine = &routines[symbol];
    let calls = BTreeSet::from_iter(routine.calls.iter().map(|call| last_path_segment(call)));
    let calls = Vec::from_iter(calls).join(", ");
    let bytes = bytes.get(symbol).map_or("–".to_string(), u64::to_string);
    format!("| {bytes} | {} | {} | {calls} |", routine.instructions, routine.stack)
}

/// Compiles the package and returns its assembly and its object file.
fn build_package(flags: &str) -> Result<(String, Vec<u8>), String> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("assembly");
    let folder = env::var_os("CARGO_TARGET_DIR").map_or(package.join("../../target"), PathBuf::from);
    let folder = folder.join(if flags.is_empty() { "assembly" } else { "assembly-native" });
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let folder = folder.canonicalize().map_err(|error| error.to_string())?;
    let [text, object] = ["functions.s", "functions.o"].map(|name| folder.join(name));
    let status = Command::new(env::var_os("CARGO").unwrap_or("cargo".into()))
        .args(["rustc", "--quiet", "--release", "--lib", "--manifest-path"])
        .arg(package.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&folder)
        .args(["--", "-Ccodegen-units=1", "--emit"])
        .arg(format!("asm={},obj={}", text.display(), object.display()))
        .env("RUSTFLAGS", flags)
        .status()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if !status.success() {
        return Err("the package does not compile".to_string());
    }
    let io_error_text = |error: std::io::Error| error.to_string();
    Ok((fs::read_to_string(text).map_err(io_error_text)?, fs::read(object).map_err(io_error_text)?))
}

/// Returns the size of every function in an object file, bytes.
fn function_sizes_in_object_file(object: &[u8]) -> Result<BTreeMap<String, u64>, String> {
    let file = object::File::parse(object).map_err(|error| error.to_string())?;
    let symbols = file.symbols();
    Ok(symbols.filter_map(|symbol| Some((symbol.name().ok()?.to_string(), symbol.size()))).collect())
}

/// Returns a function and all functions of the file that it calls directly or indirectly; the function itself
/// comes first.
fn reachable_functions<'a>(symbol: &'a str, routines: &'a BTreeMap<String, Routine>) -> Vec<&'a str> {
    let mut parts = vec![symbol];
    let mut next = 0;
    while let Some(routine) = parts.get(next).and_then(|part| routines.get(*part)) {
        for call in &routine.calls {
            if routines.contains_key(call) && !parts.contains(&call.as_str()) {
                parts.push(call);
            }
        }
        next += 1;
    }
    parts
}

/// Returns a message for each call of a function that is neither in the file nor on the documented list.
fn undocumented_calls(symbols: &BTreeSet<&str>, routines: &BTreeMap<String, Routine>) -> Vec<String> {
    let mut wrong = Vec::new();
    for symbol in symbols {
        let routine = &routines[*symbol];
        let name = name_in_source(symbol);
        if routine.calls_by_address {
            wrong.push(format!("{name} calls an address that it computes"));
        }
        for call in routine.calls.iter().filter(|call| !routines.contains_key(*call)) {
            let callee = name_in_source(call);
            if !DOCUMENTED.contains(&callee.as_str()) {
                wrong.push(format!("{name} calls {callee}"));
            }
        }
    }
    wrong
}

/// Returns the last segment of a symbol's path, the name of the function.
fn last_path_segment(symbol: &str) -> String {
    let name = name_in_source(symbol);
    name.rsplit("::").next().unwrap_or(&name).to_string()
}
