//! Scalar type of the code. All code is written for `double` and converted to `float` on request, token by
//! token.

/// Functions of `math.h` that generated code calls.
pub const FUNCTIONS: &[&str] = &[
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
    "fabs", "copysign", "pow", "fmin", "fmax", "fma",
];

/// Tokens other than function names that differ between `double` and `float`.
const WORDS: &[(&str, &str)] = &[
    ("double", "float"),
    ("FP_FAST_FMA", "FP_FAST_FMAF"),
    ("DBL_EPSILON", "FLT_EPSILON"),
    ("HUGE_VAL", "HUGE_VALF"),
];

/// Returns the C literal of a number.
pub fn c_numeric_literal(c: f64) -> String {
    format!("{c:?}")
}

/// Converts C code with `double` to C code with `float`.
pub fn in_single_precision(code: &str) -> String {
    replace_numbers_and_words(code, &single_precision_literal, &single_precision_c_word)
}

/// Replaces the numbers of code, and its words, which are given together with the code after them. Comments
/// do not change.
pub fn replace_numbers_and_words(
    code: &str,
    number: &dyn Fn(&str) -> String,
    replaced_word: &dyn Fn(&str, &str) -> String,
) -> String {
    let mut out = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let length = match first {
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
            '"' => rest.get(1..).and_then(|r| r.find('"')).map_or(rest.len(), |end| end + 2),
            c if c.is_ascii_digit() => leading_number_length(rest),
            c if c.is_ascii_alphabetic() || c == '_' => {
                rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len())
            }
            c => c.len_utf8(),
        };
        let (word, after) = rest.split_at(length);
        match first {
            c if c.is_ascii_digit() => out.push_str(&number(word)),
            _ => out.push_str(&replaced_word(word, after)),
        }
        rest = after;
    }
    out
}

fn single_precision_c_word(word: &str, after: &str) -> String {
    if let Some((_, single)) = WORDS.iter().find(|(double, _)| *double == word) {
        return (*single).to_string();
    }
    let is_call = after.starts_with('(') && FUNCTIONS.contains(&word);
    if is_call { format!("{word}f") } else { word.to_string() }
}

/// Returns true if a text contains a word as a whole, and not as a member of a struct.
pub fn contains_word(text: &str, word: &str) -> bool {
    let is_word_character = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices(word).any(|(at, _)| {
        let before = text.get(..at).and_then(|t| t.chars().next_back());
        let after = text.get(at + word.len()..).and_then(|t| t.chars().next());
        let is_member = text.get(..at).is_some_and(|before| before.ends_with("->"));
        !is_member && !before.is_some_and(is_word_character) && !after.is_some_and(is_word_character)
    })
}

/// Returns the length of the number that a text begins with.
pub fn leading_number_length(text: &str) -> usize {
    let mut exponent = false;
    text.find(|c: char| {
        let goes_on = c.is_ascii_alphanumeric() || c == '.' || (exponent && matches!(c, '+' | '-'));
        exponent = matches!(c, 'e' | 'E');
        !goes_on
    })
    .unwrap_or(text.len())
}

/// Converts a numeric literal to single precision; integers do not change.
fn single_precision_literal(text: &str) -> String {
    let is_whole = !text.contains(['.', 'e', 'E']) || text.starts_with("0x");
    match text.parse::<f64>() {
        Ok(x) if !is_whole && (x as f32).is_finite() => format!("{:?}f", x as f32),
        Ok(_) if !is_whole => "HUGE_VALF".to_string(),
        _ => text.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::in_single_precision;

    #[test]
    fn c_types_and_literals_become_single_precision() {
        let code = "/* 1.5 double */ double x[3] = {1.5, -2e-7, 1e300}; y = sqrt(x[0]) + my_sin(x) + \
                    self->sin + 0.1;";
        assert_eq!(
            in_single_precision(code),
            "/* 1.5 double */ float x[3] = {1.5f, -2e-7f, HUGE_VALF}; y = sqrtf(x[0]) + my_sin(x) + \
             self->sin + 0.1f;"
        );
    }
}
