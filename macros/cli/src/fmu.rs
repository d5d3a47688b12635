//! `linkwork export fmu`: an FMU of the Functional Mock-up Interface 3.0.

use crate::Stop;
use crate::commands::text_option_value;
use crate::export::checked_prefix;
use crate::grid;
use crate::input::MechanismInput;
use crate::motion::MotionStart;
use crate::zip::Archive;
use clap::ArgMatches;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::export::fmu::{FmuFiles, StartValues, TableValues};
use linkwork_compiler::expr::Graph;
use linkwork_compiler::syntax::InertiaOption;
use linkwork_compiler::{export_fmu, export_fmu_for_runtime_library};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Writes an FMU with sources, and with a binary for this machine if there is a C compiler.
pub fn run_fmu_export(matches: &ArgMatches) -> Result<(), Stop> {
    let input = MechanismInput::select_one_mechanism(matches)?;
    let prefix = checked_prefix(matches, "FMI")?;
    let cx = &mut Diagnostics::new();
    let source = input.parse_source(cx);
    let mut source = input.result_without_errors(source, cx)?;
    let graph = Graph::new();
    let values = fmu_start_data(&input, &graph, matches)?;
    let requests = &mut source.mechanism.requests;
    let is_kinematic = source.mechanism.description.inertias == InertiaOption::None;
    let has_derivatives = !is_kinematic && !matches.get_flag("no-derivatives");
    if has_derivatives && values.has_generated_derivatives {
        requests.derivatives = true;
        requests.sensitivities |= values.is_tree && !values.start.parameters.is_empty();
    }
    let library = matches.get_one::<PathBuf>("library");
    let files = match library {
        None => export_fmu(&source, &prefix, &values.start, has_derivatives, cx),
        Some(_) => {
            let declaration = mechanism_declaration_text(&input);
            let made = export_fmu_for_runtime_library(&source, &declaration, &prefix, &values.start, cx);
            made.map(|(files, left_out)| {
                for name in left_out {
                    crate::note!(
                        "linkwork: not in the FMU: {name}, which depends on accelerations or forces"
                    );
                }
                files
            })
        }
    };
    let files = input.result_without_errors(files, cx)?;
    let mut archive = Archive::default();
    for (path, text) in
        files.files.iter().filter(|(path, _)| files.has_sources || !path.starts_with("sources"))
    {
        archive.add_file(path, text.as_bytes())?;
    }
    if !matches.get_flag("no-binary") {
        compile_and_add_binary(&mut archive, &files, text_option_value(matches, "compiler"), library)?;
    }
    let path = matches.get_one::<PathBuf>("out").cloned();
    let path = path.unwrap_or_else(|| PathBuf::from(format!("{}.fmu", files.identifier)));
    std::fs::write(&path, archive.archive_bytes())
        .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", path.display())))?;
    crate::say!("{}", path.display());
    Ok(())
}

/// Compiles the binary for this machine and adds it to the archive, with the run-time library if that is
/// shared.
fn compile_and_add_binary(
    archive: &mut Archive,
    files: &FmuFiles,
    compiler: Option<&str>,
    library: Option<&PathBuf>,
) -> Result<(), Stop> {
    let Some(binary) = compile_shared_library(files, compiler, library)? else {
        if !files.has_sources {
            let why = "an FMU with the run-time library needs a C compiler `cc` (`--compiler NAME`)";
            return Err(Stop::Failure(why.to_string()));
        }
        crate::note!("linkwork: there is no C compiler `cc` (`--compiler NAME`): the FMU has sources only");
        return Ok(());
    };
    let folder = binary_folder();
    let name = format!("{}{}", files.identifier, std::env::consts::DLL_SUFFIX);
    archive.add_file(&format!("{folder}/{name}"), &binary)?;
    if let Some(library) = library.filter(|library| !is_static_library(library)) {
        archive.add_file(&format!("{folder}/{LIBRARY_FILE}"), &std::fs::read(library)?)?;
    }
    Ok(())
}

/// Start values of the variables, and generated functions that derivatives need.
struct FmuStartData {
    start: StartValues,
    /// Whether functions are generated for derivatives of the accelerations by state and inputs.
    has_generated_derivatives: bool,
    /// Whether the mechanism has no constraints.
    is_tree: bool,
}

