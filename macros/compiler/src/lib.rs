#![doc = include_str!("../README.md")]

pub mod algebra;
pub mod catalogue;
mod declarations;
pub mod derive;
pub mod diag;
pub mod emit;
pub mod equations;
pub mod export;
mod hull;
pub mod import;
pub mod kinematics;
pub mod language;
pub mod mechanics;
pub mod mechanism;
pub mod passes;
pub mod resolve;
mod source;
pub mod syntax;
pub mod vectorise;

use catalogue::{BY_PARAMETERS, DERIVATIVES, Facts, JACOBIAN};
use diag::{Diagnostic, Diagnostics};
use emit::GeneratedCode;
use expr::Graph;
use linkwork_symbolic::machine;
use proc_macro2::TokenStream;
use source::is_unreserved_identifier;
use std::path::Path;
use syntax::{Description, Mechanism};

pub use declarations::{DeclaredStruct, mechanism_declarations};
pub use derive::{derive, derive_with_options, equations_as_text, equations_latex};
pub use import::{SeparateContact, SeparateContactParameter};
pub use linkwork_symbolic::{expr, lower};
pub use source::{ParsedSource, parse_source_and_import, parse_source_with_contact_limit};
pub use syntax::struct_without_fields_if_duplicate;

/// Compiles `#[mechanism(arguments)] item` to the generated code. Each error is reported as one
/// `compile_error!`; the code of an invalid mechanism contains only its interface. Paths of files are
/// relative to `folder`.
pub fn expand(arguments: TokenStream, item: TokenStream, folder: &Path) -> GeneratedCode {
    let mut cx = Diagnostics::new();
    // rustc already reports missing and wrong commas of the struct.
    let item = syntax::insert_missing_commas(&item).map_or(item, |(separated, _)| separated);
    let Some(source) = parse_source_and_import(arguments, item, folder, &mut cx) else {
        return GeneratedCode { tokens: cx.into_tokens(), text: String::new() };
    };
    let graph = Graph::new();
    let output = compile(&source, &graph, &mut cx);
    if let Some((model, output)) = &output {
        return source.emit_mechanism(model, output);
    }
    // If an imported file could not be read, even the sizes of the mechanism are unknown. An interface with
    // guessed sizes would only cause errors that follow from the first one.
    if !source.imported {
        return errors_with_struct_stub(&source, cx.distinct_errors().map(Diagnostic::compile_error_tokens));
    }
    let mut emitted = source.emit_error_stubs();
    emitted.tokens.extend(cx.into_tokens());
    emitted
}

/// Returns the errors as `compile_error!`. The first replaces the struct's definition, so that rustc reports
/// no further errors where the type is used.
fn errors_with_struct_stub(
    source: &ParsedSource,
    mut errors: impl Iterator<Item = TokenStream>,
) -> GeneratedCode {
    let first = errors.next().unwrap_or_default();
    let mut tokens = emit::struct_alias_with_error(&source.mechanism.shell, &first);
    tokens.extend(errors);
    GeneratedCode { tokens, text: String::new() }
}

/// Compiles a struct whose derives stand above the attribute, so that they have already processed the
/// elements. Returns one `compile_error!` for the derive in place of the struct, and the errors of the
/// struct's grammar.
pub fn expand_derive_above_to_error(
    arguments: TokenStream,
    item: TokenStream,
    folder: &Path,
) -> GeneratedCode {
    let mut cx = Diagnostics::new();
    let Some(source) = parse_source_and_import(arguments, item, folder, &mut cx) else {
        return GeneratedCode { tokens: cx.into_tokens(), text: String::new() };
    };
    let error = derive_above_attribute_error(proc_macro2::Span::call_site());
    errors_with_struct_stub(&source, [error.compile_error_tokens(), cx.into_tokens()].into_iter())
}

/// Returns the error for a `#[derive(…)]` above the attribute; `attribute` is the span of `#[mechanism]`.
pub fn derive_above_attribute_error(attribute: proc_macro2::Span) -> Diagnostic {
    let mut error = Diagnostic::new(attribute, "`#[derive(…)]` is above `#[mechanism]`");
    error.add_help("write it below, where it sees the struct without the elements");
    error
}

