//! Diagnostics of the compiler. All stages append errors to one list, and the pipeline stops between two
//! stages if the list is not empty. This module depends on no stage.

use proc_macro2::{Delimiter, Group, Literal, Span, TokenStream, TokenTree};
use std::rc::Rc;

/// Source position of a diagnostic: a range of tokens of the user's source and, for an imported file, the
/// line and column in that file.
#[derive(Clone, Debug)]
pub struct Place {
    /// First token at which an error is shown; for an imported file, the token of its path.
    pub span: Span,
    /// Last token of the range at which an error is shown.
    pub end: Span,
    /// Position of the error in the imported file, if it concerns one.
    pub file: Option<FilePosition>,
}

impl Place {
    /// Returns the range from the start of `self` to the end of `end`.
    pub fn extend_to_end_of(&self, end: &Place) -> Place {
        Place { end: end.end, ..self.clone() }
    }
}

/// Position in an imported file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilePosition {
    /// Path of the file as the user wrote it.
    pub file: Rc<str>,
    /// Line, counted from one.
    pub line: u32,
    /// Column, counted from one.
    pub column: u32,
}

impl From<Span> for Place {
    fn from(span: Span) -> Place {
        Place { span, end: span, file: None }
    }
}

/// Compiler error: its message, its position, and notes and help for the user.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    place: Place,
    message: String,
    notes: Vec<String>,
    help: Vec<String>,
}

impl Diagnostic {
    /// Creates an error without notes and help lines.
    pub fn new(place: impl Into<Place>, message: impl Into<String>) -> Diagnostic {
        Diagnostic { place: place.into(), message: message.into(), notes: Vec::new(), help: Vec::new() }
    }

    /// Adds a note: related information on the error.
    pub fn add_note(&mut self, text: impl Into<String>) -> &mut Diagnostic {
        self.notes.push(text.into());
        self
    }

    /// Returns true if the error has no help line.
    pub fn has_no_help(&self) -> bool {
        self.help.is_empty()
    }

    /// Adds a help line, which says how to correct the error.
    pub fn add_help(&mut self, text: impl Into<String>) -> &mut Diagnostic {
        self.help.push(text.into());
        self
    }

    /// Adds "did you mean" for the candidate nearest to `name`. Without a near candidate, adds the list of
    /// candidates if there are at most eight.
    pub fn suggest_name<'a>(
        &mut self,
        name: &str,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> &mut Diagnostic {
        let candidates: Vec<&str> = candidates.into_iter().collect();
        if let Some(best) = nearest_candidate(name, &candidates) {
            return self.add_help(format!("did you mean `{best}`?"));
        }
        if !candidates.is_empty() && candidates.len() <= 8 {
            let list: Vec<String> = candidates.iter().map(|c| format!("`{c}`")).collect();
            return self.add_help(format!("expected {}", join_with_or(&list)));
        }
        self
    }

    /// Returns the source position of the error.
    pub fn source_position(&self) -> &Place {
        &self.place
    }

    /// Returns the message without position, notes and help.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Returns the notes, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the help lines.
    pub fn help_lines(&self) -> &[String] {
        &self.help
    }

    /// Returns a `compile_error!` at the tokens of the error.
    pub fn compile_error_tokens(&self) -> TokenStream {
        compile_error(&self.place, &self.full_message_text())
    }

    /// Returns the complete text for the user: position in the imported file, message, notes and help.
    pub fn full_message_text(&self) -> String {
        let mut text = match &self.place.file {
            Some(at) => format!("{}:{}:{}: {}", at.file, at.line, at.column, self.message),
            None => self.message.clone(),
        };
        let notes = self.notes.iter().map(|line| ("note", line));
        for (k, (word, line)) in notes.chain(self.help.iter().map(|line| ("help", line))).enumerate() {
            let gap = if k == 0 { "\n\n" } else { "\n" };
            text.push_str(&format!("{gap}= {word}: {line}"));
        }
        text
    }
}

/// Separator between message and help in the text of a [`syn::Error`].
const HELP: &str = "\n\n= help: ";

/// Creates a [`syn::Error`] with a help line, for parsers that return errors of `syn`.
pub fn syn_error_with_help(span: Span, message: &str, help: &str) -> syn::Error {
    syn::Error::new(span, format!("{message}{HELP}{help}"))
}

/// List of the errors that the compiler has found so far.
#[derive(Default, Debug)]
pub struct Diagnostics {
    errors: Vec<Diagnostic>,
    unread: bool,
    lists: Vec<String>,
}

impl Diagnostics {
    /// Creates an empty list of errors.
    pub fn new() -> Diagnostics {
        Diagnostics::default()
    }

    /// Creates a list that is never printed. Callers use it to test whether something is an error.
    pub fn silent_diagnostics() -> Diagnostics {
        Diagnostics { unread: true, ..Diagnostics::default() }
    }

    /// Returns true if the errors of this list will be printed.
    pub fn will_print_errors(&self) -> bool {
        !self.unread
    }

    /// Returns the number of reported errors.
    pub fn len(&self) -> usize {
        self.errors.len()
    }

    /// Reports an error and returns it for notes and help. The message is in lower case without a full stop,
    /// with the user's identifiers in backticks.
    pub fn report_error(&mut self, place: impl Into<Place>, message: impl Into<String>) -> &mut Diagnostic {
        self.add_diagnostic(Diagnostic::new(place, message));
        self.errors.last_mut().unwrap_or_else(|| unreachable!())
    }

    /// Reports the errors of a [`syn::Error`], with the help of [`syn_error_with_help`].
    pub fn report_syn_error(&mut self, error: syn::Error) {
        for one in error {
            let text = one.to_string();
            let (message, help) = text.split_once(HELP).unwrap_or((&text, ""));
            let diagnostic = self.report_error(one.span(), message);
            if !help.is_empty() {
                diagnostic.add_help(help);
            }
        }
    }

