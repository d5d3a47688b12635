//! Input files, converted to the arguments and the struct of the attribute.

use crate::commands::text_option_value;
use crate::{Stop, syntax};
use clap::ArgMatches;
use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::{Diagnostic, Diagnostics};
use linkwork_compiler::expr::Graph;
use linkwork_compiler::import;
use linkwork_compiler::mechanism::Model;
use linkwork_compiler::passes::PassSelection;
use linkwork_compiler::{
    DeclaredStruct, ParsedSource, compile, compile_with_passes, derive_above_attribute_error,
    mechanism_declarations, parse_source_and_import, reject_reproducible_arithmetic,
};
use linkwork_jit::Robot;
use proc_macro2::{Span, TokenStream};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Arguments and struct of a `#[mechanism]`, with the file and folder that contain it.
pub struct MechanismInput {
    /// Path of the file, as named on the command line.
    pub file: PathBuf,
    /// Struct of the mechanism with its attribute.
    pub declaration: DeclaredStruct,
    /// Folder to which paths in the arguments are relative.
    pub folder: PathBuf,
    /// Whether the file is a robot file, not a Rust file.
    pub is_robot: bool,
}

/// Mechanism that was compiled without errors: source, model and generated functions.
pub struct DerivedMechanism<'g> {
    /// Parsed source of the mechanism.
    pub source: ParsedSource,
    /// Resolved model of the mechanism.
    pub model: Model<'g>,
    /// Generated functions of the mechanism.
    pub output: DerivationOutput,
}

/// Mechanism whose functions were compiled to machine code.
pub struct LoadedMechanism<'g> {
    /// Parsed source of the mechanism.
    pub source: ParsedSource,
    /// Resolved model of the mechanism.
    pub model: Model<'g>,
    /// Mechanism whose functions can be called.
    pub robot: Robot,
    /// Equations of motion as HTML with MathML; empty if they are too long to be read.
    pub equations: String,
}

impl MechanismInput {
    /// Returns the mechanism that the command line selects: the only one of its file, or the one that
    /// `--struct` names.
    pub fn select_one_mechanism(matches: &ArgMatches) -> Result<MechanismInput, Stop> {
        let mut all = MechanismInput::select_mechanisms(matches)?;
        if all.len() > 1 {
            let names: Vec<&str> = all.iter().map(|input| input.declaration.name.as_str()).collect();
            return Err(Stop::Failure(format!(
                "{} has several mechanisms: choose one with `--struct NAME`: {}",
                all[0].file.display(),
                names.join(", ")
            )));
        }
        all.pop().ok_or_else(|| Stop::Failure("there is no mechanism".to_string()))
    }

    /// Returns all mechanisms of the file, or only the mechanism that `--struct` names.
    pub fn select_mechanisms(matches: &ArgMatches) -> Result<Vec<MechanismInput>, Stop> {
        let file: &PathBuf =
            matches.get_one("file").ok_or_else(|| Stop::Failure("expected a file".to_string()))?;
        let more: TokenStream = text_option_value(matches, "with")
            .unwrap_or_default()
            .parse()
            .map_err(|error| Stop::Failure(format!("`--with`: {error}")))?;
        let is_rust = file.extension().is_some_and(|end| end.eq_ignore_ascii_case("rs"));
        let mut found =
            if is_rust { mechanisms_of_rust_file(file)? } else { vec![struct_of_robot_file(file)?] };
        if let Some(name) = text_option_value(matches, "struct") {
            let names: Vec<String> = found.iter().map(|input| input.declaration.name.clone()).collect();
            found.retain(|input| input.declaration.name == name);
            if found.is_empty() {
                let names = names.join(", ");
                return Err(Stop::Failure(format!(
                    "{} has no mechanism `{name}`, but {names}",
                    file.display()
                )));
            }
        }
        for input in &mut found {
            input.declaration.append_attribute_arguments(more.clone());
        }
        Ok(found)
    }

    /// Parses the arguments and the struct. Errors are added to `cx`.
    pub fn parse_source(&self, cx: &mut Diagnostics) -> Option<ParsedSource> {
        self.parse_source_with(parse_source_and_import, cx)
    }

    /// Parses the arguments and the struct by a function of the compiler. Errors are added to `cx`.
    fn parse_source_with<T>(
        &self,
        parse: impl FnOnce(TokenStream, TokenStream, &Path, &mut Diagnostics) -> Option<T>,
        cx: &mut Diagnostics,
    ) -> Option<T> {
        let DeclaredStruct { arguments, item, .. } = &self.declaration;
        if let Some(attribute) = self.declaration.derive_above_attribute_error {
            cx.add_diagnostic(derive_above_attribute_error(attribute));
        }
        parse(arguments.clone(), item.clone(), &self.folder, cx)
    }