/// Compiles a mechanism to C99: the text of a source file and of its header. Returns `None` with the errors
/// in `cx` if the mechanism or the options are not supported.
pub fn export_c(
    source: &ParsedSource,
    options: &export::Options,
    cx: &mut Diagnostics,
) -> Option<export::c::CSourceFiles> {
    let graph = Graph::new();
    // Reproducible programs without lanes compute the same bits as those with lanes.
    let reproducible = source.mechanism.requests.reproducible;
    let passes = passes::PassSelection { lanes: reproducible, ..passes::PassSelection::default() };
    let (model, output) = compile_with_passes(source, &graph, passes, cx)?;
    let tables = source.mechanism.shell.table_names();
    let options =
        &export::Options { left_out: requested_rust_only_functions(source), reproducible, ..options.clone() };
    export::c::export_c_source(&model, &output, &tables, options)
        .map_err(|unfit| report_unsupported_export(&model, unfit, cx))
        .ok()
}

/// Compiles a tree mechanism to kernels in CUDA, and to functions that launch them. Returns `None` with the
/// errors in `cx` if the mechanism or the options are not supported.
pub fn export_cuda(
    source: &ParsedSource,
    options: &export::Options,
    cx: &mut Diagnostics,
) -> Option<export::cuda::KernelFiles> {
    let graph = Graph::new();
    let (model, output) = compile_for_gpu_registers(source, &graph, cx)?;
    let tables = source.mechanism.shell.table_names();
    let options = &export::Options { left_out: requested_rust_only_functions(source), ..options.clone() };
    export::cuda::export_cuda_kernels(&model, &output, &tables, options)
        .map_err(|unfit| report_unsupported_export(&model, unfit, cx))
        .ok()
}

/// Compiles a tree mechanism to compute shaders in WGSL. Returns `None` with the errors in `cx` if the
/// mechanism is not supported.
pub fn export_wgsl(
    source: &ParsedSource,
    prefix: &str,
    cx: &mut Diagnostics,
) -> Option<export::wgsl::ShaderFiles> {
    let graph = Graph::new();
    let (model, output) = compile_for_gpu_registers(source, &graph, cx)?;
    let tables = source.mechanism.shell.table_names();
    let prefix = prefix.to_string();
    let options =
        export::Options { prefix, left_out: requested_rust_only_functions(source), ..Default::default() };
    export::wgsl::export_wgsl_shaders(&model, &output, &tables, &options)
        .map_err(|unfit| report_unsupported_export(&model, unfit, cx))
        .ok()
}

/// Compiles a mechanism to the sources and the description of an FMU. Returns `None` with the errors in `cx`
/// if the mechanism or the options are not supported.
pub fn export_fmu(
    source: &ParsedSource,
    prefix: &str,
    start: &export::fmu::StartValues,
    has_derivatives: bool,
    cx: &mut Diagnostics,
) -> Option<export::fmu::FmuFiles> {
    reject_reproducible_arithmetic(source, "FMUs", cx)?;
    let graph = Graph::new();
    let passes = passes::PassSelection { lanes: false, ..passes::PassSelection::default() };
    let (model, output) = compile_with_passes(source, &graph, passes, cx)?;
    if let Some((what, help)) = export::fmu::export_obstacle(&model, &output) {
        cx.report_error(model.place.clone(), what).add_help(help);
        return None;
    }
    let tables = source.mechanism.shell.table_names();
    let options = export::Options { prefix: prefix.to_string(), ..Default::default() };
    export::fmu::export_fmu(&model, &output, &tables, &options, start, has_derivatives)
        .map_err(|unfit| report_unsupported_export(&model, unfit, cx))
        .ok()
}

/// Compiles a mechanism to the description of an FMU whose binary contains the run-time library, which reads
/// the `declaration`. Returns the files, and the names of outputs that the FMU does not have. Returns `None`
/// with the errors in `cx` if the mechanism is not supported.
pub fn export_fmu_for_runtime_library(
    source: &ParsedSource,
    declaration: &str,
    prefix: &str,
    start: &export::fmu::StartValues,
    cx: &mut Diagnostics,
) -> Option<(export::fmu::FmuFiles, Vec<String>)> {
    reject_reproducible_arithmetic(source, "FMUs", cx)?;
    let graph = Graph::new();
    let passes = passes::PassSelection { lanes: false, ..passes::PassSelection::default() };
    let (model, output) = compile_with_passes(source, &graph, passes, cx)?;
    let tables = source.mechanism.shell.table_names();
    let missing_in_library_fmu_message =
        |what: &str| format!("FMUs with the run-time library have no {what}");
    let what = match (&source.mechanism.file, tables.is_empty()) {
        (Some(_), _) => Some((
            missing_in_library_fmu_message("mechanisms of robot files"),
            "`linkwork convert` writes a declaration",
        )),
        (None, false) => Some((missing_in_library_fmu_message("tables"), "remove them, or `--library`")),
        (None, true) => None,
    };
    if let Some((what, help)) = what {
        cx.report_error(model.place.clone(), what).add_help(help);
        return None;
    }
    Some(export::fmu::export_fmu_for_runtime_library(&model, &output, declaration, prefix, start))
}

