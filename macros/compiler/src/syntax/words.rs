//! Words of other tools and of textbooks, with their meaning in this language. These tables serve only the
//! help of messages.

use super::{BinaryOp, Expr, ExprKind};
use crate::diag::{Diagnostic, nearest_candidate};
use crate::language::{Callable, ElementKind, FunctionId, Rotation, Solid, WordsWithMeanings};

mod tables;

pub use tables::*;

/// Returns the synonyms of an element's arguments with their meanings; `kind` is the type name of the
/// element.
fn argument_synonyms(kind: &str) -> WordsWithMeanings {
    match ElementKind::find_by_name(kind) {
        Some(element) => element.argument_synonyms(),
        None if kind == ATTRIBUTE => OPTIONS,
        None => &[],
    }
}

/// Phrase for messages about arguments of the attribute `#[mechanism]` itself.
const ATTRIBUTE: &str = "`#[mechanism]`";

/// Returns the last word of a phrase that names an element, such as `Pin` of `a Pin`.
fn kind_in_phrase(whose: &str) -> &str {
    whose.strip_suffix(" constraint").unwrap_or(whose).rsplit(' ').next().unwrap_or(whose)
}

/// Returns an example of an element's declaration; `whose` is its type, with or without an article.
pub fn example_declaration(whose: &str) -> &'static str {
    ElementKind::find_by_name(kind_in_phrase(whose))
        .map_or("#[mechanism(gravity = -9.81 * y)]", ElementKind::declaration_example)
}

/// List of words that users may write by mistake, with their meanings in the language.
type MistakenWords<'a> = &'a [(&'static str, &'static str)];

/// Returns the names that other tools use for functions, with their meanings in the language.
pub fn function_synonyms() -> Vec<(&'static str, &'static str)> {
    FunctionId::synonyms().chain(FUNCTIONS.iter().copied()).collect()
}

/// Returns the names that other tools use for solids, with their meanings in the language.
pub fn solid_synonyms() -> Vec<(&'static str, &'static str)> {
    Solid::synonyms().chain(SOLIDS.iter().copied()).collect()
}

/// Returns the names that other tools use for rotations, with their meanings in the language.
pub fn rotation_synonyms() -> Vec<(&'static str, &'static str)> {
    Rotation::synonyms().chain(ROTATIONS.iter().copied()).collect()
}

/// Normalises a word for the lookup of its meaning: in lower case and without underscores.
fn normalise_word(word: &str) -> String {
    word.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect()
}

/// Returns the meaning of a word. A single-word meaning must be among the `known` words, unless these are
/// empty.
pub fn meaning_of_word(words: MistakenWords<'_>, word: &str, known: &[&str]) -> Option<&'static str> {
    let key = normalise_word(word);
    let is_applicable_meaning =
        |meaning: &str| meaning.contains(' ') || known.is_empty() || known.contains(&meaning);
    let has_word_among_synonyms = |(synonyms, meaning): &&(&str, &str)| {
        is_applicable_meaning(meaning) && synonyms.split(' ').any(|one| one == key)
    };
    words.iter().find(has_word_among_synonyms).map(|(_, meaning)| *meaning)
}

/// Whether a word is an option of `#[mechanism]` without a value.
pub fn is_valueless_option(word: &str) -> bool {
    super::request::REQUESTS.contains(&word)
}

/// Adds the meaning of an unknown word as help to an error message. Returns whether the meaning was found.
pub fn add_word_meaning_as_help(
    diagnostic: &mut Diagnostic,
    words: MistakenWords<'_>,
    word: &str,
    known: &[&str],
) -> bool {
    match meaning_of_word(words, word, known) {
        Some(meaning) if meaning.contains(' ') => diagnostic.add_help(meaning),
        Some(meaning) => diagnostic.add_help(format!("did you mean `{meaning}`?")),
        None => return false,
    };
    true
}

/// Adds the meaning of a word to a message, or the nearest known word, or the list of known words.
pub fn suggest_meaning_or_known_word(
    diagnostic: &mut Diagnostic,
    words: MistakenWords<'_>,
    word: &str,
    known: &[&str],
) {
    if !add_word_meaning_as_help(diagnostic, words, word, known) {
        diagnostic.suggest_name(word, known.iter().copied());
    }
}

/// Adds the element meant by an unknown field type, one of the `known` types, as help to a message. Returns
/// false if none is found.
pub fn suggest_meant_element(diagnostic: &mut Diagnostic, word: &str, known: &[&str]) -> bool {
    let key = normalise_word(word);
    let bare = key.strip_suffix("joint").or(key.strip_suffix("element")).unwrap_or(&key);
    if let Some(same) = known.iter().find(|name| name.eq_ignore_ascii_case(bare)) {
        diagnostic.add_help(format!("did you mean `{same}`?"));
        return true;
    }
    let words: Vec<_> = ElementKind::element_synonyms().chain(ELEMENTS.iter().copied()).collect();
    add_word_meaning_as_help(diagnostic, &words, if bare.is_empty() { "joint" } else { bare }, &[])
}

/// Returns the help for an argument that an element does not have; `whose` names the element with its
/// article, such as `a Pin`.
pub fn help_for_unknown_argument(whose: &str, owner: &str, word: &str, known: &[&str]) -> Option<String> {
    let meaning = meaning_of_word(argument_synonyms(kind_in_phrase(whose)), word, known)?;
    Some(match meaning.contains(' ') {
        true => meaning.replace("NAME", owner),
        false => format!("did you mean `{meaning}`?"),
    })
}

/// Returns the known name that equals a word up to Greek letters and case.
pub fn known_name_ignoring_case<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let mut letters = word.to_string();
    for (letter, name) in GREEK {
        letters = letters.replace(letter, name);
    }
    let has_same_normalised_spelling = |a: &str, b: &str| normalise_word(a) == normalise_word(b);
    known.iter().find(|name| has_same_normalised_spelling(&letters, name)).copied()
}

