//! Loading of mechanisms from files and texts.

use crate::about::MechanismDocumentation;
use crate::configuration_space::ConfigurationSpaceFunction;
use crate::constrained;
use crate::error::Error;
use crate::frames::Frames;
use crate::functions::CallableFunctionBuilder;
use crate::internal::INTERNAL;
use crate::methods::METHODS;
use crate::names::CONTACTS;
use crate::polytopes::Polytopes;
use crate::robot::Robot;
use crate::separate::{SeparateContactFunction, SeparateContacts};
use crate::shared::{
    Constraints, Contact, FirstOrderState, ParameterRequirement, Quantity, SharedMechanism, Sizes,
};
use linkwork::__private::Rule;
use linkwork_compiler::diag::{Diagnostic, Diagnostics};
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::{self, Model};
use linkwork_compiler::passes::PassSelection;
use linkwork_compiler::syntax::{EquationsOption, RATE_OF_STATE};
use linkwork_compiler::{
    DeclaredStruct, ParsedSource, SeparateContact, compile_with_passes, derive_above_attribute_error, import,
    mechanism_declarations, parse_source_and_import, parse_source_with_contact_limit,
    reject_reproducible_arithmetic,
};
use proc_macro2::TokenStream;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Loads a robot from a URDF, MJCF or SDF file, or a mechanism from a Rust file that declares one.
///
/// # Errors
///
/// The file cannot be read, or its mechanism is wrong.
pub fn load(path: impl AsRef<Path>) -> Result<Robot, Error> {
    Loader::file(path).load()
}

/// Loads a mechanism from its declaration in Rust's syntax: a struct with `#[mechanism]`.
///
/// # Errors
///
/// The text is not a declaration, or its mechanism is wrong.
pub fn declare(text: &str) -> Result<Robot, Error> {
    Loader::text(text).load()
}

/// Source of a mechanism: a file or a text.
#[derive(Clone, Debug)]
enum Origin {
    File(PathBuf),
    Text(String),
}

/// Loader of a mechanism, with its settings.
#[derive(Clone, Debug)]
pub struct Loader {
    origin: Origin,
    options: String,
    name: Option<String>,
    folder: Option<PathBuf>,
    readable_equations: bool,
    interpreted: bool,
    /// Whether the mechanism is a separate contact, of which only few functions are called.
    is_separate_contact: bool,
    /// Whether contacts are separate even if they fit into the contact points of a mechanism, for tests.
    separates_contacts: bool,
}

/// Stack size of the thread that compiles mechanisms, bytes, sufficient for deeply nested expressions.
const STACK: usize = 256 << 20;

impl Loader {
    /// Creates a loader for a mechanism in a file.
    pub fn file(path: impl AsRef<Path>) -> Loader {
        Loader::new(Origin::File(path.as_ref().to_path_buf()))
    }

    /// Creates a loader for a declaration in Rust's syntax.
    #[must_use]
    pub fn text(text: &str) -> Loader {
        Loader::new(Origin::Text(text.to_string()))
    }

    fn new(origin: Origin) -> Loader {
        let (options, name, folder) = (String::new(), None, None);
        Loader {
            origin,
            options,
            name,
            folder,
            readable_equations: false,
            interpreted: false,
            is_separate_contact: false,
            separates_contacts: false,
        }
    }

    /// Adds options of the attribute `#[mechanism]`, in the same syntax: `base = free, derivatives`.
    /// Functions are in double precision, with `scalar = f32` as well; `prepare`, `batch` and `packed` have
    /// no effect.
    #[must_use]
    pub fn options(mut self, options: &str) -> Loader {
        let separator = if self.options.is_empty() || options.is_empty() { "" } else { ", " };
        self.options = format!("{}{separator}{options}", self.options);
        self
    }

    /// Chooses a struct by its name, in a text or Rust file that declares several mechanisms.
    #[must_use]
    pub fn name(mut self, name: &str) -> Loader {
        self.name = Some(name.to_string());
        self
    }

    /// Sets the folder in which files named in the declaration are searched; by default it is the current
    /// folder.
    #[must_use]
    pub fn folder(mut self, folder: impl AsRef<Path>) -> Loader {
        self.folder = Some(folder.as_ref().to_path_buf());
        self
    }

