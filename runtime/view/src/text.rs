//! Names in HTML and in the data of a page, whatever characters they have.

use std::fmt::Write;

/// Text of an HTML element or of an attribute's value.
pub fn html(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// A string of JSON that may stand in a script of an HTML page: no character begins or ends markup.
pub fn json(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            '<' | '>' | '&' | '\u{7f}' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c if u32::from(c) < 0x20 => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A list of JSON.
pub fn list(items: impl IntoIterator<Item = String>) -> String {
    let items: Vec<String> = items.into_iter().collect();
    format!("[{}]", items.join(","))
}

/// A number with seven digits, in the shortest spelling; zero if it is not finite.
pub fn number(x: f64) -> String {
    if !x.is_finite() {
        return "0".to_string();
    }
    let rounded: f64 = format!("{x:.6e}").parse().unwrap_or(x);
    // Of zero without its sign.
    format!("{}", rounded + 0.0)
}

/// Numbers of JSON.
pub fn numbers(list: &[f64]) -> String {
    self::list(list.iter().map(|x| number(*x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_ends_a_script_or_an_attribute() {
        let hostile = "</script><img src=x onerror='alert(\"1\")'>&\u{2028}\0";
        let (text, data) = (html(hostile), json(hostile));
        assert!(!text.contains(['<', '>', '"', '\'']));
        assert!(!data.contains(['<', '>', '&', '\u{2028}', '\0']));
        assert_eq!(serde_json::from_str::<String>(&data).ok().as_deref(), Some(hostile));
    }

    #[test]
    fn numbers_are_short_and_finite() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(-1_234.567_89), "-1234.568");
        assert_eq!(number(f64::NAN), "0");
        assert_eq!(numbers(&[1e-9, 0.0]), "[0.000000001,0]");
    }
}