/// Returns the start values of all variables; the initial state satisfies the constraints.
fn fmu_start_data(input: &MechanismInput, graph: &Graph, matches: &ArgMatches) -> Result<FmuStartData, Stop> {
    let loaded = input.load_mechanism(graph)?;
    let start = MotionStart::new(&loaded, matches)?;
    if let Some(why) = start.reason_without_motion() {
        return Err(Stop::Failure(format!("`{}` cannot be an FMU: {why}", loaded.model.name)));
    }
    let (q, v) = start.initial_state()?;
    let tables = grid::tables_from_options(matches, &loaded.source.tables_with_variable_counts())?
        .into_iter()
        .map(|grid| TableValues {
            axes: grid.axes,
            values: grid.values,
            smooth: grid.smooth,
            extrapolated: grid.extrapolated,
        });
    let mut parameters = start.robot.parameter_values().to_vec();
    let states: Vec<usize> =
        loaded.source.mechanism.description.states.iter().map(|(_, index)| *index).collect();
    states.iter().zip(&start.x).for_each(|(k, x)| parameters[*k] = *x);
    Ok(FmuStartData {
        start: StartValues {
            parameters,
            q,
            v,
            u: start.inputs_at_start().to_vec(),
            tables: tables.collect(),
            states,
        },
        has_generated_derivatives: loaded.model.contacts.is_empty() && loaded.model.speeds.is_none(),
        is_tree: loaded.model.constraints.is_empty(),
    })
}

/// Returns the declaration of a mechanism in Rust, with the options of the command.
fn mechanism_declaration_text(input: &MechanismInput) -> String {
    format!("#[mechanism({})]\n{}", input.declaration.arguments, input.declaration.item)
}

/// Name of the shared library in an FMU.
const LIBRARY_FILE: &str = if cfg!(target_os = "macos") { "liblinkwork_c.dylib" } else { "liblinkwork_c.so" };

/// Returns true for a static library, which becomes a part of the binary.
fn is_static_library(library: &Path) -> bool {
    library.extension().is_some_and(|end| end == "a")
}

/// Returns the folder of the binaries for this machine in an FMU.
fn binary_folder() -> String {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    format!("binaries/{}-{system}", std::env::consts::ARCH)
}

/// Compiles the sources to a shared library. Returns `None` if no compiler is named, and the
/// usual one is not installed.
fn compile_shared_library(
    files: &FmuFiles,
    compiler: Option<&str>,
    library: Option<&PathBuf>,
) -> Result<Option<Vec<u8>>, Stop> {
    let folder = std::env::temp_dir().join(format!("linkwork-fmu-{}", std::process::id()));
    let done = compile_shared_library_in_folder(&folder, files, compiler, library);
    let _ = std::fs::remove_dir_all(&folder);
    done
}

fn compile_shared_library_in_folder(
    folder: &Path,
    files: &FmuFiles,
    compiler: Option<&str>,
    library: Option<&PathBuf>,
) -> Result<Option<Vec<u8>>, Stop> {
    std::fs::create_dir_all(folder.join("sources"))?;
    let mut further: Vec<&str> = Vec::new();
    if let Some(from) = library {
        let name = if is_static_library(from) { "liblinkwork_c.a" } else { LIBRARY_FILE };
        std::fs::copy(from, folder.join(name))
            .map_err(|error| Stop::Failure(format!("cannot read {}: {error}", from.display())))?;
        further.extend(["-L.", "-llinkwork_c"]);
        further.extend(match (is_static_library(from), cfg!(target_os = "macos")) {
            // Symbols of the library remain those of this FMU.
            (true, false) => &["-Wl,--exclude-libs,ALL", "-lpthread", "-ldl"][..],
            (true, true) => &[],
            (false, true) => &["-Wl,-rpath,@loader_path"],
            (false, false) => &["-Wl,-rpath,$ORIGIN"],
        });
    }
    for (path, text) in &files.files {
        std::fs::write(folder.join(path), text)?;
    }
    let binary = folder.join("binary");
    let name = compiler.unwrap_or("cc");
    let output = Command::new(name)
        .current_dir(folder)
        .args(["-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-o"])
        .arg(&binary)
        .args(&files.sources)
        .args(further)
        .arg("-lm")
        .output();
    match output {
        Ok(output) if output.status.success() => Ok(Some(std::fs::read(&binary)?)),
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