/// Derives the functions of a tree mechanism, with instructions in an order for processors that keep all
/// values in registers.
fn compile_for_gpu_registers<'g>(
    source: &ParsedSource,
    graph: &'g Graph,
    cx: &mut Diagnostics,
) -> Option<(mechanism::Model<'g>, derive::DerivationOutput)> {
    reject_reproducible_arithmetic(source, "kernels", cx)?;
    let passes = passes::PassSelection { lanes: false, ..passes::PassSelection::default() };
    let (model, mut output) = compile_with_passes(source, graph, passes, cx)?;
    reject_constraints_and_contacts(&model, &output, cx)?;
    for function in &mut output.functions {
        let arrays = function.shape.result_arrays();
        let lengths: Vec<usize> = arrays.iter().map(|(_, rows, columns)| rows * columns).collect();
        function.program = std::mem::take(&mut function.program).with_few_live_values(&lengths);
    }
    Some((model, output))
}

/// Rejects mechanisms with reproducible arithmetic, which the target, a plural, does not have.
pub fn reject_reproducible_arithmetic(
    source: &ParsedSource,
    target: &str,
    cx: &mut Diagnostics,
) -> Option<()> {
    if !source.mechanism.requests.reproducible {
        return Some(());
    }
    let place = source.mechanism.description.name.place.clone();
    cx.report_error(place, format!("{target} have no reproducible arithmetic")).add_help(
        "remove `arithmetic = reproducible`, or compile the mechanism in Rust or with `linkwork export c`: \
         both have the same bits on every machine",
    );
    None
}

/// Rejects mechanisms with constraints or contacts, whose functions need solvers.
fn reject_constraints_and_contacts(
    model: &mechanism::Model<'_>,
    output: &derive::DerivationOutput,
    cx: &mut Diagnostics,
) -> Option<()> {
    let has_function = |id: catalogue::GeneratedId| output.functions.iter().any(|f| f.id == id);
    let what = match (has_function(catalogue::GeneratedId::ConstraintJacobian), model.contacts.is_empty()) {
        (true, _) => "constraints",
        (_, false) => "contacts",
        _ => return Some(()),
    };
    cx.report_error(
        model.place.clone(),
        format!("kernels support only trees, and this mechanism has {what}"),
    )
    .add_help(format!(
        "`linkwork export library` writes all functions with {what} for CPUs, `linkwork export c` those \
             that need no solver; without the {what} there are kernels of all functions"
    ));
    None
}

/// Returns the functions that options request and that exist in Rust only.
fn requested_rust_only_functions(source: &ParsedSource) -> Vec<String> {
    let requests = source.mechanism.requests;
    let rust_only = [
        (requests.prepare, "the functions of `prepare`"),
        (requests.batch, "functions of several states at once, of `batch`"),
        (requests.drawing, "the drawing, of `drawing`"),
    ];
    rust_only.into_iter().filter(|(asked, _)| *asked).map(|(_, what)| what.to_string()).collect()
}