/// Returns the coordinate of a name that looks like its rate: `hinge_dot`, `hinged`, `dhinge`.
pub fn coordinate_of_rate_name<'a>(word: &str, coordinates: &[&'a str]) -> Option<&'a str> {
    let ends = ["dot", "dt", "d", "rate", "vel", "velocity", "speed", "p"];
    let ends_with_rate_suffix = |stem: &str| {
        ends.iter().any(|end| word.strip_prefix(stem).map(normalise_word).as_deref() == Some(end))
    };
    let begins_with_rate_prefix = |stem: &str| {
        word.strip_suffix(stem).is_some_and(|before| matches!(before, "d" | "d_" | "dot_" | "v_" | "rate_"))
    };
    coordinates
        .iter()
        .filter(|name| ends_with_rate_suffix(name) || begins_with_rate_prefix(name))
        .max_by_key(|name| name.len())
        .copied()
}

/// Returns the coordinate of a name that looks like its acceleration: `hinge_ddot`, `ddhinge`.
pub fn coordinate_of_acceleration_name<'a>(word: &str, coordinates: &[&'a str]) -> Option<&'a str> {
    let ends = ["ddot", "dotdot", "dd", "acc", "accel", "acceleration", "pp"];
    let ends_with_acceleration_suffix = |stem: &str| {
        ends.iter().any(|end| word.strip_prefix(stem).map(normalise_word).as_deref() == Some(end))
    };
    let begins_with_acceleration_prefix = |stem: &str| {
        word.strip_suffix(stem).is_some_and(|before| matches!(before, "dd" | "dd_" | "ddot_" | "a_" | "acc_"))
    };
    coordinates
        .iter()
        .filter(|name| ends_with_acceleration_suffix(name) || begins_with_acceleration_prefix(name))
        .max_by_key(|name| name.len())
        .copied()
}

/// Whether a word looks like a Rust constant. Values of constants are unknown when a macro runs.
pub fn looks_like_rust_constant(word: &str) -> bool {
    word.chars().any(|c| c.is_ascii_uppercase()) && !word.chars().any(|c| c.is_ascii_lowercase())
}

/// Adds the likely meaning of an unknown name as help to an error message, such as the most similar of the
/// `known` names.
pub fn suggest_name(diagnostic: &mut Diagnostic, name: &str, known: &[&str], coordinates: &[&str]) {
    if let Some(coordinate) = coordinate_of_rate_name(name, coordinates) {
        diagnostic.add_help(format!("write `rate({coordinate})` for its rate"));
    } else if let Some(coordinate) = coordinate_of_acceleration_name(name, coordinates) {
        diagnostic.add_help(format!("write `rate(rate({coordinate}))` for its acceleration"));
    } else if let Some(same) = known_name_ignoring_case(name, known) {
        diagnostic.add_help(format!("did you mean `{same}`?"));
    } else if add_word_meaning_as_help(diagnostic, NAMES, name, &[]) {
    } else if nearest_candidate(name, known).is_some() {
        diagnostic.suggest_name(name, known.iter().copied());
    } else if looks_like_rust_constant(name) {
        let parameter = name.to_lowercase();
        diagnostic.add_help(format!(
            "the macro cannot see the value of a constant: declare a parameter, `{parameter}: f64`, or write \
             the number"
        ));
    } else {
        diagnostic.suggest_name(name, known.iter().copied());
        let or = if diagnostic.has_no_help() { "" } else { "or " };
        diagnostic.add_help(format!(
            "{or}declare it: `{name}: f64` is a parameter, `{name}: Coordinate` a coordinate"
        ));
    }
}