    /// Includes the equations of motion in the mechanism's data if they are short enough to be readable, as
    /// `#[mechanism]` does.
    #[must_use]
    pub fn readable_equations(mut self) -> Loader {
        self.readable_equations = true;
        self
    }

    /// Interprets the functions instead of generating machine code: slow, for tests.
    #[must_use]
    pub fn interpreted(mut self) -> Loader {
        self.interpreted = true;
        self
    }

    /// Creates a loader for the declaration of a separate contact.
    pub(crate) fn separate_contact(text: &str) -> Loader {
        Loader { is_separate_contact: true, ..Loader::text(text) }
    }

    /// Makes all contacts separate, even if they fit into the contact points of a mechanism.
    #[cfg(test)]
    pub(crate) fn separate_contacts(mut self) -> Loader {
        self.separates_contacts = true;
        self
    }

    /// Loads the mechanism.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or its mechanism is wrong.
    pub fn load(self) -> Result<Robot, Error> {
        let interpreted = self.interpreted;
        let shared = Loader::run_on_compiler_thread(move || self.compile_mechanism())?;
        Ok(Robot::new(Arc::new(shared), interpreted))
    }

    /// Runs the compiler on a new thread, because source positions of tokens occupy memory of their thread.
    pub(crate) fn run_on_compiler_thread<T: Send + 'static>(
        run: impl FnOnce() -> Result<T, Error> + Send + 'static,
    ) -> Result<T, Error> {
        let thread = std::thread::Builder::new().name("linkwork".to_string()).stack_size(STACK);
        let thread = thread.spawn(run).map_err(|error| Error::Internal(error.to_string()))?;
        thread.join().map_err(|panic| Error::Internal(panic_message(&*panic)))?
    }

    fn compile_mechanism(self) -> Result<SharedMechanism, Error> {
        let (mut source, separate) = self.read_source_and_separate_contacts()?;
        remove_rust_only_options(&mut source);
        let requests = &mut source.mechanism.requests;
        requests.drawing = false;
        requests.separate_contact = self.is_separate_contact;
        if requests.equations == EquationsOption::Readable && !self.readable_equations {
            requests.equations = EquationsOption::Structure;
        }
        let (graph, cx) = (Graph::new(), &mut Diagnostics::new());
        let passes = PassSelection { lanes: cfg!(target_arch = "x86_64"), ..PassSelection::default() };
        let allowed = reject_reproducible_arithmetic(&source, "loaded mechanisms", cx);
        let compiled = allowed.and_then(|()| compile_with_passes(&source, &graph, passes, cx));
        let Some((model, output)) = compiled.filter(|_| cx.is_empty()) else {
            return Err(self.error_from_diagnostics(cx));
        };
        extract_shared_data(&source, &separate, &model, output)
    }

    /// Reads the declaration of the mechanism without contacts that are separate.
    pub(crate) fn read_source(&self) -> Result<ParsedSource, Error> {
        self.read_source_and_separate_contacts().map(|(source, _)| source)
    }

    /// Reads the declaration of the mechanism and adds the options of the loader. Contacts are separate if
    /// they have more contact points than a mechanism.
    fn read_source_and_separate_contacts(&self) -> Result<(ParsedSource, Vec<SeparateContact>), Error> {
        let (mut declaration, folder) = self.read_declaration()?;
        let options: TokenStream = self
            .options
            .parse()
            .map_err(|error| Error::Syntax(format!("options `{}`: {error}", self.options)))?;
        declaration.append_attribute_arguments(options);
        let cx = &mut Diagnostics::new();
        if let Some(attribute) = declaration.derive_above_attribute_error {
            cx.add_diagnostic(derive_above_attribute_error(attribute));
        }
        let DeclaredStruct { arguments, item, .. } = declaration;
        let source = match self.separates_contacts {
            true => parse_source_and_import(arguments, item, &folder, cx).and_then(|mut source| {
                let separate = source.separate_contacts()?;
                Some((source, separate))
            }),
            false => parse_source_and_separate_contacts(arguments, item, &folder, cx),
        };
        source.filter(|_| cx.is_empty()).ok_or_else(|| self.error_from_diagnostics(cx))
    }

    /// Returns the declaration of the mechanism, and the folder of the files that it names.
    fn read_declaration(&self) -> Result<(DeclaredStruct, PathBuf), Error> {
        let base_folder = || match &self.folder {
            Some(folder) => Ok(folder.clone()),
            None => std::env::current_dir()
                .map_err(|error| Error::File { path: PathBuf::from("."), reason: error.to_string() }),
        };
        match &self.origin {
            Origin::Text(text) => Ok((self.choose_declaration(text, "the text")?, base_folder()?)),
            Origin::File(path) => {
                let text = read_text_file(path)?;
                if !is_rust(path) {
                    return Ok((DeclaredStruct::declaration_of_robot_file(path, &text), base_folder()?));
                }
                let folder = match &self.folder {
                    Some(folder) => folder.clone(),
                    None => path.parent().unwrap_or(Path::new("")).to_path_buf(),
                };
                Ok((self.choose_declaration(&text, &path.display().to_string())?, folder))
            }
        }
    }

    fn choose_declaration(&self, text: &str, origin: &str) -> Result<DeclaredStruct, Error> {
        let mut found = mechanism_declarations(text).map_err(|error| {
            let at = error.span().start();
            Error::Syntax(format!("{origin}: line {}, column {}: {error}", at.line, at.column + 1))
        })?;
        let names: Vec<String> = found.iter().map(|declaration| declaration.name.clone()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        if let Some(name) = &self.name {
            let at = names.iter().position(|known| known == name);
            let at = at.ok_or_else(|| Error::unknown_name_error("mechanism", name, names.iter().copied()))?;
            return Ok(found.swap_remove(at));
        }
        match found.len() {
            1 => Ok(found.swap_remove(0)),
            0 => Err(Error::Syntax(format!("{origin} has no struct with `#[mechanism]`"))),
            _ => Err(Error::Syntax(format!(
                "{origin} has several mechanisms: choose one of {} by its name",
                names.join(", ")
            ))),
        }
    }

    /// Returns the errors of a mechanism with their positions, as compilers print them.
    pub(crate) fn error_from_diagnostics(&self, cx: &Diagnostics) -> Error {
        let messages: Vec<String> = cx.distinct_errors().map(|one| self.diagnostic_message(one)).collect();
        match messages.is_empty() {
            true => Error::Internal("the mechanism could not be compiled".to_string()),
            false => Error::Mechanism(messages),
        }
    }

    fn diagnostic_message(&self, one: &Diagnostic) -> String {
        let start = one.source_position().span.start();
        let here = format!("{}:{}", start.line, start.column + 1);
        let position = match (&one.source_position().file, &self.origin) {
            (Some(at), _) => format!("{}:{}:{}", at.file, at.line, at.column),
            (None, Origin::Text(_)) => format!("declaration:{here}"),
            (None, Origin::File(path)) if is_rust(path) => format!("{}:{here}", path.display()),
            (None, Origin::File(path)) => path.display().to_string(),
        };
        let notes = one.notes().iter().map(|line| ("note", line));
        let help_lines = one.help_lines().iter().map(|line| ("help", line));
        let lines: String =
            notes.chain(help_lines).map(|(kind, line)| format!("\n  = {kind}: {line}")).collect();
        format!("{position}: error: {}{lines}", one.message())
    }
}