    /// Prints the compile errors, if there are any.
    pub fn report_errors(&self, cx: &Diagnostics) -> Stop {
        for one in cx.distinct_errors() {
            crate::note!("{}", self.error_with_location(one));
        }
        Stop::Errors
    }

    /// Returns the result of the compiler if there are no errors; otherwise prints the errors.
    pub fn result_without_errors<T>(&self, made: Option<T>, cx: &Diagnostics) -> Result<T, Stop> {
        match made {
            Some(made) if cx.is_empty() => Ok(made),
            _ => Err(self.report_errors(cx)),
        }
    }

    /// Returns the mechanism with its generated functions; otherwise prints the errors.
    pub fn derive_mechanism<'g>(&self, graph: &'g Graph) -> Result<DerivedMechanism<'g>, Stop> {
        let cx = &mut Diagnostics::new();
        let source = self.result_without_errors(self.parse_source(cx), cx)?;
        let (model, output) = self.result_without_errors(compile(&source, graph, cx), cx)?;
        Ok(DerivedMechanism { source, model, output })
    }

    /// Returns the model of the mechanism, and the mechanism with machine code; otherwise prints the errors.
    pub fn load_mechanism<'g>(&self, graph: &'g Graph) -> Result<LoadedMechanism<'g>, Stop> {
        let cx = &mut Diagnostics::new();
        let (mut source, separate) = self.result_without_errors(
            self.parse_source_with(linkwork_jit::parse_source_and_separate_contacts, cx),
            cx,
        )?;
        linkwork_jit::remove_rust_only_options(&mut source);
        let passes = PassSelection { lanes: false, ..PassSelection::default() };
        let allowed = reject_reproducible_arithmetic(&source, "loaded mechanisms", cx);
        let compiled = allowed.and_then(|()| compile_with_passes(&source, graph, passes, cx));
        let (model, output) = self.result_without_errors(compiled, cx)?;
        let equations = output.equations.mathml.clone();
        let robot = linkwork_jit::compiled(&source, &separate, &model, output)
            .map_err(|error| Stop::Failure(error.to_string()))?;
        Ok(LoadedMechanism { source, model, robot, equations })
    }

    /// Converts a diagnostic to an error message with its location.
    pub fn error_with_location(&self, one: &Diagnostic) -> SourceError {
        let (file, at) = match &one.source_position().file {
            Some(at) => (at.file.to_string(), Some((at.line as usize, at.column as usize))),
            None => (
                self.file.display().to_string(),
                (!self.is_robot).then(|| start_of_span(one.source_position().span)),
            ),
        };
        let reword_for_command =
            |text: &String| if self.is_robot { rewrite_advice_for_command(text) } else { text.clone() };
        SourceError {
            mechanism: Some(self.declaration.name.clone()),
            file,
            at,
            message: reword_for_command(&one.message().to_string()),
            notes: one.notes().iter().map(reword_for_command).collect(),
            help_lines: one.help_lines().iter().map(reword_for_command).collect(),
        }
    }
}

/// File extensions of robot files.
const ENDINGS: [&str; 6] = ["urdf", "xacro", "sdf", "world", "mjcf", "xml"];

/// Rewrites advice on the attribute to advice on the command, where options are passed by `--with` and the
/// format follows from the file extension.
fn rewrite_advice_for_command(text: &str) -> String {
    let mut said = text.to_string();
    let mut from = 0;
    while let Some(at) = said[from..].find("`#[mechanism(").map(|at| from + at) {
        let Some(end) = said[at..].find(")]`").map(|end| at + end) else { break };
        let options = &said[at + "`#[mechanism(".len()..end];
        // The file is already named on the command line.
        let is_elided_file_option = |option: &&str| *option == "…" || option.ends_with("= \"…\"");
        let options: Vec<&str> = options.split(", ").skip_while(is_elided_file_option).collect();
        let with = format!("`--with \"{}\"`", options.join(", "));
        said.replace_range(at..end + ")]`".len(), &with);
        from = at + with.len();
    }
    for format in ["urdf", "sdf", "mjcf"] {
        let begin = format!("write `{format} = \"…\"` instead of ");
        if let Some(at) = said.find(&begin) {
            said.replace_range(at.., &format!("give it a name that ends in `.{format}`"));
        }
    }
    said
}

