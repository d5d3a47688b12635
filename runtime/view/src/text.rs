//! Escaping of names with arbitrary characters for HTML and JSON.

use std::fmt::Write;

/// Escapes text for an HTML element or attribute value.
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

/// Converts prose to HTML blocks: paragraphs and lists separated by blank lines. List items begin with `- `,
/// headings with `#`; code is in backticks, and emphasised text is between asterisks.
pub fn blocks(text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let blocks = lines.split(|line| line.is_empty()).filter(|block| !block.is_empty());
    blocks.map(paragraph_and_list_html).collect()
}

fn paragraph_and_list_html(lines: &[&str]) -> String {
    let first = lines.iter().position(|line| line.starts_with("- ")).unwrap_or(lines.len());
    let (before, list) = lines.split_at(first);
    let mut items: Vec<String> = Vec::new();
    for line in list {
        match (line.strip_prefix("- "), items.last_mut()) {
            (None, Some(item)) => {
                let _ = write!(item, " {line}");
            }
            (item, _) => items.push(item.unwrap_or(line).to_string()),
        }
    }
    let before = before.join(" ");
    let heading = before.trim_start_matches('#');
    let mut out = match before.as_str() {
        "" => String::new(),
        text if text == heading => format!("<p>{}</p>", inline_html(text)),
        _ => format!("<p><b>{}</b></p>", inline_html(heading.trim())),
    };
    if !items.is_empty() {
        let items: String = items.iter().map(|item| format!("<li>{}</li>", inline_html(item))).collect();
        let _ = write!(out, "<ul>{items}</ul>");
    }
    out
}

/// Converts the marks of code and emphasis in a text to HTML. Unpaired backticks and asterisks are printed
/// literally.
fn inline_html(text: &str) -> String {
    let text = html(text);
    let parts: Vec<&str> = text.split('`').collect();
    let mut out = String::new();
    for (k, part) in parts.iter().enumerate() {
        if k % 2 == 0 {
            out.push_str(&emphasised_html(part));
        } else if k + 1 < parts.len() {
            let _ = write!(out, "<code>{part}</code>");
        } else {
            let _ = write!(out, "`{}", emphasised_html(part));
        }
    }
    out
}

/// Converts text between asterisks to HTML emphasis. Asterisks of products are printed literally.
fn emphasised_html(text: &str) -> String {
    let parts: Vec<&str> = text.split('*').collect();
    let mut out = String::new();
    let mut is_open = false;
    for (k, part) in parts.iter().enumerate() {
        let before = k.checked_sub(1).map_or("", |k| parts[k]);
        if is_open {
            out.push_str("</em>");
            is_open = false;
        } else if k > 0 {
            let begins = !before.ends_with(char::is_alphanumeric) && part.trim() == *part && !part.is_empty();
            is_open = begins && k + 1 < parts.len();
            out.push_str(if is_open { "<em>" } else { "*" });
        }
        out.push_str(part);
    }
    out
}

/// Returns a JSON string that is safe in a script of an HTML page: it contains no characters of markup.
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

/// Formats a JSON array of elements that are already JSON texts.
pub fn list(items: impl IntoIterator<Item = String>) -> String {
    let items: Vec<String> = items.into_iter().collect();
    format!("[{}]", items.join(","))
}

/// Formats a number with seven significant digits in the shortest notation; zero if it is not finite.
pub fn number(x: f64) -> String {
    if !x.is_finite() {
        return "0".to_string();
    }
    let rounded: f64 = format!("{x:.6e}").parse().unwrap_or(x);
    // Removes the sign of zero.
    format!("{}", rounded + 0.0)
}

/// Formats numbers as a JSON array.
pub fn numbers(list: &[f64]) -> String {
    self::list(list.iter().map(|x| number(*x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escaped_text_ends_no_script_or_attribute() {
        let hostile = "</script><img src=x onerror='alert(\"1\")'>&\u{2028}\0";
        let (text, data) = (html(hostile), json(hostile));
        assert!(!text.contains(['<', '>', '"', '\'']));
        assert!(!data.contains(['<', '>', '&', '\u{2028}', '\0']));
        assert_eq!(serde_json::from_str::<String>(&data).ok().as_deref(), Some(hostile));
    }

    #[test]
    fn prose_is_converted_to_html_blocks() {
        let text = "The *simple* pendulum: `m l² * θ''`, 2 * 3 * 4, a*b*c.\nOne line more.\n\n# Source\n\n\
                    Coordinates:\n- `pin`, rad,\n  counted up\n- <b>, `open and *so";
        assert_eq!(
            blocks(text),
            [
                "<p>The <em>simple</em> pendulum: <code>m l² * θ&#39;&#39;</code>, 2 * 3 * 4, a*b*c. One \
                 line more.</p>",
                "<p><b>Source</b></p>",
                "<p>Coordinates:</p><ul><li><code>pin</code>, rad, counted up</li>\
                 <li>&lt;b&gt;, `open and *so</li></ul>",
            ]
        );
        assert!(blocks(" \n\n").is_empty());
    }

    #[test]
    fn numbers_are_short_and_finite() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(-1_234.567_89), "-1234.568");
        assert_eq!(number(f64::NAN), "0");
        assert_eq!(numbers(&[1e-9, 0.0]), "[0.000000001,0]");
    }
}
