//! Diagnostics: every stage adds to one list, and the pipeline stops between stages when the list is
//! not empty. Knows no stage.

use proc_macro2::{Delimiter, Group, Literal, Span, TokenStream, TokenTree};
use std::rc::Rc;

/// Where something was said: a token of the user's source and, for an imported file, the line and column
/// there.
#[derive(Clone, Debug)]
pub struct Place {
    /// The first token that an error is shown at; for an imported file, the token of its path.
    pub span: Span,
    /// The last one.
    pub end: Span,
    /// The position in the imported file, if the thing comes from one.
    pub file: Option<FilePosition>,
}

impl Place {
    /// From the beginning of one place to the end of another.
    pub fn to(&self, end: &Place) -> Place {
        Place { end: end.end, ..self.clone() }
    }
}

/// A position in an imported file, counted from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilePosition {
    /// The file's path as the user wrote it.
    pub file: Rc<str>,
    /// Line, from one.
    pub line: u32,
    /// Column, from one.
    pub column: u32,
}

impl From<Span> for Place {
    fn from(span: Span) -> Place {
        Place { span, end: span, file: None }
    }
}

/// One mistake: what is wrong, where, and what to do about it.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    place: Place,
    message: String,
    notes: Vec<String>,
    help: Vec<String>,
}

impl Diagnostic {
    /// A mistake without notes and help.
    pub fn new(place: impl Into<Place>, message: impl Into<String>) -> Diagnostic {
        Diagnostic { place: place.into(), message: message.into(), notes: Vec::new(), help: Vec::new() }
    }

    /// Adds a line that says what else the mistake has to do with.
    pub fn note(&mut self, text: impl Into<String>) -> &mut Diagnostic {
        self.notes.push(text.into());
        self
    }

    /// True if nothing says how to mend it.
    pub fn is_bare(&self) -> bool {
        self.help.is_empty()
    }

    /// Adds a line that says how to mend it.
    pub fn help(&mut self, text: impl Into<String>) -> &mut Diagnostic {
        self.help.push(text.into());
        self
    }

    /// Adds "did you mean" for the candidate nearest to `name`, or else lists the candidates if they are few.
    pub fn suggest<'a>(
        &mut self,
        name: &str,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> &mut Diagnostic {
        let candidates: Vec<&str> = candidates.into_iter().collect();
        if let Some(best) = nearest(name, &candidates) {
            return self.help(format!("did you mean `{best}`?"));
        }
        if !candidates.is_empty() && candidates.len() <= 8 {
            let list: Vec<String> = candidates.iter().map(|c| format!("`{c}`")).collect();
            return self.help(format!("expected {}", one_of(&list)));
        }
        self
    }

    /// Where it is.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// What is wrong.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// What else it has to do with, a line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// How to mend it, a line each.
    pub fn helps(&self) -> &[String] {
        &self.help
    }

    /// One `compile_error!` at its token.
    pub fn tokens(&self) -> TokenStream {
        compile_error(&self.place, &self.text())
    }

