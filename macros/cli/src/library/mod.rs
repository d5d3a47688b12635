//! Generation of a crate, and a header, whose functions take plain arrays with the C calling convention, for
//! C, Python and other languages. The functions are read from the generated Rust code, so that none is
//! omitted.

mod describe;
mod functions;
mod header;
mod write;

use crate::Stop;
use crate::commands::text_option_value;
use crate::grid::{self, TableGrid};
use crate::input::{DerivedMechanism, MechanismInput};
use crate::sources::{self, manifest_dependency};
use clap::ArgMatches;
pub use functions::doc_paragraphs;
use functions::{Function, FunctionArgumentKind};
use linkwork_compiler::ParsedSource;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Model;
use linkwork_compiler::syntax::ScalarType;
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Crate of an exported library.
pub struct LibraryCrate {
    /// Prefix of the library's C names.
    pub prefix: String,
    /// Files of the crate: path within the crate, and text.
    pub files: Vec<(&'static str, String)>,
    /// Rust functions that the exported library does not have.
    pub left_out: Vec<String>,
}

/// Data of the mechanism from which the crate is generated.
struct LibraryData<'a, 'g> {
    input: &'a MechanismInput,
    source: &'a ParsedSource,
    model: &'a Model<'g>,
    prefix: &'a str,
    /// Values of the interpolation tables of the mechanism.
    tables: Vec<TableGrid>,
    /// Exported functions of the library, in the order of their indices.
    functions: Vec<Function>,
    left_out: Vec<String>,
    equations: String,
}

impl LibraryData<'_, '_> {
    fn is_single_precision(&self) -> bool {
        self.source.mechanism.description.scalar == ScalarType::F32
    }

    fn scalar_type_name(&self) -> &'static str {
        if self.is_single_precision() { "f32" } else { "f64" }
    }

    /// Returns the type of the struct with its generic argument.
    fn struct_type_text(&self) -> String {
        match self.source.mechanism.shell.generics.type_params().count() {
            0 => self.input.declaration.name.clone(),
            _ => format!("{}<{}>", self.input.declaration.name, self.scalar_type_name()),
        }
    }

    /// Returns whether the mechanism has unilateral contacts.
    fn has_contacts(&self) -> bool {
        !self.model.contacts.is_empty()
    }
}

/// Generates the crate of a mechanism. It depends on the Linkwork sources in the folder `--linkwork`,
/// otherwise on the sources that the command was built from, if they exist, otherwise on the release in the
/// registry.
pub fn generate_crate(
    input: &MechanismInput,
    prefix: &str,
    matches: &ArgMatches,
) -> Result<LibraryCrate, Stop> {
    let graph = Graph::new();
    let DerivedMechanism { source, model, output } = input.derive_mechanism(&graph)?;
    let shell = &source.mechanism.shell;
    if shell.generics.type_params().count() > 1 || shell.generics.const_params().next().is_some() {
        return Err(Stop::Failure(format!(
            "{}: `{}` has generic parameters beside that of its numbers",
            input.file.display(),
            input.declaration.name
        )));
    }
    let emitted = source.emit_mechanism(&model, &output);
    let expansion = format!("{}\n{}", emitted.tokens, emitted.text);
    let file = syn::parse_file(&expansion)?;
    let (mut functions, left_out) = functions::read_struct_functions(&file.items, &input.declaration.name);
    functions.extend(functions_with_frame_index(&model));
    functions.extend(limit_functions(&model));
    let requests = source.mechanism.requests;
    let kinematic = model.kinematic;
    if !kinematic && model.contacts.is_empty() {
        functions.extend(step_functions(&model, requests.derivatives && !has_sliding_contacts(&functions)));
    }
    let known = LibraryData {
        input,
        source: &source,
        model: &model,
        prefix,
        tables: grid::tables_from_options(matches, &source.tables_with_variable_counts())?,
        functions,
        left_out,
        equations: output.equations.plain.clone(),
    };
    let description = describe::description_as_json(&known);
    let linkwork = text_option_value(matches, "linkwork")
        .map(absolute_source_folder)
        .transpose()?
        .or_else(sources::source_repository_of_binary);
    let manifest = manifest_text(prefix, linkwork.as_deref(), requests.reproducible);
    let text = match matches.get_flag("expanded") {
        true => write::library_source_text(&known, &description, "")? + &expansion,
        false => write::library_source_text(&known, &description, &declaration_with_absolute_paths(input)?)?,
    };
    Ok(LibraryCrate {
        prefix: prefix.to_string(),
        files: vec![
            ("Cargo.toml", manifest),
            ("src/lib.rs", text),
            ("include/NAME.h", header::header_text(&known)),
            ("description.json", description),
        ],
        left_out: known.left_out,
    })
}