/// Reports why a mechanism or the options of an export are not supported.
fn report_unsupported_export(
    model: &mechanism::Model<'_>,
    unfit: export::ExportObstacle,
    cx: &mut Diagnostics,
) {
    let (what, help) = match unfit {
        export::ExportObstacle::NoParameter(name) => (
            format!("there is no parameter `{name}` to be fixed"),
            match model.parameters.is_empty() {
                true => "the mechanism has no parameters".to_string(),
                false => format!("there are {}", model.parameters.join(", ")),
            },
        ),
        export::ExportObstacle::SingleCasadi => (
            "CasADi has no functions of single precision".to_string(),
            "export them in double precision".to_string(),
        ),
        export::ExportObstacle::Irreproducible(what) => (
            format!("{what} has no reproducible arithmetic in C"),
            "remove it or `arithmetic = reproducible`; functions in Rust are reproducible".to_string(),
        ),
        export::ExportObstacle::CasadiSpeeds => (
            "functions for CasADi have no declared speeds".to_string(),
            "they take configuration and velocity for a state whose rate is `(v, a)`, and speeds are not the \
             rates of coordinates: remove `#[speed(…)]`, or export plain C"
                .to_string(),
        ),
        export::ExportObstacle::Missing => (
            "internal error: a value of the functions in C is missing".to_string(),
            "please report this with the declaration of the mechanism".to_string(),
        ),
        export::ExportObstacle::Lanes(of) => (
            format!("internal error: `{of}` was derived with lanes"),
            "please report this with the declaration of the mechanism".to_string(),
        ),
    };
    cx.report_error(model.place.clone(), what).add_help(help);
}

/// Returns the messages of all errors in a mechanism; the list is empty if the mechanism is valid.
pub fn check_mechanism(arguments: TokenStream, item: TokenStream, folder: &Path) -> Vec<String> {
    let mut cx = Diagnostics::new();
    if let Some(source) = parse_source_and_import(arguments, item, folder, &mut cx) {
        compile(&source, &Graph::new(), &mut cx);
    }
    cx.full_message_texts()
}

/// Builds the checked model of a mechanism and derives all generated functions from it.
pub fn compile<'g>(
    source: &ParsedSource,
    graph: &'g Graph,
    cx: &mut Diagnostics,
) -> Option<(mechanism::Model<'g>, derive::DerivationOutput)> {
    compile_with_passes(source, graph, passes::PassSelection::default(), cx)
}

/// Like [`compile`], with a choice of optimisation passes.
pub fn compile_with_passes<'g>(
    source: &ParsedSource,
    graph: &'g Graph,
    passes: passes::PassSelection,
    cx: &mut Diagnostics,
) -> Option<(mechanism::Model<'g>, derive::DerivationOutput)> {
    if !cx.is_empty() {
        check_elements_without_syntax_errors(source, graph, cx);
        return None;
    }
    let compiled = compile_model_and_functions(source, graph, passes, cx);
    if graph.is_full() {
        // The other errors result from truncated expressions.
        *cx = Diagnostics::new();
        cx.report_error(
            source.mechanism.description.name.place.clone(),
            "the equations of this mechanism would be too long",
        )
        .add_help(
            "the generated code has no loops and would have millions of operations: remove options that \
             request derivatives, or use shorter chains of joints and fewer elements",
        );
        return None;
    }
    compiled
}

fn compile_model_and_functions<'g>(
    source: &ParsedSource,
    graph: &'g Graph,
    passes: passes::PassSelection,
    cx: &mut Diagnostics,
) -> Option<(mechanism::Model<'g>, derive::DerivationOutput)> {
    let model = resolve::build_model(&source.mechanism.description, graph, cx)?;
    let requests = source.mechanism.requests;
    let mut output = derive_with_options(&model, requests, passes, cx)?;
    insert_user_documentation(&mut output, &source.mechanism);
    let description = &source.mechanism.description;
    let good = check_state_rates(description, &output.functions, cx);
    let good =
        check_output_names(description, &output.functions, &Facts::from_model(&model, requests), cx) && good;
    good.then_some((model, output))
}

/// Checks the elements of a mechanism that syntax errors do not affect. Elements that depend on wrong ones
/// are not checked, because their errors would only follow from the syntax errors.
pub fn check_elements_without_syntax_errors(source: &ParsedSource, graph: &Graph, cx: &mut Diagnostics) {
    let Mechanism { reading, description, .. } = &source.mechanism;
    if let Some(rest) = reading.readable_description(description).filter(|_| source.imported) {
        resolve::build_model(&rest, graph, cx);
    }
}