fn is_rust(path: &Path) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("rs"))
}

/// Returns the message of a caught panic.
fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "the compiler panicked".to_string())
}

fn read_text_file(path: &Path) -> Result<String, Error> {
    let file_error = |reason: String| Error::File { path: path.to_path_buf(), reason };
    let about = std::fs::metadata(path).map_err(|error| file_error(error.to_string()))?;
    if !about.is_file() {
        return Err(file_error("not a file".to_string()));
    }
    let limit = import::LARGEST_FILE as u64;
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(|error| file_error(error.to_string()))?;
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| file_error(error.to_string()))?;
    if bytes.len() as u64 > limit {
        return Err(file_error(format!("larger than {} MiB", limit >> 20)));
    }
    String::from_utf8(bytes).map_err(|_| file_error("not UTF-8 text".to_string()))
}

/// Returns the robot of a compiled mechanism with its separate contacts, for the command `linkwork`.
///
/// # Errors
///
/// The surfaces of a separate contact have an error.
#[doc(hidden)]
pub fn compiled(
    source: &ParsedSource,
    separate: &[SeparateContact],
    model: &Model<'_>,
    output: linkwork_compiler::derive::DerivationOutput,
) -> Result<Robot, Error> {
    Ok(Robot::new(Arc::new(extract_shared_data(source, separate, model, output)?), false))
}

