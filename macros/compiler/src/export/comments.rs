//! Documentation comments of exported code, in the form of C.

use crate::catalogue::Argument;
use crate::mechanism::SuppliedQuantity;

/// Maximum width of comment lines, in characters.
const WIDTH: usize = 100;

/// Returns a text that is valid inside a comment: without comment marks, trigraphs and control characters.
pub fn comment_safe_text(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    plain.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
}

/// Replaces rustdoc's links by their text. Brackets in code do not change.
pub fn without_doc_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['`', '[']) {
        let (before, found) = rest.split_at(at);
        out.push_str(before);
        let (words, after) = match found.strip_prefix('`') {
            Some(code) => found.split_at(code.find('`').map_or(found.len(), |end| end + 2)),
            None => split_leading_link(found).unwrap_or(found.split_at(1)),
        };
        out.push_str(words);
        rest = after;
    }
    out + rest
}

/// Returns the text of the link at the start of `text`, and the remainder after the link.
fn split_leading_link(text: &str) -> Option<(&str, &str)> {
    let is_code = text.starts_with("[`");
    let end = if is_code { text.find("`]")? + 1 } else { text.find(']')? };
    let (words, after) = (&text[1..end], &text[end + 1..]);
    match after.strip_prefix('(') {
        Some(target) => target.find(')').map(|end| (words, &target[end + 1..])),
        None => (is_code && words.len() > 2).then_some((words, after)),
    }
}

/// Wraps a paragraph to lines that begin with `first` and `others`.
pub fn wrap_paragraph(text: &str, first: &str, others: &str) -> String {
    let mut out = String::new();
    let mut line = first.to_string();
    let mut is_empty = true;
    for word in comment_safe_text(text).split_whitespace() {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            out.push_str(line.trim_end());
            out.push('\n');
            line = others.to_string();
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line.push_str(word);
        is_empty = false;
    }
    out.push_str(line.trim_end());
    out.push('\n');
    out
}

/// Returns the description of a function argument for the documentation.
pub fn argument_description(a: Argument) -> &'static str {
    match a {
        Argument::T => "time, s",
        Argument::Q => "configuration",
        Argument::V => "velocity",
        Argument::A => "acceleration",
        Argument::Tau => "generalized forces, N for translations, N m for rotations",
        Argument::U => "inputs",
        Argument::Standard(_) => "mass properties",
        Argument::Factors(_) => "factors",
        Argument::Momenta(_) => "generalized momenta, kg m/s for translations, kg m^2/s for rotations",
        Argument::Given(_, SuppliedQuantity::Multiplier, _) => "multipliers of the constraints",
        Argument::Given(..) | Argument::Into(..) | Argument::Called(_) => "numbers",
    }
}

/// Returns a count of numbers in words, such as `3 numbers`.
pub fn format_number_count(n: usize) -> String {
    if n == 1 { "1 number".to_string() } else { format!("{n} numbers") }
}

/// Returns the comment of a function: its documentation, then the names of its arrays with their meaning.
pub fn c_function_comment<'a>(docs: &[String], arrays: impl Iterator<Item = (&'a str, String)>) -> String {
    let mut text = String::new();
    for (k, paragraph) in docs.iter().enumerate() {
        text.push_str(&wrap_paragraph(paragraph, if k == 0 { "/* " } else { " * " }, " * "));
    }
    text.push_str(if docs.is_empty() { "/*\n" } else { " *\n" });
    for (name, about) in arrays {
        text.push_str(&wrap_paragraph(&about, &format!(" * {name:9} "), " *           "));
    }
    text + " */\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comment_terminators_are_escaped_in_c_comments() {
        assert_eq!(comment_safe_text("a */ b /* c ??/ d\n"), "a * / b / * c ? ?/ d ");
        assert_eq!(without_doc_links("of [`x`](Self::x) and [`y`](Self::y)."), "of `x` and `y`.");
        for (text, plain) in [
            ("[`a`](::linkwork::Error::A) where [this](crate) is", "`a` where this is"),
            ("See [`Mechanism`], `v[k]` and `[a, b](c)`.", "See `Mechanism`, `v[k]` and `[a, b](c)`."),
            ("[`v[k]`](Self::v), [1, 2], [x](y", "`v[k]`, [1, 2], [x](y"),
            ("[`", "[`"),
        ] {
            assert_eq!(without_doc_links(text), plain);
        }
    }
}