/// Returns the folder of the Linkwork sources as an absolute path.
fn absolute_source_folder(folder: &str) -> Result<PathBuf, Stop> {
    let whole = Path::new(folder).canonicalize().ok();
    let whole = whole.filter(|whole| whole.join("runtime/library/Cargo.toml").is_file());
    whole.ok_or_else(|| Stop::Failure(format!("`--linkwork`: {folder} has no sources of Linkwork")))
}

/// Returns whether the mechanism has sliding contacts. Their friction forces are missing from steps with
/// Jacobians.
fn has_sliding_contacts(functions: &[Function]) -> bool {
    functions.iter().any(|f| f.name == "constraint_residuals")
        && functions.iter().all(|f| f.name != "forward_dynamics_derivatives")
}

/// Returns the declaration of the mechanism, with the paths of files made absolute.
fn declaration_with_absolute_paths(input: &MechanismInput) -> Result<String, Stop> {
    let mut arguments = TokenStream::new();
    let mut names_file = false;
    for token in input.declaration.arguments.clone() {
        let is_path = matches!(&token, TokenTree::Literal(_)) && names_file;
        if let TokenTree::Ident(word) = &token {
            names_file = ["urdf", "mjcf", "sdf"].iter().any(|format| word == format);
        } else if !matches!(&token, TokenTree::Punct(sign) if sign.as_char() == '=') {
            names_file = false;
        }
        if !is_path {
            arguments.extend([token]);
            continue;
        }
        let text: syn::LitStr = syn::parse2(token.to_token_stream())?;
        let path = input.folder.join(text.value());
        let path = path.canonicalize().unwrap_or(path);
        arguments.extend(path.to_string_lossy().to_token_stream());
    }
    Ok(format!("#[mechanism({arguments})]\n{}\n", input.declaration.item))
}

/// Returns the functions that take a frame by its index.
fn functions_with_frame_index(model: &Model<'_>) -> Vec<Function> {
    if model.frames.is_empty() {
        return Vec::new();
    }
    let (nq, nv) = (model.nq(), model.nv());
    let configuration_argument = || ("q".to_string(), FunctionArgumentKind::Matrix(nq, 1));
    let velocity_argument = || ("v".to_string(), FunctionArgumentKind::Matrix(nv, 1));
    let acceleration_argument = || ("a".to_string(), FunctionArgumentKind::Matrix(nv, 1));
    let time = model.time.then(|| ("t".to_string(), FunctionArgumentKind::Number));
    let frame_function = |name: &str,
                          function: &str,
                          rest: Vec<(String, FunctionArgumentKind)>,
                          shape: Vec<usize>,
                          about: &str| {
        let arguments: Vec<(String, FunctionArgumentKind)> =
            [("frame".to_string(), FunctionArgumentKind::Frame)]
                .into_iter()
                .chain(time.clone())
                .chain(rest)
                .collect();
        let at = if model.time { "given(g, 1)" } else { "0.0" };
        let first = if model.time { 2 } else { 1 };
        let states: Vec<String> = (first..arguments.len()).map(|k| format!("&given(g, {k})")).collect();
        Function {
            name: name.to_string(),
            docs: vec![about.to_string()],
            call: format!("linkwork::Frames::{function}(m, frame(g)?, {at}, {})", states.join(", ")),
            arguments,
            results: vec![("result".to_string(), shape)],
            lanes: None,
        }
    };
    vec![
        frame_function(
            "frame_placement",
            "placement_of",
            vec![configuration_argument()],
            vec![4, 4],
            "Placement of a frame in the ground: a matrix of four rows and columns with its axes and its \
             origin, m.",
        ),
        frame_function(
            "frame_velocity",
            "velocity_of",
            vec![configuration_argument(), velocity_argument()],
            vec![6],
            "Velocity of a frame: of its origin, m/s, then angular, rad/s; relative to the ground, in ground \
             axes.",
        ),
        frame_function(
            "frame_acceleration",
            "acceleration_of",
            vec![configuration_argument(), velocity_argument(), acceleration_argument()],
            vec![6],
            "Acceleration of a frame: of its origin, m/s², then angular, rad/s²; relative to the ground, in \
             ground axes; without gravity.",
        ),
        frame_function(
            "frame_jacobian",
            "jacobian_of",
            vec![configuration_argument()],
            vec![6, nv],
            "Jacobian of a frame: `frame_velocity` is this times `v`.",
        ),
    ]
}