/// Returns line and column of the start of a span, both counted from one.
fn start_of_span(span: Span) -> (usize, usize) {
    let start = span.start();
    (start.line, start.column + 1)
}

/// Error in a mechanism's source file.
#[derive(Default)]
pub struct SourceError {
    /// Name of the struct that contains the error, if any.
    pub mechanism: Option<String>,
    /// Path of the file with the error.
    pub file: String,
    /// Line and column, both counted from one.
    pub at: Option<(usize, usize)>,
    /// Text of the error message, without notes and help.
    pub message: String,
    /// Notes that follow the error message.
    pub notes: Vec<String>,
    /// Suggested corrections of the error.
    pub help_lines: Vec<String>,
}

/// Formats the error with its position in the style of compilers.
impl std::fmt::Display for SourceError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.at {
            Some((line, column)) => write!(f, "{}:{line}:{column}: error: {}", self.file, self.message)?,
            None => write!(f, "{}: error: {}", self.file, self.message)?,
        }
        let lines = self.notes.iter().map(|line| ("note", line));
        for (word, line) in lines.chain(self.help_lines.iter().map(|line| ("help", line))) {
            write!(f, "\n  = {word}: {line}")?;
        }
        Ok(())
    }
}

/// Reads the text of a user's file, and limits its size.
fn read_user_file(path: &Path) -> Result<String, Stop> {
    let read_failure = |why: String| Stop::Failure(format!("{}: {why}", path.display()));
    let about = std::fs::metadata(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => read_failure("there is no such file".to_string()),
        _ => read_failure(error.to_string()),
    })?;
    if !about.is_file() {
        return Err(read_failure("expected a file".to_string()));
    }
    let mut bytes = Vec::new();
    let most = import::LARGEST_FILE as u64;
    std::fs::File::open(path)?
        .take(most + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| read_failure(error.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(read_failure(format!("is larger than {} MiB", most >> 20)));
    }
    String::from_utf8(bytes).map_err(|_| read_failure("is not UTF-8 text".to_string()))
}

/// Returns the mechanisms of a Rust file, including those in inline modules, with paths relative to the
/// package.
fn mechanisms_of_rust_file(path: &Path) -> Result<Vec<MechanismInput>, Stop> {
    let text = read_user_file(path)?;
    let found = mechanism_declarations(&text).map_err(|error| {
        Stop::Syntax(Box::new(SourceError {
            file: path.display().to_string(),
            ..syntax::syntax_error_of_text(&text, &error)
        }))
    })?;
    let whole = path.canonicalize()?;
    let package = whole.ancestors().find(|folder| folder.join("Cargo.toml").is_file());
    let folder = package.or(whole.parent()).unwrap_or(&whole).to_path_buf();
    if found.is_empty() {
        let note = match text.contains("macro_rules!") && text.contains("#[mechanism") {
            true => " outside of macros, which the command does not expand",
            false => "",
        };
        let why = format!("{}: there is no struct with `#[mechanism]`{note}", path.display());
        return Err(Stop::Failure(why));
    }
    let input_from_declaration = |declaration| MechanismInput {
        declaration,
        file: path.to_path_buf(),
        folder: folder.clone(),
        is_robot: false,
    };
    Ok(found.into_iter().map(input_from_declaration).collect())
}

/// Returns a struct without fields whose arguments name a robot file.
fn struct_of_robot_file(path: &Path) -> Result<MechanismInput, Stop> {
    let is_known =
        path.extension().is_some_and(|end| ENDINGS.iter().any(|known| end.eq_ignore_ascii_case(known)));
    let unknown_file_type_failure = || {
        let (file, known) = (path.display(), ENDINGS.join("`, `."));
        Stop::Failure(format!(
            "{file}: unknown type of file: expected a Rust file (`.rs`), or a robot file (`.{known}`) with \
             an element `<robot>`, `<sdf>` or `<mujoco>`"
        ))
    };
    let text = read_user_file(path)
        .map_err(|stop| if is_known || !path.is_file() { stop } else { unknown_file_type_failure() })?;
    if !is_known && !["<robot", "<sdf", "<mujoco"].iter().any(|element| text.contains(element)) {
        return Err(unknown_file_type_failure());
    }
    let declaration = DeclaredStruct::declaration_of_robot_file(path, &text);
    // The path remains as written, so that messages show it, and is resolved in the current directory.
    let folder = std::env::current_dir()?;
    Ok(MechanismInput { declaration, file: path.to_path_buf(), folder, is_robot: true })
}
