//! The option `parameters = inertial("trunk")`: values of a file that are parameters of the mechanism, and
//! the fields that hold them.

use super::Name;
use super::expression::parse_name;
use crate::diag::{Diagnostics, join_with_or, syn_error_with_help};
use syn::parse::ParseStream;
use syn::punctuated::Punctuated;
use syn::{Ident, LitStr, Token, bracketed, parenthesized, token};

/// Values of a file, of one kind, that become parameters of the mechanism.
#[derive(Clone, Debug)]
pub struct FileParameters {
    /// Kind of the file values that become parameters, as written.
    pub word: Name,
    /// Names of links or joints; all of them if absent.
    pub of: Option<Vec<Name>>,
}

/// Option value for mass properties of links.
pub const INERTIAL: &str = "inertial";
/// Option value for positions and orientations of joints.
pub const PLACEMENT: &str = "placement";
/// Option value for viscous friction of joints.
pub const DAMPING: &str = "damping";
/// Option value for dry friction of joints.
pub const FRICTION: &str = "friction";

const WORDS: [&str; 4] = [INERTIAL, PLACEMENT, DAMPING, FRICTION];

/// Type of a field that holds values of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFieldKind {
    /// `Inertial` of the runtime: the mass properties of a link.
    Inertial,
    /// `Placement` of the runtime: the pose of a joint on its parent.
    Placement,
    /// The field is a scalar number.
    Number,
}

/// Struct field that holds values of the robot file.
#[derive(Clone, Debug)]
pub struct FileField {
    /// Name of the generated field in Rust.
    pub ident: String,
    /// Type of the generated field.
    pub kind: FileFieldKind,
    /// Name of the link or joint to which the field belongs.
    pub of: String,
    /// Documentation of the generated field.
    pub about: String,
    /// Values in the robot file, in the order of [`value_access_paths`](Self::value_access_paths).
    pub values: Vec<f64>,
    /// Units of the values, in the order of the values.
    pub units: Vec<&'static str>,
}

impl FileField {
    /// Returns the member access of each value relative to a mechanism: `trunk.mass`.
    pub fn value_access_paths(&self) -> Vec<String> {
        let members: &[&str] = match self.kind {
            FileFieldKind::Inertial => {
                &["mass", "com[0]", "com[1]", "com[2]", "ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
            }
            FileFieldKind::Placement => &["xyz[0]", "xyz[1]", "xyz[2]", "rpy[0]", "rpy[1]", "rpy[2]"],
            FileFieldKind::Number => return vec![self.ident.clone()],
        };
        members.iter().map(|member| format!("{}.{member}", self.ident)).collect()
    }
}

/// Parses one kind of file values, or a list of kinds.
pub fn parse(input: ParseStream<'_>) -> syn::Result<Vec<FileParameters>> {
    if !input.peek(token::Bracket) {
        return Ok(vec![parse_file_parameters(input)?]);
    }
    let list;
    bracketed!(list in input);
    Ok(Punctuated::<FileParameters, Token![,]>::parse_terminated_with(&list, parse_file_parameters)?
        .into_iter()
        .collect())
}

fn parse_file_parameters(input: ParseStream<'_>) -> syn::Result<FileParameters> {
    if input.peek(LitStr) {
        let text: LitStr = input.parse()?;
        let help = format!("write `{INERTIAL}(\"{}\")` for the mass properties of a link", text.value());
        return Err(syn_error_with_help(
            text.span(),
            "expected a group of file parameters, found a string",
            &help,
        ));
    }
    if !input.peek(Ident) {
        let help = format!("write `parameters = {INERTIAL}(\"link\")`");
        return Err(syn_error_with_help(input.span(), "expected a group of file parameters", &help));
    }
    let word = parse_name(input)?;
    if !input.peek(token::Paren) {
        return Ok(FileParameters { word, of: None });
    }
    let list;
    parenthesized!(list in input);
    if list.is_empty() {
        let help = format!("write `{}` alone for all of them", word.text);
        return Err(syn_error_with_help(word.place.span, "missing name in these parentheses", &help));
    }
    let parse_quoted_name = |input: ParseStream<'_>| -> syn::Result<Name> {
        if !input.peek(LitStr) {
            let help = "names of the file are strings: `inertial(\"trunk\")`";
            return Err(syn_error_with_help(input.span(), "expected a name in quotation marks", help));
        }
        let text: LitStr = input.parse()?;
        Ok(Name { text: text.value(), place: text.span().into() })
    };
    let names = Punctuated::<Name, Token![,]>::parse_terminated_with(&list, parse_quoted_name)?;
    Ok(FileParameters { word, of: Some(names.into_iter().collect()) })
}

/// Returns the known kinds, each once; reports unknown kinds and duplicates.
pub fn validated_file_parameters(
    requested: Vec<FileParameters>,
    cx: &mut Diagnostics,
) -> Vec<FileParameters> {
    let mut good: Vec<FileParameters> = Vec::new();
    for figures in requested {
        let word = &figures.word;
        if !WORDS.contains(&word.text.as_str()) {
            let words = WORDS.map(|word| format!("`{word}`"));
            let error =
                cx.report_error(word.place.clone(), format!("unknown file parameters `{}`", word.text));
            error.suggest_name(&word.text, WORDS);
            error.add_help(format!("parameters of a file are {}", join_with_or(&words)));
        } else if good.iter().any(|known| known.word.text == word.text) {
            cx.report_error(word.place.clone(), format!("`{}` is given twice", word.text))
                .add_help(format!("list all names in one: `{}(\"…\", \"…\")`", word.text));
        } else {
            good.push(figures);
        }
    }
    good
}