/// Inserts the user's documentation of each output before the generated documentation of its functions.
fn insert_user_documentation(output: &mut derive::DerivationOutput, mechanism: &Mechanism) {
    let outputs = &mechanism.description.outputs;
    let notes = mechanism.shell.notes.iter().filter(|(name, _)| outputs.iter().any(|o| o.name.text == *name));
    let prepared = output.prepared.iter_mut().flat_map(|prepared| &mut prepared.functions);
    let mut functions: Vec<&mut derive::Function> = output.functions.iter_mut().chain(prepared).collect();
    for (name, note) in notes {
        for f in functions.iter_mut().filter(|f| f.name == *name && !f.docs.is_empty()) {
            f.docs.insert(0, note.clone());
        }
    }
}

/// Reports rates of states that depend on accelerations or reactions: accelerations depend on the rates of
/// states, which would be circular. Returns true if no rate is wrong.
fn check_state_rates(
    description: &Description,
    functions: &[derive::Function],
    cx: &mut Diagnostics,
) -> bool {
    let before = cx.len();
    for (state, _) in &description.states {
        let name = format!("{}{}", state.text, syntax::RATE_OF_STATE);
        let written = description.outputs.iter().find(|output| output.name.text == name);
        let rate = functions.iter().find(|f| f.id == catalogue::GeneratedId::Output && f.name == name);
        if let Some(written) = written
            && rate.is_none_or(|f| f.arguments.contains(&catalogue::Argument::A))
        {
            cx.report_error(
                written.value.place.clone(),
                "the rate of a state cannot depend on accelerations or reactions",
            )
            .add_help("accelerations follow from the state: write the force that causes them instead");
        }
    }
    cx.len() == before
}

/// Reports outputs whose functions would have the name of another function, or a name that no function can
/// have.
fn check_output_names(
    description: &Description,
    functions: &[derive::Function],
    facts: &Facts,
    cx: &mut Diagnostics,
) -> bool {
    let outputs = &description.outputs;
    let suffixes = [
        (JACOBIAN, "is the Jacobian", true),
        (DERIVATIVES, "gives the derivatives", facts.requests.derivatives),
        (BY_PARAMETERS, "gives the derivatives by parameters", facts.requests.sensitivities),
    ];
    let names_of_derivative_functions = |name: &str| {
        let asked = suffixes.iter().filter(|(.., asked)| *asked);
        let names: Vec<String> = asked.map(|(suffix, ..)| format!("{name}{suffix}")).collect();
        names.into_iter()
    };
    let find_output_by_stripped_suffix = |name: &str| {
        let asked = suffixes.iter().filter(|(.., asked)| *asked);
        asked
            .flat_map(|suffix| outputs.iter().map(move |output| (suffix, &output.name.text)))
            .find(|((suffix, ..), other)| name.strip_suffix(suffix) == Some(other.as_str()))
    };
    let is_function_name_taken = |name: &str| {
        let other = outputs.iter().map(|output| output.name.text.as_str());
        let mut in_lanes = other.filter(|_| facts.requests.batch).map(|other| format!("{other}_lanes"));
        catalogue::has_function(name, facts) || in_lanes.any(|other| other == name)
    };
    for name in outputs.iter().map(|output| &output.name) {
        let text = &name.text;
        if let Some(((suffix, what, _), other)) = find_output_by_stripped_suffix(text) {
            cx.report_error(name.place.clone(), format!("`{text}` {what} of the output `{other}`")).add_help(
                format!("each output has a function of its name and one of its name with `{suffix}`"),
            );
        } else if description.inertias == syntax::InertiaOption::None
            && functions.iter().all(|f| f.name != *text)
        {
            cx.report_error(
                name.place.clone(),
                format!("the output `{text}` names a reaction, which needs inertia"),
            )
            .add_help("remove it, or `inertia = none`: without inertia there are no dynamics");
        } else if !is_unreserved_identifier(text) {
            cx.report_error(
                name.place.clone(),
                format!("a function of a mechanism cannot be called `{text}`"),
            )
            .add_help(
                "keywords, names of its constants and names that begin with two underscores are reserved",
            );
        } else if is_function_name_taken(text) {
            cx.report_error(
                name.place.clone(),
                format!("the name `{text}` is taken: every mechanism has this function"),
            )
            .add_help("choose another name for the output");
        } else if let Some(other) =
            names_of_derivative_functions(text).find(|other| is_function_name_taken(other))
        {
            cx.report_error(
                name.place.clone(),
                format!("the name `{text}` is taken: every mechanism has `{other}`"),
            )
            .add_help("choose another name for the output");
        }
    }
    cx.is_empty()
}
