//! `linkwork export fmu`: an FMU of the Functional Mock-up Interface 3.0.

use crate::Stop;
use crate::commands::text_option;
use crate::export::checked_prefix;
use crate::grid;
use crate::input::Input;
use crate::motion::Start;
use crate::zip::Archive;
use clap::ArgMatches;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::export::fmu::{FmuFiles, StartValues, TableValues};
use linkwork_compiler::export_fmu;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Model;
use linkwork_compiler::syntax::Inertias;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Writes an FMU with sources, and with a binary for this machine if there is a C compiler.
pub fn run_fmu_export(matches: &ArgMatches) -> Result<(), Stop> {
    let input = Input::one(matches)?;
    let prefix = checked_prefix(matches, "FMI")?;
    let cx = &mut Diagnostics::new();
    let source = input.parse_source(cx);
    let mut source = input.result_without_errors(source, cx)?;
    let graph = Graph::new();
    let values = start_values(&input, &graph, matches)?;
    let requests = &mut source.mechanism.requests;
    let is_kinematic = source.mechanism.description.inertias == Inertias::None;
    if values.is_tree && !is_kinematic && !matches.get_flag("no-derivatives") {
        requests.derivatives = true;
        requests.sensitivities |= !values.start.parameters.is_empty();
    }
    let files = export_fmu(&source, &prefix, &values.start, cx);
    let files = input.result_without_errors(files, cx)?;
    let mut archive = Archive::default();
    for (path, text) in &files.files {
        archive.add(path, text.as_bytes())?;
    }
    if !matches.get_flag("no-binary") {
        match compile_shared_library(&files, text_option(matches, "compiler"))? {
            Some(binary) => archive.add(&binary_path(&files.identifier), &binary)?,
            None => crate::note!(
                "linkwork: there is no C compiler `cc` (`--compiler NAME`): the FMU has sources only"
            ),
        }
    }
    let path = matches.get_one::<PathBuf>("out").cloned();
    let path = path.unwrap_or_else(|| PathBuf::from(format!("{}.fmu", files.identifier)));
    std::fs::write(&path, archive.archive_bytes())
        .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", path.display())))?;
    crate::say!("{}", path.display());
    for line in &files.left_out {
        crate::note!("linkwork: not in the FMU: {line}");
    }
    Ok(())
}

/// Start values of the variables, and whether the mechanism has derivatives of its motion.
struct VariableValues {
    start: StartValues,
    is_tree: bool,
}

/// Returns the start values of all variables; the initial state satisfies the constraints.
fn start_values(input: &Input, graph: &Graph, matches: &ArgMatches) -> Result<VariableValues, Stop> {
    let loaded = input.load_mechanism(graph)?;
    let start = Start::new(&loaded, matches)?;
    if let Some(why) = start.reason_without_motion() {
        return Err(Stop::Failure(format!("`{}` cannot be an FMU: {why}", loaded.model.name)));
    }
    let (q, v) = start.initial_state()?;
    let tables =
        grid::table_options(matches, &loaded.source.tables_with_variable_counts())?.into_iter().map(|grid| {
            TableValues {
                axes: grid.axes,
                values: grid.values,
                smooth: grid.smooth,
                extrapolated: grid.extrapolated,
            }
        });
    let mut parameters = start.robot.parameter_values().to_vec();
    let states: Vec<usize> =
        loaded.source.mechanism.description.states.iter().map(|(_, index)| *index).collect();
    states.iter().zip(&start.x).for_each(|(k, x)| parameters[*k] = *x);
    Ok(VariableValues {
        start: StartValues {
            parameters,
            q,
            v,
            u: start.inputs_at_start().to_vec(),
            tables: tables.collect(),
            states,
        },
        is_tree: is_tree(&loaded.model),
    })
}

/// Returns true for mechanisms whose accelerations have generated derivatives in C.
fn is_tree(model: &Model<'_>) -> bool {
    model.constraints.is_empty() && model.contacts.is_empty() && model.speeds.is_none()
}

/// Returns the path of the binary for this machine in an FMU.
fn binary_path(identifier: &str) -> String {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    format!("binaries/{}-{system}/{identifier}{}", std::env::consts::ARCH, std::env::consts::DLL_SUFFIX)
}

/// Compiles the sources to a shared library. Returns `None` if no compiler is named, and the
/// usual one is not installed.
fn compile_shared_library(files: &FmuFiles, compiler: Option<&str>) -> Result<Option<Vec<u8>>, Stop> {
    let folder = std::env::temp_dir().join(format!("linkwork-fmu-{}", std::process::id()));
    let done = compile_in_folder(&folder, files, compiler);
    let _ = std::fs::remove_dir_all(&folder);
    done
}

fn compile_in_folder(
    folder: &Path,
    files: &FmuFiles,
    compiler: Option<&str>,
) -> Result<Option<Vec<u8>>, Stop> {
    std::fs::create_dir_all(folder.join("sources"))?;
    for (path, text) in &files.files {
        std::fs::write(folder.join(path), text)?;
    }
    let library = folder.join("library");
    let name = compiler.unwrap_or("cc");
    let output = Command::new(name)
        .current_dir(folder)
        .args(["-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-o"])
        .arg(&library)
        .args(&files.sources)
        .arg("-lm")
        .output();
    match output {
        Ok(output) if output.status.success() => Ok(Some(std::fs::read(&library)?)),
        Ok(output) => {
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            Err(Stop::Failure(format!(
                "`{name}` cannot compile the sources (`--no-binary` leaves the binary out): {message}"
            )))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound && compiler.is_none() => Ok(None),
        Err(error) => Err(Stop::Failure(format!("cannot run the compiler `{name}`: {error}"))),
    }
}
