//! `linkwork export`: exports a mechanism's functions to C99, to a library with a C interface, and to readable
//! Rust.

use crate::Stop;
use crate::commands::given;
use crate::input::Input;
use crate::library;
use crate::motion::values;
use clap::ArgMatches;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::export::c::{self, Options};
use linkwork_compiler::syntax::{Inertias, ScalarType};
use linkwork_compiler::{expand, export_c};
use std::path::{Path, PathBuf};

/// Writes a C source file and a header.
pub fn c99(matches: &ArgMatches) -> Result<(), Stop> {
    let input = Input::one(matches)?;
    let cx = &mut Diagnostics::new();
    let source = input.read(cx);
    let mut source = input.checked(source, cx)?;
    let description = &source.mechanism.description;
    let single = match given(matches, "scalar") {
        Some(scalar) => scalar == "float",
        None => description.scalar == ScalarType::F32,
    };
    let kinematic = description.inertias == Inertias::None;
    source.mechanism.requests.derivatives |= !(matches.get_flag("no-derivatives") || kinematic);
    let prefix = given(matches, "prefix").unwrap_or_default().to_string();
    let fixed = values("set", matches)?;
    let fixed = fixed.into_iter().map(|(name, value)| (name.to_string(), value));
    let casadi = matches.get_flag("casadi").then(|| fixed.collect());
    let files = export_c(&source, &Options { prefix, single, casadi, ..Options::default() }, cx);
    let files = input.checked(files, cx)?;
    let folder = matches.get_one::<PathBuf>("out").cloned().unwrap_or_default();
    std::fs::create_dir_all(&folder)
        .map_err(|error| Stop::Failure(format!("cannot make the folder {}: {error}", folder.display())))?;
    let casadi = files.casadi.as_ref().map(|text| ("_casadi.c", text));
    for (end, text) in [(".h", &files.header), (".c", &files.source)].into_iter().chain(casadi) {
        let path = folder.join(format!("{}{end}", files.prefix));
        write(&path, text)?;
        crate::say!("{}", path.display());
    }
    for line in &files.left_out {
        crate::note!("linkwork: not in C: {line}");
    }
    Ok(())
}

/// Writes a crate whose functions have an interface of plain arrays.
pub fn library(matches: &ArgMatches) -> Result<(), Stop> {
    let input = Input::one(matches)?;
    let given_prefix = given(matches, "prefix").map(ToString::to_string);
    let prefix = c::identifier(&given_prefix.unwrap_or_else(|| c::prefix(&input.declaration.name)));
    let made = library::write(&input, &prefix, matches)?;
    let folder = matches.get_one::<PathBuf>("out").cloned().unwrap_or_else(|| PathBuf::from(&prefix));
    for (path, text) in &made.files {
        let path = folder.join(path.replace("NAME", &made.prefix));
        let parent = path.parent().unwrap_or(&folder);
        std::fs::create_dir_all(parent).map_err(|error| {
            Stop::Failure(format!("cannot make the folder {}: {error}", parent.display()))
        })?;
        write(&path, text)?;
        crate::say!("{}", path.display());
    }
    for name in &made.left_out {
        crate::note!("linkwork: not in the library: {name}");
    }
    Ok(())
}

/// Writes the generated Rust code, formatted.
pub fn rust(matches: &ArgMatches) -> Result<(), Stop> {
    let input = Input::one(matches)?;
    let cx = &mut Diagnostics::new();
    if let Some(source) = input.read(cx) {
        linkwork_compiler::compile(&source, &linkwork_compiler::expr::Graph::new(), cx);
    }
    input.checked(Some(()), cx)?;
    let tokens = expand(input.declaration.arguments.clone(), input.declaration.item.clone(), &input.folder)
        .into_tokens()?;
    let text = prettyplease::unparse(&syn::parse2(tokens)?);
    put(matches, &text)
}

/// Writes a text to the file of `--out`, or to standard output.
pub fn put(matches: &ArgMatches, text: &str) -> Result<(), Stop> {
    match matches.get_one::<PathBuf>("out") {
        Some(path) => write(path, text),
        None => {
            crate::print(format_args!("{text}"));
            Ok(())
        }
    }
}

fn write(path: &Path, text: &str) -> Result<(), Stop> {
    std::fs::write(path, text)
        .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", path.display())))
}