/// Parses the struct and imports its file. Contacts that have more contact points than a mechanism become
/// separate where possible; otherwise contacts of the file are left out, as in compiled mechanisms.
#[doc(hidden)]
pub fn parse_source_and_separate_contacts(
    arguments: TokenStream,
    item: TokenStream,
    folder: &Path,
    cx: &mut Diagnostics,
) -> Option<(ParsedSource, Vec<SeparateContact>)> {
    let mut own = Diagnostics::new();
    let source = parse_source_with_contact_limit(arguments.clone(), item.clone(), folder, CONTACTS, &mut own);
    if let Some(mut source) = source.filter(|_| own.is_empty()) {
        if !source.exceeds_contact_points() {
            return Some((source, Vec::new()));
        }
        if let Some(separate) = source.separate_contacts() {
            return Some((source, separate));
        }
    }
    parse_source_and_import(arguments, item, folder, cx).map(|source| (source, Vec::new()))
}

/// Removes options that only apply to generated Rust code.
#[doc(hidden)]
pub fn remove_rust_only_options(source: &mut ParsedSource) {
    let requests = &mut source.mechanism.requests;
    (requests.prepare, requests.batch, requests.packed) = (false, false, false);
}

/// Extracts the data of a compiled mechanism that its robots share.
fn extract_shared_data(
    source: &ParsedSource,
    separate: &[SeparateContact],
    model: &Model<'_>,
    mut output: linkwork_compiler::derive::DerivationOutput,
) -> Result<SharedMechanism, Error> {
    let frames = Frames::new(model, &mut output);
    let mut maker = CallableFunctionBuilder { model, output: &output, entries: Vec::new() };
    maker.add_derived_functions();
    ConfigurationSpaceFunction::add(&mut maker);
    constrained::add(&mut maker);
    maker.entries.extend(frames.frame_function_entries(model.time));
    let (separate, separate_contacts) = SeparateContacts::load(separate, &frames, &model.parameters)?;
    let contacts = if separate.is_empty() { contacts_of_model(model) } else { separate_contacts };
    if !separate.is_empty() {
        maker.entries.extend(SeparateContactFunction::entries(&contacts, model.nv(), model.time));
    }
    let (mut entries, sizes) = (maker.entries, Sizes { nq: model.nq(), nv: model.nv(), nu: model.nu() });
    for entry in &mut entries {
        entry.lengths = entry.arguments.iter().map(|argument| sizes.length(*argument)).collect();
    }
    let index: HashMap<String, usize> =
        entries.iter().enumerate().map(|(k, entry)| (entry.name.clone(), k)).collect();
    let indices_of_function_names =
        |names: &[&str]| names.iter().map(|name| index.get(*name).copied()).collect();
    let (methods, internal) = (indices_of_function_names(METHODS), indices_of_function_names(INTERNAL));
    let quantities_with_units = |names: &mut dyn Iterator<Item = &String>, units: &[String]| {
        let unit_of_quantity = |k: usize| units.get(k).cloned().unwrap_or_default();
        names
            .enumerate()
            .map(|(k, name)| Quantity { name: name.clone(), unit: unit_of_quantity(k) })
            .collect::<Vec<_>>()
    };
    let states = source.mechanism.description.states.iter().map(|(name, parameter)| FirstOrderState {
        parameter: *parameter,
        rate: index.get(&format!("{}{RATE_OF_STATE}", name.text)).copied(),
    });
    let states = states.collect();
    let mut defaults = vec![f64::NAN; model.parameters.len()];
    for (_, k) in &source.mechanism.description.states {
        defaults[*k] = 0.0;
    }
    let values: Vec<f64> =
        source.mechanism.shell.file_fields.iter().flat_map(|field| field.values.iter().copied()).collect();
    let first = defaults.len().saturating_sub(values.len());
    defaults[first..].copy_from_slice(&values);
    Ok(SharedMechanism {
        name: model.name.clone(),
        sizes,
        configuration: quantities_with_units(&mut model.configuration.iter(), &model.units.configuration),
        velocities: quantities_with_units(
            &mut model.velocities.iter().map(|(name, _)| name),
            &model.units.velocities,
        ),
        inputs: quantities_with_units(&mut model.inputs.iter().map(|(name, _)| name), &model.units.inputs),
        parameters: quantities_with_units(&mut model.parameters.iter(), &model.units.parameters),
        defaults,
        tables: source.tables_with_variable_counts(),
        limits: model.limits.iter().map(|limit| (limit.v.0, limit.bounds().map(|b| b.is_some()))).collect(),
        requirements: model.requirements.iter().map(|r| convert_requirement(model, r)).collect(),
        equations: output.equations.plain.clone(),
        time: model.time,
        kinematic: model.kinematic,
        has_speeds: model.speeds.is_some(),
        has_feedback: !model.acceleration_forces.is_empty(),
        constraints: constraint_data_of_model(model),
        contact_rates: contacts.iter().map(|contact| contact.rows[1]).sum(),
        contacts,
        separate,
        polytopes: Polytopes::of_model(model),
        states,
        charts: output.charts.clone(),
        frames,
        entries,
        index,
        methods,
        internal,
        about: MechanismDocumentation::new(source, model),
    })
}