    /// The message with the position in the imported file and all help lines, as the user reads it.
    pub fn text(&self) -> String {
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

/// What stands between the message and the help of an error that passes through syn.
const HELP: &str = "\n\n= help: ";

/// An error with a help line for those places where syn hands errors on.
pub fn syn_error(span: Span, message: &str, help: &str) -> syn::Error {
    syn::Error::new(span, format!("{message}{HELP}{help}"))
}

/// The mistakes found so far.
#[derive(Default, Debug)]
pub struct Diagnostics {
    errors: Vec<Diagnostic>,
    unread: bool,
    lists: Vec<String>,
}

impl Diagnostics {
    /// An empty list.
    pub fn new() -> Diagnostics {
        Diagnostics::default()
    }

    /// A list that nobody reads: it asks whether something is a mistake.
    pub fn unread() -> Diagnostics {
        Diagnostics { unread: true, ..Diagnostics::default() }
    }

    /// True if the user will read the list.
    pub fn is_read(&self) -> bool {
        !self.unread
    }

    /// How many mistakes there are.
    pub fn len(&self) -> usize {
        self.errors.len()
    }

    /// Reports a mistake. The message is lower case without a full stop, the user's words in backticks.
    pub fn error(&mut self, place: impl Into<Place>, message: impl Into<String>) -> &mut Diagnostic {
        self.add(Diagnostic::new(place, message));
        self.errors.last_mut().unwrap_or_else(|| unreachable!())
    }

    /// Reports a mistake that syn found.
    pub fn syn(&mut self, error: syn::Error) {
        for one in error {
            let text = one.to_string();
            let (message, help) = text.split_once(HELP).unwrap_or((&text, ""));
            let diagnostic = self.error(one.span(), message);
            if !help.is_empty() {
                diagnostic.help(help);
            }
        }
    }

    /// Adds a mistake.
    pub fn add(&mut self, one: Diagnostic) {
        self.errors.push(one);
    }

    /// Adds what another list holds.
    pub fn append(&mut self, mut other: Diagnostics) {
        self.errors.append(&mut other.errors);
    }

    /// True if nothing was reported.
    pub fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// Names with a number behind them, `leg_0` and `leg_1` of the list `leg`, stand for one thing in the
    /// source: what is said of several of them alike is said once.
    pub fn count_alike(&mut self, lists: Vec<String>) {
        self.lists = lists;
    }

    /// The mistakes in order, those of elements of one list that are alike once.
    pub fn distinct(&self) -> impl Iterator<Item = &Diagnostic> {
        let mut said = std::collections::BTreeSet::new();
        self.errors
            .iter()
            .filter(move |one| self.lists.is_empty() || said.insert(self.without_numbers(&one.message)))
    }

    /// A message without the numbers of elements of lists.
    fn without_numbers(&self, message: &str) -> String {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let words = message.split_inclusive(|c| !is_word(c)).map(|word| {
            let name = word.trim_end_matches(|c| !is_word(c));
            let list = name.trim_end_matches(|c: char| c.is_ascii_digit()).strip_suffix('_');
            match list.filter(|list| self.lists.iter().any(|known| known == list)) {
                Some(list) => format!("{list}[]{}", &word[name.len()..]),
                None => word.to_string(),
            }
        });
        words.collect()
    }

    /// The messages in order, as the user reads them.
    pub fn messages(&self) -> Vec<String> {
        self.distinct().map(Diagnostic::text).collect()
    }

    /// One `compile_error!` for each mistake, at its token.
    pub fn into_tokens(self) -> TokenStream {
        self.distinct().flat_map(Diagnostic::tokens).collect()
    }
}

/// `::core::compile_error! { "message" }`, shown from the first to the last token of the place.
fn compile_error(place: &Place, message: &str) -> TokenStream {
    let at = |mut token: TokenTree, span: Span| {
        token.set_span(span);
        token
    };
    let path = "::core::compile_error!".parse::<TokenStream>().unwrap_or_default();
    let message = at(Literal::string(message).into(), place.end);
    let braces = at(Group::new(Delimiter::Brace, message.into()).into(), place.end);
    path.into_iter().map(|token| at(token, place.span)).chain([braces]).collect()
}

/// `a`, `a or b`, `a, b or c`.
pub fn one_of(list: &[String]) -> String {
    joined(list, "or")
}

/// `a`, `a and b`, `a, b and c`.
pub fn all_of(list: &[String]) -> String {
    joined(list, "and")
}

fn joined(list: &[String], word: &str) -> String {
    match list {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} {word} {last}", first.join(", ")),
    }
}

/// The candidate with the smallest edit distance to `name`, if it is near enough to be a slip of the hand. A
/// letter in the other case is the smallest of slips; something of the name must remain. Else the only
/// candidate of whose words `name` is one: `elbow_joint` for `elbow`.
pub fn nearest<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
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

/// Edit distance with transpositions of neighbours counted as one edit (optimal string alignment).
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
    fn a_slip_finds_its_name_and_a_stranger_does_not() {
        assert_eq!(nearest("Sleve", &["Pin", "Sleeve", "Slot"]), Some("Sleeve"));
        assert_eq!(nearest("cart_mas", &["cart_mass", "pole_mass"]), Some("cart_mass"));
        assert_eq!(nearest("abuot", &["about", "along"]), Some("about"));
        assert_eq!(nearest("pin", &["Pin", "Sleeve"]), Some("Pin"));
        assert_eq!(nearest("spaceship", &["Pin", "Sleeve"]), None);
        assert_eq!(nearest("m1", &["m2", "M1"]), Some("M1"));
        assert_eq!(nearest("Z", &["x", "y", "z"]), Some("z"));
        assert_eq!(nearest("w", &["x", "y", "z"]), None);
        assert_eq!(nearest("j", &["j1", "j2"]), Some("j1"));
        assert_eq!(nearest("elbow", &["shoulder_joint", "elbow_joint"]), Some("elbow_joint"));
        assert_eq!(nearest("joint", &["shoulder_joint", "elbow_joint"]), None);
    }
}