/// Returns the functions for limits of coordinates, velocities and forces, if there are any.
fn limit_functions(model: &Model<'_>) -> Vec<Function> {
    if model.limits.is_empty() {
        return Vec::new();
    }
    let (nq, nv) = (model.nq(), model.nv());
    let limit_function_declaration = |name: &str, about: &str, takes: Option<(&str, usize)>| Function {
        name: name.to_string(),
        docs: vec![about.to_string()],
        call: match takes {
            None => format!("linkwork::Limits::{name}(m)"),
            Some(_) => format!("linkwork::Limits::{name}(m, &given(g, 0))"),
        },
        arguments: takes
            .iter()
            .map(|(name, n)| ((*name).to_string(), FunctionArgumentKind::Matrix(*n, 1)))
            .collect(),
        results: vec![("result".to_string(), vec![takes.map_or(nv, |(_, n)| n)])],
        lanes: None,
    };
    vec![
        limit_function_declaration(
            "lower_limits",
            "Lower bounds of the coordinates, in the order of `v`; infinite for coordinates without a limit.",
            None,
        ),
        limit_function_declaration(
            "upper_limits",
            "Upper bounds of the coordinates, in the order of `v`; infinite for coordinates without a limit.",
            None,
        ),
        limit_function_declaration(
            "velocity_limits",
            "Maximum velocities, in both directions; infinite for coordinates without a limit.",
            None,
        ),
        limit_function_declaration(
            "effort_limits",
            "Maximum forces and torques, in both directions; infinite for coordinates without a limit.",
            None,
        ),
        limit_function_declaration(
            "clamp_configuration",
            "The configuration within its bounds.",
            Some(("q", nq)),
        ),
        limit_function_declaration("clamp_velocity", "The velocity within its bounds.", Some(("v", nv))),
        limit_function_declaration(
            "clamp_effort",
            "Forces and torques within their bounds.",
            Some(("tau", nv)),
        ),
    ]
}

/// Returns the functions for steps of the classical Runge–Kutta method.
fn step_functions(model: &Model<'_>, with_jacobians: bool) -> Vec<Function> {
    let [nq, nv, nu] = [model.nq(), model.nv(), model.nu()];
    let vector_argument = |name: &str, n| (name.to_string(), FunctionArgumentKind::Matrix(n, 1));
    let time = model.time.then(|| ("t".to_string(), FunctionArgumentKind::Number));
    let state = [
        vector_argument("q", nq),
        vector_argument("v", nv),
        vector_argument("u", nu),
        ("h".to_string(), FunctionArgumentKind::Number),
    ];
    let arguments: Vec<(String, FunctionArgumentKind)> = time.into_iter().chain(state).collect();
    let first = usize::from(model.time);
    let at = if model.time { "given(g, 0)" } else { "0.0" };
    let format_step_call = |function: &str| {
        format!(
            "linkwork::discrete::{function}(m, &linkwork::integrate::Rk4::step(given(g, {})), {at}, \
             &given(g, {first}), &given(g, {}), &given(g, {}))",
            first + 3,
            first + 1,
            first + 2
        )
    };
    let step = Function {
        name: "step".to_string(),
        docs: vec![
            "One step of the classical method of Runge and Kutta, `h` seconds long, under inputs `u` that \
             are held: the state after it."
                .to_string(),
        ],
        arguments: arguments.clone(),
        results: vec![("q".to_string(), vec![nq]), ("v".to_string(), vec![nv])],
        call: format_step_call("step"),
        lanes: None,
    };
    let derivative_result_shape = |name: &str, columns| (name.to_string(), vec![nv, columns]);
    let transition = Function {
        name: "transition".to_string(),
        docs: vec![
            "The same step with its Jacobians, exact to rounding: how configuration and velocity after it \
             change with those before and with the inputs. Changes of configurations are displacements, as \
             `integrate` takes them."
                .to_string(),
        ],
        arguments,
        results: vec![
            ("q".to_string(), vec![nq]),
            ("v".to_string(), vec![nv]),
            derivative_result_shape("q_by_q", nv),
            derivative_result_shape("q_by_v", nv),
            derivative_result_shape("q_by_u", nu),
            derivative_result_shape("v_by_q", nv),
            derivative_result_shape("v_by_v", nv),
            derivative_result_shape("v_by_u", nu),
        ],
        call: format_step_call("transition"),
        lanes: None,
    };
    std::iter::once(step).chain(with_jacobians.then_some(transition)).collect()
}

/// Returns the manifest, which depends on the Linkwork sources in a folder or on the release.
fn manifest_text(prefix: &str, linkwork: Option<&Path>, reproducible: bool) -> String {
    let features = if reproducible { "\n[features]\ndefault = [\"linkwork/reproducible\"]\n" } else { "" };
    format!(
        "[package]\nname = \"{}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[lib]\nname \
         = \"{prefix}\"\ncrate-type = [\"cdylib\", \"staticlib\"]\n\n\
         [dependencies]\n{}\n{}\n{features}\n[workspace]\n",
        prefix.replace('_', "-"),
        manifest_dependency("linkwork", "runtime", linkwork),
        manifest_dependency("linkwork-library", "runtime/library", linkwork),
    )
}

/// Returns the indices of the parameters of each field of a struct.
fn parameter_indices_of_fields(members: &[String]) -> BTreeMap<&str, Vec<usize>> {
    let mut fields: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (k, member) in members.iter().enumerate() {
        let field = member.split(['.', '[']).next().unwrap_or(member);
        fields.entry(field).or_default().push(k);
    }
    fields
}