impl Expr {
    /// Returns the expression as the user would write it, or `…` if it is long.
    pub fn short_source_text(&self) -> String {
        let text = expression_text(self);
        if text.chars().count() > 60 { "…".to_string() } else { text }
    }

    /// Returns the expression as the user would write it.
    pub fn source_text(&self) -> String {
        expression_text(self)
    }

    /// Returns whether another expression would be written with the same text.
    pub fn has_same_text(&self, other: &Expr) -> bool {
        expression_text(self) == expression_text(other)
    }
}

fn expression_text(e: &Expr) -> String {
    let comma_separated_expressions =
        |items: &[Expr]| items.iter().map(expression_text).collect::<Vec<_>>().join(", ");
    match &e.kind {
        ExprKind::Number(n) => n.to_string(),
        ExprKind::Name(name) => name.clone(),
        ExprKind::Field(base, member) => format!("{}.{}", expression_text(base), member.text),
        ExprKind::Method(base, method, items) => {
            format!("{}.{}({})", expression_text(base), method.text, comma_separated_expressions(items))
        }
        ExprKind::Call(function, items) if function.id == Some(Callable::If) => match items.as_slice() {
            [a, b, below, above] => {
                format!(
                    "if {} < {} {{ {} }} else {{ {} }}",
                    expression_text(a),
                    expression_text(b),
                    expression_text(below),
                    expression_text(above)
                )
            }
            _ => function.text.clone(),
        },
        ExprKind::Call(function, items) => {
            format!("{}({})", function.text, comma_separated_expressions(items))
        }
        ExprKind::Neg(inner) => format!("-{}", expression_text(inner)),
        ExprKind::Binary(op, left, right, _) => {
            let is_sum_expression =
                |e: &Expr| matches!(e.kind, ExprKind::Binary(BinaryOp::Add | BinaryOp::Sub, ..));
            let product = matches!(op, BinaryOp::Mul | BinaryOp::Div);
            let parenthesised_operand_text = |e: &Expr, together: bool| match &e.kind {
                ExprKind::Binary(..) if together || (product && is_sum_expression(e)) => {
                    format!("({})", expression_text(e))
                }
                _ => expression_text(e),
            };
            let sign = match op {
                BinaryOp::Add => "+",
                BinaryOp::Sub => "-",
                BinaryOp::Mul => "*",
                BinaryOp::Div => "/",
            };
            let together = matches!(op, BinaryOp::Sub | BinaryOp::Div);
            format!(
                "{} {sign} {}",
                parenthesised_operand_text(left, false),
                parenthesised_operand_text(right, together)
            )
        }
        ExprKind::Tuple(items) => format!("({})", comma_separated_expressions(items)),
        ExprKind::Array(items) => format!("[{}]", comma_separated_expressions(items)),
        ExprKind::Text(text) => format!("{text:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn word_tables_are_sorted_for_lookup() {
        let all = [
            ELEMENTS,
            OPTIONS,
            REQUESTS,
            FORMULATIONS,
            NAMES,
            METHODS,
            BODIES,
            MEMBERS,
            OWN,
            RATES,
            NUMBER_METHODS,
        ];
        let elements = ElementKind::element_names().filter_map(ElementKind::find_by_name);
        let of_arguments = elements.flat_map(|element| element.argument_synonyms().iter().copied());
        let rows = [function_synonyms(), solid_synonyms(), rotation_synonyms()].concat();
        for (said, meaning) in all
            .into_iter()
            .flatten()
            .copied()
            .chain(rows)
            .chain(of_arguments)
            .chain(ElementKind::element_synonyms())
        {
            assert!(said.split(' ').all(|word| !word.is_empty() && word == normalise_word(word)), "{said}");
            assert!(!meaning.is_empty() && (meaning.contains(' ') || !meaning.contains('`')), "{meaning}");
        }
    }

    #[test]
    fn velocity_names_are_found_by_coordinate() {
        assert_eq!(coordinate_of_rate_name("hinge_dot", &["hinge"]), Some("hinge"));
        assert_eq!(coordinate_of_rate_name("dhinge", &["hinge"]), Some("hinge"));
        assert_eq!(coordinate_of_rate_name("theta1dot", &["theta", "theta1"]), Some("theta1"));
        assert_eq!(coordinate_of_rate_name("hinge2", &["hinge"]), None);
        assert_eq!(coordinate_of_acceleration_name("hinge_ddot", &["hinge"]), Some("hinge"));
        assert_eq!(coordinate_of_acceleration_name("ddtheta1", &["theta", "theta1"]), Some("theta1"));
        assert_eq!(coordinate_of_acceleration_name("hinge_dot", &["hinge"]), None);
        assert_eq!(known_name_ignoring_case("θ1", &["theta_1"]), Some("theta_1"));
    }
}