fn constraint_data_of_model(model: &Model<'_>) -> Constraints {
    let matching_constraint_indices = |is: fn(&mechanism::Constraint<'_>) -> bool| {
        let all = model.constraints.iter().enumerate();
        all.filter(|(_, constraint)| is(constraint)).map(|(k, _)| k).collect()
    };
    Constraints {
        names: model.constraints.iter().map(|constraint| constraint.name.clone()).collect(),
        holonomic: model.holonomic_count(),
        groups: model.constraints.iter().map(|constraint| constraint.group).collect(),
        slipping: matching_constraint_indices(|constraint| !constraint.friction.is_empty()),
        determining: matching_constraint_indices(|constraint| constraint.determines),
        rank: model.nv().saturating_sub(model.freedom.velocities),
        freedom: [model.freedom.coordinates, model.freedom.velocities],
        overdetermined: model.has_unpruned_redundancy(),
        independent: model.dependent.is_some(),
        angles: (0..model.nq()).filter(|k| model.units.configuration[*k] == "rad").collect(),
    }
}

fn contacts_of_model(model: &Model<'_>) -> Vec<Contact> {
    let mut first = 0;
    let contacts = model.contacts.iter().zip(model.contact_velocity_dependences()).enumerate();
    let contact_with_row_range = |(k, (contact, dependence)): (usize, (&mechanism::Contact<'_>, _))| {
        let count = contact.rates.len();
        first += count;
        Contact {
            name: contact.name.clone(),
            rows: [first - count, count],
            pressed_by: contact.pressed_by.unwrap_or(k),
            of_impulses: contact.of_impulses,
            dependence,
        }
    };
    contacts.map(contact_with_row_range).collect()
}

fn convert_requirement(model: &Model<'_>, requirement: &mechanism::Requirement<'_>) -> ParameterRequirement {
    use mechanism::Rule as Known;
    let rule = match requirement.rule {
        Known::Finite => Rule::Finite,
        Known::Mass => Rule::Mass,
        Known::Length => Rule::Length,
        Known::NotNegative => Rule::NotNegative,
        Known::Positive => Rule::Positive,
        Known::HalfAngle => Rule::HalfAngle,
        Known::Unit => Rule::Unit,
        Known::Fraction => Rule::Fraction,
        Known::Order => Rule::Order,
        Known::Inertia => Rule::Inertia,
    };
    ParameterRequirement {
        rule,
        figure: requirement.figure.clone(),
        parameters: requirement.parameters.iter().map(|k| model.parameters[*k].clone()).collect(),
        count: requirement.values.len(),
    }
}