    /// Adds an error to the list.
    pub fn add_diagnostic(&mut self, one: Diagnostic) {
        self.errors.push(one);
    }

    /// Moves all errors of another list to the end of this list.
    pub fn append_errors(&mut self, mut other: Diagnostics) {
        self.errors.append(&mut other.errors);
    }

    /// Returns whether no error was reported.
    pub fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// Sets the names of lists of elements. Errors that differ only in the index of an element, for example
    /// `leg_0` and `leg_1` of the list `leg`, are then printed once, because both refer to the same source
    /// text.
    pub fn set_element_list_names(&mut self, lists: Vec<String>) {
        self.lists = lists;
    }

    /// Returns the errors in order. Of errors that differ only in the index of a list element, only the first
    /// is returned.
    pub fn distinct_errors(&self) -> impl Iterator<Item = &Diagnostic> {
        let mut said = std::collections::BTreeSet::new();
        self.errors
            .iter()
            .filter(move |one| self.lists.is_empty() || said.insert(self.remove_list_indices(&one.message)))
    }

    /// Replaces the index of each list element in a message by `[]`.
    fn remove_list_indices(&self, message: &str) -> String {
        let is_word_character = |c: char| c.is_alphanumeric() || c == '_';
        let words = message.split_inclusive(|c| !is_word_character(c)).map(|word| {
            let name = word.trim_end_matches(|c| !is_word_character(c));
            let list = name.trim_end_matches(|c: char| c.is_ascii_digit()).strip_suffix('_');
            match list.filter(|list| self.lists.iter().any(|known| known == list)) {
                Some(list) => format!("{list}[]{}", &word[name.len()..]),
                None => word.to_string(),
            }
        });
        words.collect()
    }

    /// Returns the complete texts of the errors in order.
    pub fn full_message_texts(&self) -> Vec<String> {
        self.distinct_errors().map(Diagnostic::full_message_text).collect()
    }

    /// Returns the `compile_error!` invocations of all errors, at their tokens.
    pub fn into_tokens(self) -> TokenStream {
        self.distinct_errors().flat_map(Diagnostic::compile_error_tokens).collect()
    }
}

/// Returns `::core::compile_error! { "message" }`, shown from the first to the last token of `place`.
fn compile_error(place: &Place, message: &str) -> TokenStream {
    let token_with_span = |mut token: TokenTree, span: Span| {
        token.set_span(span);
        token
    };
    let path = "::core::compile_error!".parse::<TokenStream>().unwrap_or_default();
    let message = token_with_span(Literal::string(message).into(), place.end);
    let braces = token_with_span(Group::new(Delimiter::Brace, message.into()).into(), place.end);
    path.into_iter().map(|token| token_with_span(token, place.span)).chain([braces]).collect()
}

/// Joins the items as `a`, `a or b`, `a, b or c`.
pub fn join_with_or(list: &[String]) -> String {
    join_with_word(list, "or")
}

/// Joins the items as `a`, `a and b`, `a, b and c`.
pub fn join_names_with_and(list: &[String]) -> String {
    join_with_word(list, "and")
}

fn join_with_word(list: &[String], word: &str) -> String {
    match list {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} {word} {last}", first.join(", ")),
    }
}

/// Returns the candidate with the smallest edit distance to `name`, if the distance is small enough for a
/// typing error. Names that differ only in case have distance zero, and at least one character must remain
/// unchanged. Without a near candidate, returns the only candidate that contains `name` as a word:
/// `elbow_joint` for `elbow`.
pub fn nearest_candidate<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let length = name.chars().count();
    let limit = (length / 3).clamp(1, 3);
    let mut longer =
        candidates.iter().filter(|c| length > 2 && c.split(['_', '.', '-']).any(|word| word == name));
    let longer = match (longer.next(), longer.next()) {
        (Some(only), None) => Some(*only),
        _ => None,
    };
    candidates
        .iter()
        .map(|c| (if c.eq_ignore_ascii_case(name) { 0 } else { edit_distance(name, c) }, *c))
        .filter(|(distance, c)| *distance <= limit && *distance < length.max(c.chars().count()))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
        .or(longer)
}

/// Returns the edit distance, with the transposition of two adjacent characters counted as one edit (optimal
/// string alignment). Only the first 64 characters are compared.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut before = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let substitution = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = substitution.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_names_get_suggestions_and_unrelated_names_none() {
        assert_eq!(nearest_candidate("Sleve", &["Pin", "Sleeve", "Slot"]), Some("Sleeve"));
        assert_eq!(nearest_candidate("cart_mas", &["cart_mass", "pole_mass"]), Some("cart_mass"));
        assert_eq!(nearest_candidate("abuot", &["about", "along"]), Some("about"));
        assert_eq!(nearest_candidate("pin", &["Pin", "Sleeve"]), Some("Pin"));
        assert_eq!(nearest_candidate("spaceship", &["Pin", "Sleeve"]), None);
        assert_eq!(nearest_candidate("m1", &["m2", "M1"]), Some("M1"));
        assert_eq!(nearest_candidate("Z", &["x", "y", "z"]), Some("z"));
        assert_eq!(nearest_candidate("w", &["x", "y", "z"]), None);
        assert_eq!(nearest_candidate("j", &["j1", "j2"]), Some("j1"));
        assert_eq!(nearest_candidate("elbow", &["shoulder_joint", "elbow_joint"]), Some("elbow_joint"));
        assert_eq!(nearest_candidate("joint", &["shoulder_joint", "elbow_joint"]), None);
    }
}
