//! Line breaking of LaTeX: equations in lines that fit a page, broken before the signs of their outermost
//! sums.

use std::iter::Peekable;
use std::str::Chars;

/// Width of a line, in tenths of a character: about the width of a page.
const ROOM: usize = 1000;
/// Maximum width of an equation's side that shares a line with the other side.
const SHORT: usize = 240;
/// LaTeX text at the start of a continuation line.
const INDENT: &str = "\\quad {} ";
/// Width of [`INDENT`].
const INDENTED: usize = 30;

/// Formats equations as an `aligned` environment of `amsmath`, one or several lines each. The lines are
/// aligned at the left: with alignment at the equals signs, the long side of one equation would begin where
/// that of another ends.
pub fn format_aligned(lines: &[String]) -> String {
    // At the start of a column a minus sign would be typeset as a binary operator.
    let protect_leading_minus =
        |text: &str| text.strip_prefix('-').map_or(text.to_string(), |rest| format!("{{-}}{rest}"));
    let break_line = |line: &String| {
        let parts = break_equation(line);
        let parts = parts.iter().enumerate();
        let parts = parts
            .map(|(k, part)| if k == 0 { protect_leading_minus(part) } else { format!("{INDENT}{part}") });
        parts.map(|part| format!("& {part}")).collect::<Vec<_>>().join(" \\\\\n")
    };
    let all: Vec<String> = lines.iter().map(break_line).collect();
    format!("\\begin{{aligned}}\n{}\n\\end{{aligned}}\n", all.join(" \\\\\n"))
}

/// A part of a line that begins at a sign.
struct LinePart {
    /// End of the part, as an index of characters in the line.
    end: usize,
    /// Nesting depth of parentheses at the first sign of the part.
    depth: usize,
    width: usize,
}

/// Breaks a LaTeX equation into lines that fit the width of a page.
fn break_equation(line: &str) -> Vec<&str> {
    let parts = split_at_outer_signs(line);
    let total: usize = parts.iter().map(|part| part.width).sum();
    let (mut lines, mut from, mut start) = (Vec::new(), 0, 0);
    let mut left = total;
    loop {
        let room = if lines.is_empty() { ROOM } else { ROOM - INDENTED };
        if left <= room {
            break;
        }
        let Some(next) = next_line_start(&parts, from, room, left) else { break };
        let end = parts[next - 1].end;
        lines.push(line[start..end].trim());
        left -= parts[from..next].iter().map(|part| part.width).sum::<usize>();
        (from, start) = (next, end);
    }
    lines.push(line[start..].trim());
    lines
}

/// Returns the index of the part that begins the next line: the last one of minimum depth that fits, or the
/// next one if none fits.
fn next_line_start(parts: &[LinePart], from: usize, room: usize, left: usize) -> Option<usize> {
    let (mut taken, mut best) = (0, None::<usize>);
    for (k, part) in parts.iter().enumerate().skip(from) {
        // A short side gets no line of its own.
        let near = taken <= SHORT || left - taken <= SHORT;
        if k > from && !near && best.is_none_or(|b| part.depth <= parts[b].depth) {
            best = Some(k);
        }
        taken += part.width;
        if taken > room && best.is_some() {
            break;
        }
    }
    best
}

/// Splits a line before signs that are outside of braces and of `\left` … `\right`.
fn split_at_outer_signs(line: &str) -> Vec<LinePart> {
    let mut parts = Vec::new();
    let (mut braces, mut grown, mut depth, mut start, mut at_depth) = (0_usize, 0_usize, 0_usize, 0, 0);
    let mut push_line_part = |start: usize, end: usize, depth: usize| {
        let width = estimate_width(&line[start..end]);
        parts.push(LinePart { end, depth, width });
    };
    for (at, c) in line.char_indices() {
        match c {
            '{' => braces += 1,
            '}' => braces = braces.saturating_sub(1),
            '\\' if line[at..].starts_with("\\left") => grown += 1,
            '\\' if line[at..].starts_with("\\right") => grown = grown.saturating_sub(1),
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '+' | '-' | '=' if braces == 0 && grown == 0 && at > 0 => {
                let stands = line[..at].ends_with(' ') && line[at + 1..].starts_with(' ');
                if stands {
                    push_line_part(start, at, at_depth);
                    (start, at_depth) = (at, depth);
                }
            }
            _ => {}
        }
    }
    push_line_part(start, line.len(), at_depth);
    parts
}

