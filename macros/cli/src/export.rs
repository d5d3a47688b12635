//! `linkwork export`: exports a mechanism's functions to C99, to a library with a C interface, and to
//! readable Rust.

use crate::Stop;
use crate::commands::text_option_value;
use crate::input::MechanismInput;
use crate::library;
use crate::motion::named_option_values;
use clap::ArgMatches;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::export::{Options, c_name_prefix, identifier_from_name, to_snake_case};
use linkwork_compiler::syntax::{InertiaOption, ScalarType};
use linkwork_compiler::{ParsedSource, expand, export_c, export_cuda, export_wgsl};
use std::path::{Path, PathBuf};

/// Writes the C99 source file and header of a mechanism.
pub fn export_c99_files(matches: &ArgMatches) -> Result<(), Stop> {
    let input = MechanismInput::select_one_mechanism(matches)?;
    let cx = &mut Diagnostics::new();
    let source = input.parse_source(cx);
    let mut source = input.result_without_errors(source, cx)?;
    let single = apply_code_export_options(&mut source, matches);
    let prefix = checked_prefix(matches, "C")?;
    let fixed = named_option_values("set", matches)?;
    let fixed = fixed.into_iter().map(|(name, value)| (name.to_string(), value));
    let casadi = matches.get_flag("casadi").then(|| fixed.collect());
    let files = export_c(&source, &Options { prefix, single, casadi, ..Options::default() }, cx);
    let files = input.result_without_errors(files, cx)?;
    let texts = [(".h", &files.header), (".c", &files.source)];
    let casadi = files.casadi.as_ref().map(|text| ("_casadi.c", text));
    write_files_with_prefix(matches, &files.prefix, &texts.into_iter().chain(casadi).collect::<Vec<_>>())?;
    for line in &files.left_out {
        crate::note!("linkwork: not in C: {line}");
    }
    Ok(())
}

/// Writes kernels in CUDA, and functions that launch them from C++ and Python.
pub fn export_cuda_files(matches: &ArgMatches) -> Result<(), Stop> {
    let input = MechanismInput::select_one_mechanism(matches)?;
    let cx = &mut Diagnostics::new();
    let source = input.parse_source(cx);
    let mut source = input.result_without_errors(source, cx)?;
    let single = apply_code_export_options(&mut source, matches);
    let prefix = checked_prefix(matches, "CUDA")?;
    let files = export_cuda(&source, &Options { prefix, single, ..Options::default() }, cx);
    let files = input.result_without_errors(files, cx)?;
    let texts = [(".cu", &files.kernels), (".cuh", &files.host), ("_cuda.py", &files.python)];
    write_files_with_prefix(matches, &files.prefix, &texts)?;
    for line in &files.left_out {
        crate::note!("linkwork: not in CUDA: {line}");
    }
    Ok(())
}

/// Writes compute shaders in WGSL, and a module for Python that runs them.
pub fn export_wgsl_files(matches: &ArgMatches) -> Result<(), Stop> {
    if text_option_value(matches, "scalar") == Some("double") {
        let why = "WGSL has no double precision: remove `--scalar double`, or use `linkwork export cuda`";
        return Err(Stop::Failure(why.to_string()));
    }
    let input = MechanismInput::select_one_mechanism(matches)?;
    let cx = &mut Diagnostics::new();
    let source = input.parse_source(cx);
    let mut source = input.result_without_errors(source, cx)?;
    apply_code_export_options(&mut source, matches);
    let prefix = checked_prefix(matches, "WGSL")?;
    let files = export_wgsl(&source, &prefix, cx);
    let files = input.result_without_errors(files, cx)?;
    write_files_with_prefix(
        matches,
        &files.prefix,
        &[(".wgsl", &files.shaders), ("_wgpu.py", &files.python)],
    )?;
    for line in &files.left_out {
        crate::note!("linkwork: not in WGSL: {line}");
    }
    Ok(())
}

