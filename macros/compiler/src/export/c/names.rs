//! Names in C: what a user wrote, as far as C has it.

/// Words that are no names in C or C++, and macros of headers and compilers.
const RESERVED: &[&str] = &[
    "alignas",
    "alignof",
    "and",
    "and_eq",
    "asm",
    "auto",
    "bitand",
    "bitor",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "compl",
    "complex",
    "concept",
    "const",
    "consteval",
    "constexpr",
    "constinit",
    "const_cast",
    "continue",
    "co_await",
    "co_return",
    "co_yield",
    "decltype",
    "default",
    "delete",
    "do",
    "double",
    "dynamic_cast",
    "else",
    "enum",
    "errno",
    "explicit",
    "export",
    "extern",
    "false",
    "float",
    "for",
    "fortran",
    "friend",
    "goto",
    "i386",
    "if",
    "imaginary",
    "inline",
    "int",
    "linux",
    "long",
    "mutable",
    "namespace",
    "near",
    "far",
    "new",
    "noexcept",
    "not",
    "not_eq",
    "nullptr",
    "operator",
    "or",
    "or_eq",
    "private",
    "protected",
    "public",
    "register",
    "reinterpret_cast",
    "requires",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "static_assert",
    "static_cast",
    "struct",
    "switch",
    "template",
    "this",
    "thread_local",
    "throw",
    "true",
    "try",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "union",
    "unix",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "wchar_t",
    "while",
    "xor",
    "xor_eq",
    "math_errhandling",
];

/// Functions and constants that sources and the headers they include have.
const OF_SOURCES: &[&str] = &[
    "accelerations_under",
    "add_products",
    "atmosphere",
    "block",
    "bracket",
    "cbrt",
    "ceil",
    "complete",
    "cross_into",
    "dot_of",
    "erf",
    "even_slopes",
    "expm1",
    "floor",
    "fourth_bracket",
    "gamma",
    "hypot",
    "invert",
    "isa_pressure",
    "isa_temperature",
    "isa_lapse_rate",
    "jacobian_factors",
    "ldexp",
    "left_jacobian",
    "lgamma",
    "linear_motion",
    "log1p",
    "log10",
    "log2",
    "logb",
    "moved",
    "moved_block",
    "minus_products",
    "mul_add",
    "mul_sub",
    "multiply_turns",
    "neg_mul_add",
    "normalise",
    "own",
    "plus_into",
    "plus_part",
    "product",
    "put_columns",
    "rate_of",
    "remainder",
    "rint",
    "rotate",
    "round",
    "scalb",
    "second_bracket",
    "signgam",
    "signum",
    "sin_cos",
    "solve",
    "tabulated",
    "tgamma",
    "trunc",
    "weights_around",
    "y0",
    "y1",
    "j0",
    "j1",
    "yn",
    "jn",
    "index",
    "time",
    "clock",
    "div",
    "abs",
    "exp2",
];

/// What may stand behind other letters in a name: signs of ASCII become underscores, letters of other alphabets their numbers.
pub fn letters(name: &str) -> String {
    let mut text = String::new();
    for c in name.trim_start_matches("r#").chars() {
        match c {
            c if c.is_ascii_alphanumeric() => text.push(c),
            c if c.is_ascii() => text.push('_'),
            c => text.push_str(&format!("u{:04x}", u32::from(c))),
        }
    }
    text
}

/// A name as an identifier: words of the language and names in capitals (most macros are) get an underscore behind them, and what
/// begins with a digit or an underscore a letter before it.
pub fn identifier(name: &str) -> String {
    let mut text = letters(name);
    if text.starts_with(|c: char| !c.is_ascii_alphabetic()) {
        text.insert(0, 'x');
    }
    let shouts = text.len() > 2 && text.chars().all(|c| !c.is_ascii_lowercase());
    if shouts || RESERVED.contains(&text.as_str()) {
        text.push('_');
    }
    text
}

/// What every name begins with, which is the name of a type as well: none of the mathematical library, nor of functions that sources
/// have for themselves.
pub fn prefix_identifier(name: &str) -> String {
    let mut text = identifier(name);
    if OF_SOURCES.contains(&text.as_str()) || super::scalar::FUNCTIONS.contains(&text.trim_end_matches('f')) {
        text.push('_');
    }
    text
}

/// Identifiers for several names that share a scope, all different.
pub fn identifiers<S: AsRef<str>>(names: &[S]) -> Vec<String> {
    different(names.iter().map(|name| identifier(name.as_ref())))
}

/// Names of the preprocessor for several names that share a prefix, all different.
pub fn capitals<S: AsRef<str>>(names: &[S]) -> Vec<String> {
    different(names.iter().map(|name| letters(name.as_ref()).to_ascii_uppercase()))
}

fn different(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for name in all {
        let mut text = name.clone();
        let mut number = 2_usize;
        while found.contains(&text) {
            text = format!("{name}_{number}");
            number += 1;
        }
        found.push(text);
    }
    found
}

/// A type's name in small letters, with underscores between its words.
pub fn prefix(name: &str) -> String {
    let mut text = String::new();
    let mut before: Option<char> = None;
    let mut rest = name.trim_start_matches("r#").chars().peekable();
    while let Some(c) = rest.next() {
        let after_small = before.is_some_and(|b| b.is_lowercase() || b.is_ascii_digit());
        let begins_word =
            before.is_some_and(char::is_uppercase) && rest.peek().is_some_and(|n| n.is_lowercase());
        if c.is_uppercase() && (after_small || begins_word) {
            text.push('_');
        }
        text.extend(c.to_lowercase());
        before = Some(c);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_c_does_not_have_gets_other_names() {
        assert_eq!(
            ["mass", "r#type", "int", "class", "2nd", "_x", "µ", "NAN", "M_PI", "L", "left-arm"]
                .map(identifier),
            ["mass", "type", "int_", "class_", "x2nd", "x_x", "u00b5", "NAN_", "M_PI_", "L", "left_arm"]
        );
        assert_eq!(identifiers(&["a-b", "a_b", "a b"]), ["a_b", "a_b_2", "a_b_3"]);
        assert_eq!(capitals(&["tool", "r#in", "left-arm"]), ["TOOL", "IN", "LEFT_ARM"]);
        assert_eq!(
            ["CartPole", "UR5", "Solo12", "HTTPServer"].map(prefix),
            ["cart_pole", "ur5", "solo12", "http_server"]
        );
    }
}