/// Estimates the width of a formula, in tenths of a character.
fn estimate_width(text: &str) -> usize {
    let mut chars = text.chars().peekable();
    let mut sum = 0;
    while chars.peek().is_some() {
        sum += width_of_group(&mut chars);
    }
    sum
}

/// Returns the width of the characters up to the closing brace.
fn width_of_group(chars: &mut Peekable<Chars<'_>>) -> usize {
    let mut sum = 0;
    while let Some(c) = chars.next() {
        sum += match c {
            '}' => return sum,
            '{' => width_of_group(chars),
            ' ' | '&' => 0,
            '^' | '_' => width_of_script(chars) * 6 / 10,
            '\\' => width_of_command(chars),
            '+' | '-' | '=' | '>' => 20,
            _ => 10,
        };
    }
    sum
}

/// Returns the width of a group in braces or of a single character.
fn width_of_script(chars: &mut Peekable<Chars<'_>>) -> usize {
    match chars.next() {
        Some('{') => width_of_group(chars),
        Some(_) => 10,
        None => 0,
    }
}

fn width_of_command(chars: &mut Peekable<Chars<'_>>) -> usize {
    let mut word = String::new();
    while let Some(c) = chars.next_if(char::is_ascii_alphabetic) {
        word.push(c);
    }
    match word.as_str() {
        "" => chars.next().map_or(0, |_| 2),
        "frac" => width_of_script(chars).max(width_of_script(chars)),
        "tfrac" => width_of_script(chars).max(width_of_script(chars)) * 7 / 10,
        "sqrt" => 10 + width_of_script(chars),
        "left" | "right" | "bigl" | "bigr" | "mathrm" | "operatorname" | "mathcal" | "dot" | "ddot" => 0,
        "sin" | "cos" | "tan" | "exp" | "ln" | "sinh" | "cosh" | "tanh" | "arcsin" | "arccos" | "arctan" => {
            10 * word.len()
        }
        "times" => 20,
        _ => 10,
    }
}

#[cfg(test)]
mod tests {
    use super::{break_equation, estimate_width, format_aligned, split_at_outer_signs};

    #[test]
    fn latex_widths_count_visible_characters() {
        assert_eq!(estimate_width("a"), 10);
        assert_eq!(estimate_width("\\theta"), 10);
        assert_eq!(estimate_width("\\frac{a\\,b}{c}"), 22);
        assert_eq!(estimate_width("m\\,l^{2}\\,\\ddot{\\theta} = 0"), 10 + 2 + 10 + 6 + 2 + 10 + 20 + 10);
    }

    #[test]
    fn long_lines_break_before_outermost_signs() {
        let term = "a_{1}\\,b\\,\\cos\\theta\\,\\left(c + d\\right)";
        let long = [term; 12].join(" + ") + " = \\tau";
        let lines = break_equation(&long);
        assert!(lines.len() > 1 && lines.concat().replace(' ', "") == long.replace(' ', ""), "{lines:?}");
        assert!(lines.iter().all(|line| estimate_width(line) <= 1000), "{lines:?}");
        assert!(lines[1..].iter().all(|line| line.starts_with("+ a") || line.starts_with("= ")), "{lines:?}");
        // Breaks within parentheses of fixed size occur only if there are no outer signs.
        let inner = format!("m\\,({}) = 0", ["x\\,y\\,z"; 40].join(" - "));
        assert!(break_equation(&inner).len() > 1);
        assert_eq!(
            split_at_outer_signs("a + (b - c) = d").iter().map(|p| p.depth).collect::<Vec<_>>(),
            [0, 0, 1, 0]
        );
    }

    #[test]
    fn leading_minus_is_set_in_braces_in_latex() {
        let text = format_aligned(&["-a = 0".to_string(), "b = 1".to_string()]);
        assert_eq!(text, "\\begin{aligned}\n& {-}a = 0 \\\\\n& b = 1\n\\end{aligned}\n");
    }
}