/// Requests the derivatives unless an option excludes them. Returns true for single precision.
fn apply_code_export_options(source: &mut ParsedSource, matches: &ArgMatches) -> bool {
    let description = &source.mechanism.description;
    let single = match text_option_value(matches, "scalar") {
        Some(scalar) => scalar == "float",
        None => description.scalar == ScalarType::F32,
    };
    let kinematic = description.inertias == InertiaOption::None;
    source.mechanism.requests.derivatives |= !(matches.get_flag("no-derivatives") || kinematic);
    single
}

/// Returns the prefix of names. Rejects a prefix that is not an identifier of the target.
pub fn checked_prefix(matches: &ArgMatches, target: &str) -> Result<String, Stop> {
    let prefix = text_option_value(matches, "prefix").unwrap_or_default().to_string();
    let usable = c_name_prefix(&prefix);
    if prefix.is_empty() || usable == prefix {
        return Ok(prefix);
    }
    Err(Stop::Failure(format!(
        "`--prefix {prefix}` is not a free identifier of {target}; use `--prefix {usable}`"
    )))
}

/// Writes files with a common prefix to the output folder, and prints their paths.
fn write_files_with_prefix(
    matches: &ArgMatches,
    prefix: &str,
    texts: &[(&str, &String)],
) -> Result<(), Stop> {
    let folder = matches.get_one::<PathBuf>("out").cloned().unwrap_or_default();
    std::fs::create_dir_all(&folder)
        .map_err(|error| Stop::Failure(format!("cannot create the folder {}: {error}", folder.display())))?;
    for (end, text) in texts {
        let path = folder.join(format!("{prefix}{end}"));
        write_exported_file(&path, text)?;
        crate::say!("{}", path.display());
    }
    Ok(())
}

/// Writes a crate whose functions have an interface of plain arrays.
pub fn export_library_crate(matches: &ArgMatches) -> Result<(), Stop> {
    let input = MechanismInput::select_one_mechanism(matches)?;
    let given_prefix = text_option_value(matches, "prefix").map(ToString::to_string);
    let prefix =
        identifier_from_name(&given_prefix.unwrap_or_else(|| to_snake_case(&input.declaration.name)));
    let made = library::generate_crate(&input, &prefix, matches)?;
    let folder = matches.get_one::<PathBuf>("out").cloned().unwrap_or_else(|| PathBuf::from(&prefix));
    for (path, text) in &made.files {
        let path = folder.join(path.replace("NAME", &made.prefix));
        let parent = path.parent().unwrap_or(&folder);
        std::fs::create_dir_all(parent).map_err(|error| {
            Stop::Failure(format!("cannot create the folder {}: {error}", parent.display()))
        })?;
        write_exported_file(&path, text)?;
        crate::say!("{}", path.display());
    }
    for name in &made.left_out {
        crate::note!("linkwork: not in the library: {name}");
    }
    Ok(())
}

/// Writes the formatted Rust code that the attribute generates.
pub fn export_rust_code(matches: &ArgMatches) -> Result<(), Stop> {
    let input = MechanismInput::select_one_mechanism(matches)?;
    let cx = &mut Diagnostics::new();
    if let Some(source) = input.parse_source(cx) {
        linkwork_compiler::compile(&source, &linkwork_compiler::expr::Graph::new(), cx);
    }
    input.result_without_errors(Some(()), cx)?;
    let tokens = expand(input.declaration.arguments.clone(), input.declaration.item.clone(), &input.folder)
        .into_tokens()?;
    let text = prettyplease::unparse(&syn::parse2(tokens)?);
    write_output(matches, &text)
}

/// Writes a text to the file of `--out`, or to standard output.
pub fn write_output(matches: &ArgMatches, text: &str) -> Result<(), Stop> {
    match matches.get_one::<PathBuf>("out") {
        Some(path) => write_exported_file(path, text),
        None => {
            crate::print_or_exit(format_args!("{text}"));
            Ok(())
        }
    }
}

fn write_exported_file(path: &Path, text: &str) -> Result<(), Stop> {
    std::fs::write(path, text)
        .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", path.display())))
}
